// One shot of a batch: what it asks of `track`, and how it is measured.
#pragma once

#include <impactdic/batch.h>

#include <filesystem>
#include <functional>
#include <string>

#include "host/run/batch_table.h"
#include "host/run/control.h"

namespace impactdic::run {

class ShotRunner {
 public:
  // Everything must outlive the runner.
  ShotRunner(const BatchRequest& request, Session& session, Caller& caller);

  const std::filesystem::path& output() const { return output_; }
  std::filesystem::path shots() const { return output_ / "shots"; }
  std::filesystem::path done(const BatchShot& shot) const { return shots() / shot.name; }
  std::filesystem::path aside(const BatchShot& shot) const {
    return output_ / "quarantine" / shot.name;
  }
  bool is_done(const BatchShot& shot) const {
    return std::filesystem::exists(done(shot) / "summary.json");
  }

  // What is known of a shot before it is measured. Throws InvalidArgument.
  ShotResult described(const BatchShot& shot) const;
  // Whether what an earlier run made of the shot is what this one would; `part`: where one may have
  // been interrupted. Throws InvalidArgument where that would have to be measured otherwise.
  bool is_settled(const BatchShot& shot, const std::filesystem::path& part) const;
  // Measures the shot into the folder `into`. Empty, or the reason why there is no result.
  // `alive` is called while it gets on. Throws OpenClError.
  std::string measure(const BatchShot& shot, const std::filesystem::path& into, ShotResult& result,
                      const std::function<void()>& alive = {}) const;
  // Of a shot that is done: the results as they are on the disk. Throws FormatError.
  ShotResult read_done(const BatchShot& shot) const;
  // Moves what there is of the shot, in `part`, into the quarantine, and says why.
  void put_aside(const BatchShot& shot, const std::filesystem::path& part,
                 const std::string& reason) const;
  void warn_of_contradictions(const ShotResult& shot) const;

 private:
  TrackRequest request_of(const BatchShot& shot) const;
  TrackFolder folder_of(const std::filesystem::path& into) const;

  const BatchRequest& request_;
  Session& session_;
  Caller& caller_;
  std::filesystem::path output_;
};

// Clips measured at a time by one process, of `waiting` ones. One clip leaves the device idle while
// its circles are sought and its results are written, and the reader while the device is at work:
// several at a time fill the gaps.
std::size_t clips_in_flight(int asked, int threads, std::size_t waiting);

}  // namespace impactdic::run
