// The files that `track` leaves behind, written while the clip runs.
#pragma once

#include <impactdic/track.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/pipeline/track_clip.h"
#include "host/report/fields_file.h"
#include "host/video/clip_digest.h"

namespace impactdic::run {

struct TrackFilesOptions {
  std::filesystem::path folder;
  SiScale scale;  // metre_per_px 0 where only the ball's diameter is known
  int window_px = 15, compression = 0;
  bool with_field = true, with_poses = false;
  bool resume = false;    // an earlier run of the same job is in the folder
  std::int64_t rows = 0;  // frames that are analysed
  OverlayOptions overlay;
  Roi roi;
  std::string camera;  // its file; "": none
  report::Attributes attributes;
};

class TrackFiles {
 public:
  // With `resume` takes over what an earlier run finished. Throws FileError, FormatError.
  explicit TrackFiles(TrackFilesOptions options);
  ~TrackFiles();

  // Whether `folder` holds an earlier run of so many rows that can be gone on with. Throws
  // FileError, FormatError.
  static bool can_go_on(const std::filesystem::path& folder, std::int64_t rows);

  // True where the earlier run has measured every frame.
  bool is_complete() const;
  // Where the earlier run ended; nullopt where there was none.
  const std::optional<pipeline::ResumePoint>& resume_point() const;
  // Its rows; none where there was none. They are given away.
  std::vector<TrackRow> take_earlier_rows();
  void set_grid(std::span<const Window> grid, double radius_px);
  void add(const pipeline::TrackedFrame& frame);
  // A run that is killed from here on goes on from `point`. Writes to the disk now and then.
  void reach(const pipeline::ResumePoint& point);
  // Writes the tables anew with the scale, and what the impact says into the overlay.
  // `rows`: all of the run's.
  void finish(const TrackRows& rows, const TrackResult& result);
  // After `finish`: the clip's digest, known only when all of it has been read.
  void set_source_digest(const video::ClipDigest& digest);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace impactdic::run
