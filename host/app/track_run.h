// Tracking one clip into one folder: what `track` does once and `batch` again and again.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "host/app/command.h"
#include "host/app/field_options.h"
#include "host/app/overlay_output.h"
#include "host/app/run_context.h"
#include "host/app/video_options.h"

namespace impactdic::app {

struct TrackRequest {
  Common common;
  VideoRequest video;
  FieldRequest field;
  std::string output, frames, roi, radius, estimator = "ball";
  double ball_diameter_mm = 0, mm_per_px = 0, surface_angle_deg = 0, gravity_angle_deg = -90;
  double inertia_factor = 0;  // 0: unknown
  bool no_field = false, resume = false, no_checksum = false;
  OverlayOptions overlay;
};

// Adds how a clip is measured: every option of `track` but those of the clip and its reading, the
// folder, and the common
// ones.
void add_track_settings(CLI::App& command, TrackRequest& request);

// Those, and the clip, the folder and the common ones: all options of `track`.
void add_track_options(CLI::App& command, TrackRequest& request);

// Throws InvalidArgument for settings that are wrong whatever the clip is.
void check_settings(const TrackRequest& request);

struct TrackOutcome {
  std::int64_t frames = 0, frames_ok = 0;
  double frames_per_s = 0;
  std::string impact;  // what was found of an impact, in a line
};

// Measures the clip of `request` into its folder: track.csv, fields.h5, summary.json, and the
// options of `command` as job.toml. What was measured before an error is kept.
TrackOutcome track_to_folder(const CLI::App& command, const TrackRequest& request, RunContext& run);

}  // namespace impactdic::app
