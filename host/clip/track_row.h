// What `track` says of one frame, and its conversion from pixels to SI units.
#pragma once

#include <impactdic/units.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace impactdic {

enum class TrackStatus {
  ok,
  no_ball,          // no circle was found in this frame, or in the next one
  no_texture,       // too few windows have contrast enough to be correlated
  low_correlation,  // too few windows were found again in the next frame
  out_of_view,      // the ball has left the picture
  last_frame,       // the circle is measured; there is no next frame to move to
};
const char* to_string(TrackStatus status);
// Throws InvalidArgument for a word that is no status.
TrackStatus parse_track_status(const std::string& word);

// Where a ball is and how far it has turned since frame `origin`, by registration against frame
// `keyframe` (frames of the stored file in a TrackRow): the place of the material point that was
// the circle's centre in frame `origin`, and the angle, not wrapped, counter-clockwise on screen.
// Standard deviations are of the pose against that of frame `origin`.
struct BodyPose {
  bool ok = false;
  double x_px = kNotMeasured, y_px = kNotMeasured, angle_rad = kNotMeasured;
  double x_sd_px = kNotMeasured, y_sd_px = kNotMeasured, angle_sd_rad = kNotMeasured;
  std::int64_t origin = -1, keyframe = -1;
};

// One frame. Pixels in image axes (x right, y down); the motion is from this frame to the next
// analysed one. Fields that were not measured are NaN (see `circle_ok` and `motion_ok`). Units are
// those of track.csv: a row that is read back is the same to the last bit.
struct TrackRow {
  std::int64_t frame = 0;  // in the stored file
  double time_s = 0;       // since the first analysed frame
  TrackStatus status = TrackStatus::no_ball;
  bool circle_ok = false, motion_ok = false;
  double cx_px = kNotMeasured, cy_px = kNotMeasured, r_px = kNotMeasured;
  double cx_sd_px = kNotMeasured, cy_sd_px = kNotMeasured, r_sd_px = kNotMeasured;
  double dx_px = kNotMeasured, dy_px = kNotMeasured, rot_deg = kNotMeasured;
  double dx_sd_px = kNotMeasured, dy_sd_px = kNotMeasured, rot_sd_deg = kNotMeasured;
  // The displacement field interpolated at the centroid, the dissertation's velocity of the centre.
  double centre_u_px = kNotMeasured, centre_v_px = kNotMeasured;
  double centre_u_sd_px = kNotMeasured, centre_v_sd_px = kNotMeasured;
  int windows = 0;  // interrogation windows that carried the motion
  BodyPose pose;    // where keyframes are kept
};

// From pixels and frames to metres and seconds. World axes: x right, y up, origin at the centre
// of the bottom-left pixel. Local axes: t along the surface, n out of it.
struct SiScale {
  double metre_per_px = 0;
  double fps = 0;                // analysed frames a second
  double surface_angle_rad = 0;  // of the surface, counter-clockwise from image-right
  int image_height = 0;
};

struct SiRow {
  double x_m, y_m, vx_m_s, vy_m_s, vt_m_s, vn_m_s, omega_rad_s;
  double vx_sd_m_s, vy_sd_m_s, omega_sd_rad_s;
};

// Every figure NaN that has no source; lengths all NaN where `scale.metre_per_px` is 0, rates all
// NaN where `scale.fps` is 0.
SiRow to_si(const TrackRow& row, const SiScale& scale);

// Median radius of the rows with a circle; nullopt where there is none. The dissertation's scale
// (section 3.2.1) is the ball's diameter over the mean one; the median stands a ball that is
// compressed for a while.
std::optional<double> median_radius_px(const std::vector<TrackRow>& rows);

}  // namespace impactdic
