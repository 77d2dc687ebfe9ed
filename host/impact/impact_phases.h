// One impact in a track: when it begins, turns and ends, and what it does to the motion.
//
// Everything comes out of the motion itself, no model of the contact beyond its onset is assumed.
// Instants count analysed frames from 0; lengths are px, velocities px/frame, spins rad/frame, as
// the track has them. Axes: global x right, y up; local t along the surface, n out of it.
// Rotation is positive counter-clockwise as seen on the screen.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "host/clip/track_row.h"

namespace impactdic::impact {

struct Measured {
  double value = kNotMeasured;
  double sd = kNotMeasured;  // one standard deviation
};

enum class ImpactStatus {
  found,
  none,              // the ball does not turn away from the surface in these frames
  wrong_side,        // it does, but on the other side of the surface: turn the angle by 180 degrees
  flight_too_short,  // fewer than 6 frames of free flight before or after the contact
  not_resolved,      // contact of fewer than 8 frames: its start and end are not measured
};
const char* to_string(ImpactStatus status);

struct ImpactOptions {
  double surface_angle_rad = 0;  // counter-clockwise from image-right
  double gravity_angle_rad = -kPi / 2;
  // px/frame^2; nullopt: unknown, fitted to the flights.
  std::optional<double> gravity;
  // I / (m R^2): 2/3 of a thin shell, 2/5 of a solid sphere.
  std::optional<double> inertia_factor;
  int flight_frames = 100;  // longest flight used on each side (dissertation, section 3.2.2)
};

// One free flight, where it meets the contact.
struct FlightMotion {
  std::size_t first = 0, last = 0;  // rows of the fit
  Measured vx, vy, vt, vn, spin;
};

// One side of the contact.
struct ContactEdgeResult {
  Measured instant;
  Measured exponent;       // of the onset's power law
  bool law_holds = false;  // false: the law does not describe the onset; the deviation says so too
};

// m R dv_t against I d(omega), with gravity's impulse taken off: the torque of the friction is what
// spins the ball. Scale and frame rate cancel.
enum class ClosureVerdict {
  undetermined,  // the spin does not change by more than three deviations
  closes,        // within two deviations and 2 %
  signs,         // spin and tangential velocity change the wrong way round: an axis is flipped
  lever_arm,     // off by less than a quarter: the force does not act at the radius
  scale,         // off by more: radius, rotation or inertia is wrong
};
const char* to_string(ClosureVerdict verdict);

struct ImpulseClosure {
  Measured inertia_factor;  // that would close it
  Measured ratio;           // m R dv_t / (I d omega); NaN where the inertia factor is not known
  ClosureVerdict verdict = ClosureVerdict::undetermined;
};

struct ImpactAnalysis {
  ImpactStatus status = ImpactStatus::none;
  ContactEdgeResult start, end;
  Measured turn;      // maximum compression: the normal velocity is zero
  Measured duration;  // from start to end
  FlightMotion before, after;
  Measured restitution;         // -vn after / vn before
  Measured friction_published;  // Eq. 3.12, |dv_t| / |dv_n|; positive where it opposes the slip
  Measured friction;            // the same with gravity's impulse taken off
  Measured rolling_cap;         // the friction that just brings the ball to roll; needs the inertia
  Measured max_deflection;      // of the centre, from the touch to the maximum compression
  ImpulseClosure closure;
  Measured fall;  // gravity as the flights show it, px/frame^2: a check of scale and frame rate
  double radius_px = kNotMeasured;
  double position_scatter = kNotMeasured;  // in flight, over what the track states
  double step_scatter = kNotMeasured;
  // px/frame: between the velocities of centres and of measured motions, beyond chance; 0 where
  // they agree. It is part of the velocities' deviations.
  double disagreement = kNotMeasured;
};

// Analyses the sharpest turn away from the surface among `rows`. Never throws for what a clip
// shows: the status says it.
ImpactAnalysis analyse_impact(const std::vector<TrackRow>& rows, const ImpactOptions& options);

}  // namespace impactdic::impact
