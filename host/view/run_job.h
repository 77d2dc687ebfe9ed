// A run that was started from the page: it goes on beside the page's other requests.
#pragma once

#include <impactdic/control.h>
#include <impactdic/device.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>
#include <vector>

#include "host/view/shot.h"
#include "host/view/track_job.h"

namespace impactdic::view {

class RunJob {
 public:
  explicit RunJob(Session& session) : session_(session) {}
  // Stops what runs and waits for it; what was measured is on the disk.
  ~RunJob();
  RunJob(const RunJob&) = delete;
  RunJob& operator=(const RunJob&) = delete;

  // Starts it; when it ends `shot` shows its folder. Throws InvalidArgument where another one runs.
  void start(std::shared_ptr<Shot> shot, const TrackJob& job);
  // It ends soon, with what it has measured.
  void stop() { stop_ = true; }
  // {"state": "idle" | "running" | "done" | "stopped" | "failed", "folder", "done", "total",
  // "header", "rows": lines of track.csv from row `from` on, in px, "messages", "error",
  // "compiling"}.
  nlohmann::json status(std::size_t from) const;

  // Of Session: kernels that are being compiled for the first time on this machine.
  void note_compiling(const CompileProgress& progress);

 private:
  void run(const std::shared_ptr<Shot>& shot, const TrackJob& job);
  void finish(const std::shared_ptr<Shot>& shot, const std::string& state,
              const std::string& error = "");

  Session& session_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  std::mutex starting_;
  mutable std::mutex mutex_;  // of what follows
  std::string state_ = "idle", error_, folder_, compiling_;
  std::int64_t done_ = 0, total_ = 0;
  std::vector<std::string> rows_, messages_;
};

}  // namespace impactdic::view
