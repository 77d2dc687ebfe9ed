// What three markers tell of a rod's impact (dissertation, chapter 5): the motion of every frame,
// the velocities on both sides of a blow that is shorter than one frame, and four checks of the
// data itself: free fall, agreement of the marker pairs, closure of the impulses, cone of friction.
// Beside it, what the rod models make of the same blow.
//
// Axes: n up, t along the flat towards the upper end of the rod, b out of their plane; angle of the
// rod from the flat, counter-clockwise seen with t to the right.
#pragma once

#include <impactdic/control.h>
#include <impactdic/export.h>
#include <impactdic/measured.h>
#include <impactdic/rod_model.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// Marker 1 sits near the end that strikes, marker 2 at the centre of mass, marker 3 near the upper
// end. A marker out of sight has NaN coordinates.
struct MarkerTable {
  std::string file;                                           // its name in errors
  std::vector<double> time_s;                                 // ascending, evenly spaced
  std::array<std::vector<std::array<double, 3>>, 3> markers;  // metres, the camera's own axes
  double interval_s = 0;
};

// One row of a permanent-deformation table: an impact and the depth it left.
struct DeformationRow {
  double angle_deg = 0;  // of the rod from the flat
  double speed_m_s = 0;  // of the contact point into the flat, positive
  double depth_m = 0;
  double depth_sd_m = 0;  // NaN: not given
};

struct RodMeasureOptions {
  RodBody body;
  double friction_kinetic = 0.13;
  double gravity_m_s2 = 9.81;
  std::size_t vertical_axis = 1;  // of the table: 0 x, 1 y, 2 z
  bool vertical_down = false;     // that axis points down
  double centre_offset_m = 0;     // of the centre of mass from marker 2, towards marker 3
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

// The defaults are the steel rod and flat of the dissertation.
struct RodRequest {
  MarkerTable markers;
  RodMeasureOptions measure;
  double flat_young_pa = 200e9;              // Young's modulus of the flat
  double poisson = 0.29;                     // of rod and flat
  double yield_strength_pa = 300e6;          // of the weaker
  double modal_damping = 0.002;              // fraction of critical, every mode
  std::vector<DeformationRow> deformations;  // what the models are to be set against; may be none
  int threads = 0;                           // deformations at a time; 0: all cores

  // The rigid and the flexible rod of these bodies, without a motion.
  RodJob rigid_model() const;
  RodJob flexible_model() const;
  // Throws InvalidArgument naming the first impossible value.
  void validate() const;
};

// A rod model's rebound from the measured motion before the blow.
struct RodPrediction {
  std::string model;  // rigid_rod, flexible_rod
  RodImpact impact;
};

// A row of a permanent-deformation table beside what the models leave.
struct DeformationComparison {
  DeformationRow measured;
  double rigid_m = 0, flexible_m = 0;
};

struct RodResult {
  RodMeasurement measurement;
  std::vector<RodPrediction> predictions;
  std::vector<DeformationComparison> deformations;  // of a cancelled run those done
  bool cancelled = false;
};

// Throws InvalidArgument (validate); FormatError where the table shows no blow, the rod stands
// upright (its plane is then not defined), or fewer than four frames of free flight lie on a side.
RodResult measure_rod(const RodRequest& request, const RunControl& control = {});

}  // namespace impactdic
