// The session of a command, and its way to the terminal.
#pragma once

#include <impactdic/control.h>
#include <impactdic/device.h>

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/app/command.h"
#include "host/app/terminal_progress.h"
#include "host/base/stopwatch.h"
#include "host/opencl/engine.h"

namespace impactdic::app {

// Sets the log's level; the devices are opened when they are needed.
Session open_session(const Common& common);

// Prints what a run says: notes as "impactdic: NOTE" and warnings as "impactdic: warning: WARNING"
// on stderr, progress in one line of a terminal; nothing where it is quiet.
class Terminal {
 public:
  explicit Terminal(bool quiet) : quiet_(quiet) {}
  // Interrupts end the run with what it has measured.
  RunControl control();
  // As `control`, but notes are results: bare lines on stdout.
  RunControl control_with_results();
  // Ends the line of the progress.
  void end() { progress_.reset(); }

 private:
  void show(const Progress& progress);
  void say(const Message& message, bool notes_are_results);
  bool quiet_;
  std::string phase_;
  std::unique_ptr<TerminalProgress> progress_;
};

// For commands that work on devices themselves: bench, tune, study.
class RunContext {
 public:
  // Opens the devices unless `with_device` is false. Throws as Session::open does.
  explicit RunContext(const Common& common, bool with_device = true);
  // The device, the first of several.
  opencl::Engine& engine() { return *engines().front(); }
  std::vector<opencl::Engine*> engines();
  // The device for summary.json; null without one.
  nlohmann::json describe() const;
  // With -v: the profiler's table on stderr.
  void print_profile();

 private:
  Session session_;
};

}  // namespace impactdic::app
