// Rows along the path of a ball: what is asked of them, whoever compares them.
#pragma once

#include <cmath>
#include <cstddef>

#include "host/clip/track_row.h"

namespace impactdic::pipeline {

// Frames on either side that tell of one, at most; of all of them at least.
inline constexpr std::size_t kBeside = 12, kFewestOthers = 4;
// A motion that is less off the way between its two circles contradicts none of them.
inline constexpr double kContradiction_px = 0.1;
// No circle is known better than this.
inline constexpr double kExact_px = 1e-6;
// The outline of a ball 12 radii away is not about its centre: by so much of the way.
inline constexpr double kAboutCentre = 0.007;

// Along which circles and motions are compared.
struct Axis {
  double TrackRow::*place;
  double TrackRow::*place_sd;
  double TrackRow::*move;
  double TrackRow::*move_sd;
};
inline constexpr Axis kX = {&TrackRow::cx_px, &TrackRow::cx_sd_px, &TrackRow::dx_px,
                            &TrackRow::dx_sd_px};
inline constexpr Axis kY = {&TrackRow::cy_px, &TrackRow::cy_sd_px, &TrackRow::dy_px,
                            &TrackRow::dy_sd_px};

// Its motion was measured about three axes.
inline bool turns_in_space(const TrackRow& row) { return std::isfinite(row.rot_x_deg); }
// It leads on to the next row.
inline bool is_part_of_path(const TrackRow& row) {
  return row.status == TrackStatus::kOk && row.motion_ok && row.circle_ok;
}

// Or contradicts the next one, which is no reason to ask no further who is right.
inline bool leads_on(const TrackRow& row) {
  return is_part_of_path(row) ||
         (row.status == TrackStatus::kInconsistent && row.motion_ok && row.circle_ok);
}

}  // namespace impactdic::pipeline
