// One impact in a track: when it begins, turns and ends, and what it does to the motion.
//
// Axes: global x right, y up; local t along the surface, n out of it. Rotation is positive
// counter-clockwise as seen on the screen. Of a pair in which one figure is not known that one is
// NaN.
#pragma once

#include <impactdic/export.h>
#include <impactdic/measured.h>
#include <impactdic/uncertainty.h>
#include <impactdic/units.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

enum class ImpactStatus {
  kFound,
  kNone,            // the ball does not turn away from the surface in these frames
  kWrongSide,       // it does, but on the other side of the surface: turn the angle by 180 degrees
  kFlightTooShort,  // fewer than 6 frames of free flight before or after the contact
  kNotResolved,     // a contact whose start and end are not told
};
const char* to_string(ImpactStatus status);

// The figures that have a budget of their uncertainty.
enum class ImpactFigure {
  kVxBefore,
  kVyBefore,
  kVtBefore,
  kVnBefore,
  kSpinBefore,
  kVxAfter,
  kVyAfter,
  kVtAfter,
  kVnAfter,
  kSpinAfter,
  kRestitution,
  kFrictionPublished,
  kFriction,
  kRollingCap,
  kClosingInertia,
  kContactDuration,
  kMaxDeflection,
};
inline constexpr std::size_t kImpactFigures = 17;
const char* to_string(ImpactFigure figure);

// In px and frames, as the analysis has it.
struct FigureBudget {
  ErrorParts parts{};  // kScale and kTime are 0 here
  // Change of the figure for a change of gravity by its own size: scale and frame rate enter the
  // flights through gravity in px/frame^2 as well.
  double per_gravity = 0;
};

// One free flight, where it meets the contact. Of a sphere the spin has three components: `spin` is
// that towards the camera, about t x n.
struct FlightMotion {
  std::size_t first = 0, last = 0;  // rows of the fit
  Measured vx, vy, vt, vn, spin;
  Measured spin_t, spin_n;  // about t and n; NaN of a flat ball
  Measured vb;  // along t x n, towards the camera; NaN where the camera's distance is not known
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

// Of a ball that was measured as a sphere, in the surface's axes t, n and b = t x n, towards the
// camera.
struct MeasuredVector {
  Measured t, n, b;
};

// What an impact does out of the picture's plane; plane figures are elsewhere. The velocity along b
// is known where the camera's distance is (FlightMotion::vb), and taken for 0 before the contact
// elsewhere. The friction along b is what the spin about t shows, which needs the inertia factor
// (I d(omega_t) = -R J_b).
struct SpaceImpact {
  MeasuredVector spin_before, spin_after;
  Measured slip_t, slip_b;  // velocity of the contact point along the surface, before
  // Impulse ratios along t and b, gravity taken off, and the size of the two.
  Measured friction_t, friction_b, friction;
  Measured friction_off_rad;  // from the direction against the slip to the friction: 0 expected
  Measured spin_change_n;     // a contact at a point cannot change the spin about n: 0 expected
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
  Measured
      fall_across;  // the same across the given direction, counter-clockwise: 0 if that is right
  // How far the surface lies counter-clockwise of the angle given, rad: the impulse along the
  // surface must be the one that changes the spin. NaN where the spin was not measured.
  Measured surface_off_rad;
  // Of the free ball, from the frames of the flights alone; of all frames where none is found.
  Measured radius_px;
  std::size_t radius_frames = 0;          // that it is the mean of
  double radius_drift_px = kNotMeasured;  // after the contact less before it
  // Where there is no impact and the whole track is one free flight: its motion in the middle of
  // the rows, out of positions, motions, turns and gravity together. `last` is 0 where it is none.
  FlightMotion flight;
  double position_scatter = kNotMeasured;  // in flight, over what the track states
  double step_scatter = kNotMeasured;
  // px/frame: between the velocities of centres and of measured motions, beyond chance; 0 where
  // they agree. It is part of the velocities' deviations.
  double disagreement = kNotMeasured;
  std::array<FigureBudget, kImpactFigures> budgets{};  // indexed by ImpactFigure
  std::optional<SpaceImpact> space;                    // of a sphere
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
  Measured spin_t, spin_n;  // of a sphere, about t and n
  Measured vz;              // towards the camera; NaN where its distance is not known
};

// Two things that cannot both be true: something given, and what the clip shows.
struct Contradiction {
  std::string what;     // "surface_angle", "inertia_factor", "gravity", "gravity_angle", "scale",
                        // "drop_height", "restitution", "friction", "radius"
  std::string message;  // one line, which names the likely slip
  std::vector<ImpactFigure> figures;  // that are doubtful for it
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
  ImpactMotion flight;  // where there is no impact and the whole track is one free flight
  Measured restitution, friction_published, friction, rolling_cap;
  Measured max_deflection_px, max_deflection_m;
  ImpulseClosure closure;
  std::optional<double> inertia_factor;  // as it was given
  Measured gravity_m_s2;                 // as the flights show it
  std::optional<bool> gravity_agrees;    // with 9.81 m/s^2, within what can be expected
  Measured surface_angle_deg;  // as path and spin show it; NaN where the spin was not measured
  Measured gravity_angle_deg;  // as the flights show it
  double centre_against_motion_px_per_frame = kNotMeasured;
  double centre_scatter = kNotMeasured, motion_scatter = kNotMeasured;  // over what is stated
  // What the deviations above are made of, in the figures' own units; indexed by ImpactFigure.
  std::array<ErrorParts, kImpactFigures> budgets{};
  const ErrorParts& budget(ImpactFigure figure) const {
    return budgets[static_cast<std::size_t>(figure)];
  }

  std::vector<Contradiction> contradictions;
  // Whether a contradiction concerns the figure: its value and deviation are then not to be relied
  // on.
  bool is_doubtful(ImpactFigure figure) const;
  std::optional<SpaceImpact> space;  // of a sphere; in m/s and rad/s where in_si

  // Whether there is an impact: `not_resolved` is one, whose start and end are not measured.
  bool found() const {
    return status == ImpactStatus::kFound || status == ImpactStatus::kNotResolved;
  }
};

}  // namespace impactdic
