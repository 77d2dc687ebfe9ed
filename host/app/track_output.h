// The files that `track` leaves behind, written while the clip runs.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/app/overlay_output.h"
#include "host/pipeline/track_clip.h"
#include "host/report/csv.h"
#include "host/report/fields_file.h"
#include "host/report/impact_json.h"
#include "host/report/summary.h"

namespace impactdic::app {

struct OutputOptions {
  std::filesystem::path folder;
  SiScale scale;               // metre_per_px 0 where only the ball's diameter is known
  double ball_diameter_m = 0;  // 0: unknown
  report::ImpactSetup impact;
  int window_px = 15, compression = 0;
  bool with_field = true, with_poses = false, resume = false;
  OverlayOptions overlay;
  Roi roi;
  report::Attributes attributes;
};

class TrackOutput {
 public:
  // With `resume` takes over what an earlier run finished. Throws FileError, FormatError.
  explicit TrackOutput(OutputOptions options);
  ~TrackOutput();

  // Where the earlier run ended; nullopt where there was none to take over.
  const std::optional<pipeline::ResumePoint>& resume_point() const;
  void set_grid(std::span<const Window> grid, double radius_px);
  void add(const pipeline::TrackedFrame& frame);
  // A run that is killed from here on goes on from `point`. Writes to the disk now and then.
  void reach(const pipeline::ResumePoint& point);
  // Puts the scale into the table, closes everything and sums it up, the impact with it.
  nlohmann::json finish();
  // After `finish`: the clip's digest, known only when all of it has been read.
  void set_source_digest(const video::ClipDigest& digest);
  // After `finish`: what was found of an impact, in a line.
  const std::string& impact_line() const;
  const std::vector<TrackRow>& rows() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace impactdic::app
