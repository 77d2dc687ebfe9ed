// Full-field displacement of any speckled surface in a clip, and the robust rigid motion of the
// region about its centre. Axes as in track.h.
#pragma once

#include <impactdic/export.h>
#include <impactdic/track.h>

#include <cstdint>
#include <functional>
#include <optional>
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
};

struct CorrelateResult {
  ClipInfo clip;
  FrameRange frames;
  Roi roi;
  double fps = 0;  // of the stored frames; 0: not known, time_s then counts frames
  std::vector<MotionRow> rows;
  std::size_t windows = 0;           // of the grid
  std::int64_t frames_measured = 0;  // without the reference
  ClipAdvice advice;
  std::vector<std::string> warnings;
  double seconds = 0, frames_per_s = 0;
  bool cancelled = false;
};

// One frame as it comes. Everything is valid during the call only.
struct CorrelatedFrame {
  const MotionRow& row;
  const FieldView& field;  // empty for the reference
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
