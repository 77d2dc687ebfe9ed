// How a caller follows a run and stops it. The library prints nothing: whatever a run has to say
// comes through here.
#pragma once

#include <impactdic/export.h>

#include <cstdint>
#include <functional>
#include <string>

namespace IMPACTDIC_PUBLIC impactdic {

struct Progress {
  const char* phase = "";  // "track", "correlate", "shots"
  std::int64_t done = 0, total = 0;
};

enum class MessageKind {
  kNote,     // how it goes: the texture found, a shot done
  kWarning,  // what a person should check; stands in the result too
  kTiming,   // with SessionOptions::profile: tables of what stages and kernels took
};

struct Message {
  MessageKind kind = MessageKind::kNote;
  std::string text;  // without a line end, but for tables
};

// All three may be empty. They are called from one thread at a time, but not always from the one
// that started the run. What they throw ends the run as an error of it.
struct RunControl {
  std::function<void(const Progress&)> progress;
  // Asked once a batch of frames; true stops the run soon. It then returns what it has measured
  // with `cancelled` set.
  std::function<bool()> cancelled;
  std::function<void(const Message&)> message;

  bool is_cancelled() const { return cancelled && cancelled(); }
};

}  // namespace impactdic
