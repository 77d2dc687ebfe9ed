// resume/ROW.json: points that a run has passed, for one that goes back to them because a frame was
// corrected by hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "host/pipeline/resume_point.h"

namespace impactdic::run {

class KeptPoints {
 public:
  // Goes on with those of a folder of results that lie at `last_row` or before; takes the others
  // away. Throws FileError here and below.
  KeptPoints(const std::filesystem::path& folder, std::int64_t last_row);

  // Keeps the point, where it lies behind the others. There are 16 at most, spread over the rows
  // passed so far.
  void add(const pipeline::ResumePoint& point);

  // The last point before row `row` that is there and can be read: what was measured up to it
  // knows nothing of that row yet.
  static std::optional<pipeline::ResumePoint> before(const std::filesystem::path& folder,
                                                     std::int64_t row);

  // Takes the results of `track` back to that point, so that a run goes on from it; its row.
  // nullopt, and nothing is changed, where there is none.
  static std::optional<std::int64_t> go_back(const std::filesystem::path& folder, std::int64_t row);

 private:
  std::filesystem::path folder_;
  std::vector<std::int64_t> rows_;  // in order
};

}  // namespace impactdic::run
