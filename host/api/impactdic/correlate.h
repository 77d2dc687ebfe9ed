// Full-field displacement of any speckled surface in a clip, and the robust rigid motion of the
// region about its centre. Axes as in track.h.
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/export.h>
#include <impactdic/track.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// What displacements are measured against.
enum class ReferenceFrame { kFirst, kPrevious };
const char* to_string(ReferenceFrame reference);
ReferenceFrame parse_reference(const std::string& word);  // throws InvalidArgument

// How the region's rigid motion is measured.
enum class RegionMotion {
  kWindows,  // robust fit to the windows' displacements
  kRegion,   // one registration of all its pixels, about where the windows say: for rigid bodies
};
const char* to_string(RegionMotion motion);
RegionMotion parse_region_motion(const std::string& word);  // throws InvalidArgument

struct CorrelateRequest {
  ClipRequest clip;
  FrameRange frames = {0, kToTheEnd, 1};
  ReferenceFrame reference = ReferenceFrame::kFirst;
  RegionMotion motion = RegionMotion::kWindows;
  // Where windows stand: all three together. Without any, the picture less the search radius; with
  // a polygon alone, the rectangle about it.
  std::optional<Roi> roi;
  std::string mask;  // a picture's file: only its non-zero pixels count
  std::optional<Image<std::uint8_t>> mask_picture;  // the same in memory, of the clip's size
  std::vector<PointPx> polygon;                     // corners in order, at least three; empty: none
  FieldOptions field;
  int spacing_px = 0;  // of the windows' centres; 0: half a window, rounded up
  // A camera that `calibrate` wrote, calibrated with pictures of this size: displacements are also
  // given in its plane of motion. "": in pixels alone.
  std::string camera;
  // Throws InvalidArgument naming the setting, by its name on the command line.
  void validate() const;
};

// The region's motion from the reference to one frame, about the region's centre.
struct MotionRow {
  std::int64_t frame = 0;
  double time_s = 0;          // since the first analysed frame
  bool is_reference = false;  // then the motion is zero by definition
  TrackStatus status = TrackStatus::kOk;
  bool motion_ok = false;
  double dx_px = kNotMeasured, dy_px = kNotMeasured, rot_deg = kNotMeasured;
  double dx_sd_px = kNotMeasured, dy_sd_px = kNotMeasured, rot_sd_deg = kNotMeasured;
  int windows = 0;  // that carried the motion
  // The same in the camera's plane of motion, of the point that is seen at the region's centre:
  // X along the picture's rows, Y up, counter-clockwise. Deviations hold those of the camera.
  // NaN without a camera.
  double dx_m = kNotMeasured, dy_m = kNotMeasured, plane_rot_deg = kNotMeasured;
  double dx_sd_m = kNotMeasured, dy_sd_m = kNotMeasured, plane_rot_sd_deg = kNotMeasured;
};

// A window in the camera's plane of motion: world axes of docs/camera.md, m. Deviations are those
// of the displacement in the picture; the camera's are common to all windows and stand in the
// row's. All NaN where the window was not measured.
struct PlaneResult {
  double x_m = kNotMeasured, y_m = kNotMeasured;  // its centre in the reference
  double u_m = kNotMeasured, v_m = kNotMeasured;  // displacement, X right, Y up
  double u_sd_m = kNotMeasured, v_sd_m = kNotMeasured;
};

// What displacements are measured where nothing moves, px: pictures of a still scene (Jones and
// Iadicola, editors, 2018, A Good Practices Guide for Digital Image Correlation, International
// Digital Image Correlation Society).
struct NoiseFloor {
  std::int64_t first_frame = 0, last_frame = 0;  // of the stored file: the still ones
  std::int64_t frames = 0;                       // of these without the reference
  std::size_t windows = 0;                       // measured in all of them
  double u_mean = 0, v_mean = 0;                 // of all windows and frames: a bias
  // Root of the mean variance over the windows of a frame, and over the frames at a window. With
  // the first frame as the reference, its noise is common to all frames: part of the first alone.
  double u_spatial_sd = 0, v_spatial_sd = 0;
  double u_temporal_sd = 0, v_temporal_sd = 0;
  double u_stated_sd = 0, v_stated_sd = 0;  // root mean square of what the windows state
};

struct CorrelateResult {
  ClipInfo clip;
  FrameRange frames;
  Roi roi;
  double fps = 0;  // of the stored frames; 0: not known, time_s then counts frames
  std::vector<MotionRow> rows;
  std::size_t windows = 0;           // of the grid
  std::int64_t frames_measured = 0;  // without the reference
  // Where the clip begins with a still scene, three frames or more behind the reference; of a run
  // that was resumed none.
  std::optional<NoiseFloor> noise_floor;
  std::optional<PlaneFigures> camera;  // where one was given
  ClipAdvice advice;
  std::vector<std::string> warnings;
  double seconds = 0, frames_per_s = 0;
  bool cancelled = false;
};

// One frame as it comes. Everything is valid during the call only.
struct CorrelatedFrame {
  const MotionRow& row;
  const FieldView& field;              // empty for the reference
  std::span<const PlaneResult> plane;  // one a window of `field`; empty without a camera
};
using CorrelateSink = std::function<void(const CorrelatedFrame&)>;

// Throws as `track` does.
CorrelateResult correlate(const CorrelateRequest& request, Session& session,
                          const RunControl& control = {}, const CorrelateSink& sink = {});
// The same into `result`, which holds what was measured also where this throws.
void correlate(const CorrelateRequest& request, Session& session, const RunControl& control,
               const CorrelateSink& sink, CorrelateResult& result);

struct CorrelateFolder {
  std::string folder;
  bool force = false;   // also into a folder that holds files
  bool resume = false;  // goes on where an earlier run of the same request ended
  int compression = 0;  // of fields.h5, as TrackFolder's
  void validate() const;
};

// `correlate` with files: motion.csv, fields.h5, summary.json, job.toml.
CorrelateResult correlate_to_folder(const CorrelateRequest& request, const CorrelateFolder& folder,
                                    Session& session, const RunControl& control = {});

}  // namespace impactdic
