// The settings of every request, listed once: their names, and where they stand. The command line,
// job.toml, the attributes of fields.h5 and the comparison of --resume all go by these lists.
#pragma once

#include <impactdic/batch.h>
#include <impactdic/correlate.h>
#include <impactdic/device.h>
#include <impactdic/track.h>

namespace impactdic::run {

enum SettingKind : unsigned {
  kPlain = 0,
  kMayChange = 1,   // says nothing of how a frame is measured: may differ in a run that goes on
  kZeroUnset = 2,   // 0 stands for nothing given
  kEmptyUnset = 4,  // so does an empty one
  kNegated = 8,     // the flag switches the member off
  kPath = 16,       // of a file or a folder that is read
  // Comes in after the last frame: may differ, and what it decides is then worked out anew.
  kAfterwards = 32,
  kGoesBack = 64,  // may differ: the run goes back to before the first frame that this changes
};

struct Setting {
  const char* key;                  // the long option, and the key of job.toml
  unsigned kind = kPlain;           // SettingKind
  const char* attribute = nullptr;  // of fields.h5; nullptr: none
};

// Each calls visitor(Setting, member) for every setting of a request, in the order of the command's
// help. `Request` is the request's type, const or not.

template <typename Visitor, typename Options>
void visit_session(Visitor&& visit, Options& options) {
  visit(Setting{"device", kMayChange}, options.device);
  visit(Setting{"threads", kMayChange}, options.threads);
}

template <typename Visitor, typename Request>
void visit_reading(Visitor&& visit, Request& clip) {
  visit(Setting{"raw", kEmptyUnset}, clip.open.raw);
  visit(Setting{"fps", kZeroUnset}, clip.fps);
  visit(Setting{"channel", kEmptyUnset, "option_channel"}, clip.open.channel);
  visit(Setting{"gamma", kZeroUnset, "option_gamma"}, clip.open.gamma);
  visit(Setting{"max-megapixels", kMayChange}, clip.open.max_megapixels);
}

template <typename Visitor, typename Request>
void visit_clip(Visitor&& visit, Request& clip) {
  visit(Setting{"video", kEmptyUnset | kPath}, clip.paths);
  visit_reading(visit, clip);
}

template <typename Visitor, typename Options, typename Spacing, typename Compression>
void visit_field(Visitor&& visit, Options& field, Spacing& spacing_px, Compression& compression) {
  visit(Setting{"window", kPlain, "option_window_px"}, field.window_px);
  visit(Setting{"spacing", kPlain, "option_spacing_px"}, spacing_px);
  visit(Setting{"search", kPlain, "option_search_px"}, field.search_px);
  visit(Setting{"method", kPlain, "option_method"}, field.method);
  visit(Setting{"interp", kPlain, "option_interp"}, field.interp_points);
  visit(Setting{"spline-degree", kPlain, "option_spline_degree"}, field.spline_degree);
  visit(Setting{"max-iterations", kPlain, "option_max_iterations"}, field.max_iterations);
  visit(Setting{"min-correlation", kPlain, "option_min_correlation"}, field.min_correlation);
  visit(Setting{"min-texture", kPlain, "option_min_texture"}, field.min_texture);
  visit(Setting{"max-sd", kPlain, "option_max_sd_px"}, field.max_sd_px);
  visit(Setting{"compress", kMayChange}, compression);
}

// How a clip is measured and written: every setting of `track` but the clip's.
template <typename Visitor, typename Request, typename Folder>
void visit_track_settings(Visitor&& visit, Request& request, Folder& folder) {
  visit(Setting{"ball-diameter-mm", kAfterwards | kZeroUnset}, request.ball_diameter_mm);
  visit(Setting{"ball-diameter-sd-mm", kAfterwards | kZeroUnset}, request.ball_diameter_sd_mm);
  visit(Setting{"mm-per-px", kAfterwards | kZeroUnset}, request.mm_per_px);
  visit(Setting{"mm-per-px-sd", kAfterwards | kZeroUnset}, request.mm_per_px_sd);
  visit(Setting{"camera", kAfterwards | kEmptyUnset | kPath}, request.camera);
  visit(Setting{"camera-motion", kAfterwards}, request.camera_motion);
  visit(Setting{"surface-angle-deg", kAfterwards}, request.surface_angle_deg);
  visit(Setting{"surface-angle-sd-deg", kAfterwards | kZeroUnset}, request.surface_angle_sd_deg);
  visit(Setting{"gravity-angle-deg", kAfterwards}, request.gravity_angle_deg);
  visit(Setting{"drop-height-mm", kAfterwards | kZeroUnset}, request.drop_height_mm);
  visit(Setting{"inertia-factor", kAfterwards | kZeroUnset}, request.inertia_factor);
  visit(Setting{"distance-mm", kAfterwards | kZeroUnset}, request.distance_mm);
  visit(Setting{"distance-sd-mm", kAfterwards | kZeroUnset}, request.distance_sd_mm);
  visit(Setting{"frames", kEmptyUnset}, request.frames);
  visit(Setting{"roi", kEmptyUnset}, request.roi);
  visit(Setting{"polygon", kEmptyUnset}, request.polygon);
  visit(Setting{"radius-px", kEmptyUnset}, request.radius_px);
  visit(Setting{"ball-at", kEmptyUnset | kGoesBack}, request.ball_at);
  visit(Setting{"ball", kZeroUnset}, request.ball);
  visit(Setting{"estimator", kPlain, "option_estimator"}, request.estimator);
  visit(Setting{"body", kPlain, "option_body"}, request.body);
  visit_field(visit, request.field, request.spacing_px, folder.compression);
  visit(Setting{"no-field", kNegated}, request.with_field);
  visit(Setting{"no-checksum", kNegated | kMayChange}, folder.checksum);
  visit(Setting{"overlay", kMayChange}, folder.overlay.wanted);
  visit(Setting{"slow-motion", kMayChange}, folder.overlay.slow_motion);
  visit(Setting{"arrow-scale", kMayChange}, folder.overlay.arrow_scale);
}

template <typename Visitor, typename Request, typename Folder>
void visit_track(Visitor&& visit, Request& request, Folder& folder) {
  visit_clip(visit, request.clip);
  visit_track_settings(visit, request, folder);
}

template <typename Visitor, typename Request, typename Folder>
void visit_correlate(Visitor&& visit, Request& request, Folder& folder) {
  visit_clip(visit, request.clip);
  visit(Setting{"reference", kPlain, "option_reference"}, request.reference);
  visit(Setting{"roi", kEmptyUnset}, request.roi);
  visit(Setting{"mask", kEmptyUnset | kPath}, request.mask);
  visit(Setting{"polygon", kEmptyUnset}, request.polygon);
  visit(Setting{"motion", kPlain, "option_motion"}, request.motion);
  visit(Setting{"camera", kEmptyUnset | kPath}, request.camera);
  visit(Setting{"frames", kEmptyUnset}, request.frames);
  visit_field(visit, request.field, request.spacing_px, folder.compression);
}

template <typename Visitor, typename Request>
void visit_batch(Visitor&& visit, Request& request) {
  visit(Setting{"folder", kPath}, request.folder);
  visit(Setting{"table", kEmptyUnset | kPath}, request.table);
  visit(Setting{"clips"}, request.clips);
  visit_reading(visit, request.track.clip);
  visit_track_settings(visit, request.track, request.output);
}

}  // namespace impactdic::run
