// One impact in a track: when it begins, turns and ends, and what it does to the motion.
//
// Axes: global x right, y up; local t along the surface, n out of it. Rotation is positive
// counter-clockwise as seen on the screen. Of a pair in which one figure is not known that one is
// NaN.
#pragma once

#include <impactdic/export.h>
#include <impactdic/measured.h>
#include <impactdic/units.h>

#include <cmath>
#include <cstddef>
#include <optional>

namespace IMPACTDIC_PUBLIC impactdic {

enum class ImpactStatus {
  kFound,
  kNone,            // the ball does not turn away from the surface in these frames
  kWrongSide,       // it does, but on the other side of the surface: turn the angle by 180 degrees
  kFlightTooShort,  // fewer than 6 frames of free flight before or after the contact
  kNotResolved,     // contact of fewer than 8 frames: its start and end are not measured
};
const char* to_string(ImpactStatus status);

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
  kUndetermined,  // the spin does not change by more than three deviations
  kCloses,        // within two deviations and 2 %
  kSigns,         // spin and tangential velocity change the wrong way round: an axis is flipped
  kLeverArm,      // off by less than a quarter: the force does not act at the radius
  kScale,         // off by more: radius, rotation or inertia is wrong
};
const char* to_string(ClosureVerdict verdict);

struct ImpulseClosure {
  Measured inertia_factor;  // that would close it
  Measured ratio;           // m R dv_t / (I d omega); NaN where the inertia factor is not known
  ClosureVerdict verdict = ClosureVerdict::kUndetermined;
};

// The analysis in the track's own units: instants count analysed frames from 0; lengths are px,
// velocities px/frame, spins rad/frame. Everything comes out of the motion itself, no model of the
// contact beyond its onset is assumed.
struct ImpactAnalysis {
  ImpactStatus status = ImpactStatus::kNone;
  ContactEdgeResult start, end;
  Measured turn;      // maximum compression: the normal velocity is zero
  Measured duration;  // from start to end
  FlightMotion before, after;
  Measured restitution;         // -vn after / vn before
  Measured friction_published;  // Eq. 3.12, |dv_t| / |dv_n|; positive where it opposes the slip
  Measured friction;            // the same with gravity's impulse taken off
  Measured rolling_cap;         // impulse ratio that stops and turns the tip; needs the inertia
  Measured max_deflection;      // of the centre, from the touch to the maximum compression
  double touch_x = kNotMeasured,
         touch_y = kNotMeasured;  // the centre at the touch, px, global axes
  // Where both flights, carried on, cross, and how far above the lowest centre that is, px. With
  // the restitution it fixes the time scale of a law of force without any sight of the touch.
  Measured crossing, crossing_above_lowest;
  ImpulseClosure closure;
  Measured fall;  // gravity as the flights show it, px/frame^2: a check of scale and frame rate
  double radius_px = kNotMeasured;
  double position_scatter = kNotMeasured;  // in flight, over what the track states
  double step_scatter = kNotMeasured;
  // px/frame: between the velocities of centres and of measured motions, beyond chance; 0 where
  // they agree. It is part of the velocities' deviations.
  double disagreement = kNotMeasured;
};

// A moment of the contact on the clocks of the clip.
struct ImpactInstant {
  double frame = kNotMeasured, sd_frames = kNotMeasured;  // of the stored file, with its fraction
  double time_s = kNotMeasured, sd_s = kNotMeasured;      // of the track's clock
  bool known() const { return std::isfinite(frame); }
};

// A flight's motion where it meets the contact: m/s and rad/s, or px/frame and rad/frame (see
// ImpactFigures::in_si).
struct ImpactMotion {
  bool known = false;
  double first_frame = kNotMeasured, last_frame = kNotMeasured;  // of the stored file, of the fit
  Measured vx, vy, vt, vn, spin;
};

// The same impact as people read it and files state it: frames of the stored file, seconds, metres.
// Figures that need a scale or a rate which is not known are NaN, but for velocities: they are in
// px and frames then.
struct ImpactFigures {
  ImpactStatus status = ImpactStatus::kNone;
  bool in_si = false;  // velocities are in m/s and rad/s
  ImpactInstant t0, t_max_compression, t_end;
  Measured start_exponent, end_exponent;  // of the power laws at the contact's edges
  bool start_law_holds = false, end_law_holds = false;
  Measured contact_frames, contact_s;
  ImpactMotion before, after;
  Measured restitution, friction_published, friction, rolling_cap;
  Measured max_deflection_px, max_deflection_m;
  ImpulseClosure closure;
  std::optional<double> inertia_factor;  // as it was given
  Measured gravity_m_s2;                 // as the flights show it
  std::optional<bool> gravity_agrees;    // with 9.81 m/s^2, within what can be expected
  double centre_against_motion_px_per_frame = kNotMeasured;
  double centre_scatter = kNotMeasured, motion_scatter = kNotMeasured;  // over what is stated

  // Whether there is an impact: `not_resolved` is one, whose start and end are not measured.
  bool found() const {
    return status == ImpactStatus::kFound || status == ImpactStatus::kNotResolved;
  }
};

}  // namespace impactdic
