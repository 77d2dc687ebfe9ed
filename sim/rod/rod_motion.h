// What three markers tell of a rod's impact (Akarsu 2020, chapter 5): the motion of every frame,
// the velocities on both sides of a blow that is shorter than one frame, and four checks of the
// data itself: free fall, agreement of the marker pairs, closure of the impulses, cone of friction.
//
// Axes: n up, t along the flat towards the upper end of the rod, b out of their plane; angle of the
// rod from the flat, counter-clockwise seen with t to the right.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "sim/rod/markers.h"
#include "sim/rod/rod_impact.h"

namespace impactdic::sim::rod {

struct RodMeasureOptions {
  RodBody body;
  double friction_kinetic = 0.13;
  double gravity_m_s2 = 9.81;
  std::size_t vertical_axis = 1;  // of the table: 0 x, 1 y, 2 z
  bool vertical_down = false;     // that axis points down
  double centre_offset_m = 0;     // of the centre of mass from marker 2, towards marker 3
};

struct Measured {
  double value = 0, sd = 0;
};

struct RodFrame {
  double time_s = 0;
  std::string status;                             // ok, marker_1_hidden, ...
  double qt_m = 0, qn_m = 0, out_of_plane_m = 0;  // centre of mass
  std::array<double, 3> pair_angle_rad{};         // markers 1-2, 1-3, 2-3
  double angle_rad = 0;                           // mean of the pairs in sight
  // By central differences, one-sided at the blow and at the ends: never across the blow.
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
};

// One side of the blow.
struct RodSide {
  std::size_t first = 0, last = 0;                  // frames of the fit
  Measured vt_m_s, vn_m_s, omega_rad_s, angle_rad;  // lines, carried to the instant of the blow
  // By differencing neighbouring frames, at the frame next to the blow (the published way).
  double difference_vt_m_s = 0, difference_vn_m_s = 0, difference_omega_rad_s = 0;
  Measured gravity_m_s2;          // from the curvature of the path
  double gravity_slope_m_s2 = 0;  // from a line through the differenced velocity (published)
  double gravity_tilt_deg = 0;    // of the measured fall from the table's vertical
};

struct RodClosure {
  double normal_impulse_n_s = 0, tangential_impulse_n_s = 0;
  Measured omega_as_measured_rad_s;   // after the blow, from the impulses
  Measured omega_axis_flipped_rad_s;  // the same with the tangential axis turned round
  // +1: the data closes as it stands; -1: with the tangential axis flipped; 0: it cannot tell.
  int tangential_sign = 0;
  double misfit_sd = 0;               // of the better one, in standard deviations
  Measured impulse_ratio;             // |Jt| / Jn
  bool inside_friction_cone = false;  // |Jt|/Jn <= mu within two standard deviations
};

struct RodMeasurement {
  std::vector<RodFrame> frames;
  Measured impact_s;
  std::size_t last_before = 0, first_after = 0;      // frames next to the blow
  double position_noise_m = 0, angle_noise_rad = 0;  // one frame, one standard deviation
  double pair_spread_rad = 0;                        // rms of pair angles about their mean
  RodSide before, after;
  Measured tip_vn_before_m_s, tip_vn_after_m_s;
  Measured restitution;  // of the contact point
  RodClosure closure;
  std::vector<std::string> warnings;
};

// Throws FormatError where the table shows no blow, the rod stands upright (its plane is then not
// defined), or fewer than four frames of free flight lie on a side.
RodMeasurement measure_rod(const MarkerTable& markers, const RodMeasureOptions& options);

// Closure of the impulses from the velocities alone (Eq. 5.7 integrated over the blow).
RodClosure close_impulses(const RodBody& body, double friction_kinetic, const RodSide& before,
                          const RodSide& after);

}  // namespace impactdic::sim::rod
