// What a track tells of its impact: the flights on both sides, when the contact begins and ends,
// restitution and effective friction. The analysis is that of `track` (host/impact), in SI units.
#pragma once

#include <string>

#include "sim/contact/body.h"
#include "sim/contact/impact.h"
#include "sim/shot/track_table.h"

namespace impactdic::sim::shot {

struct Estimate {
  double value = 0, sd = 0;
};

// One flight, at the instant where the contact begins or ends. Local axes (t, n) of the surface.
struct Flight {
  std::size_t first = 0, last = 0;       // frames of the fit
  Estimate vt_m_s, vn_m_s, omega_rad_s;  // omega NaN: the track has no rotation
};

struct Shot {
  std::string file;
  double surface_angle_deg = 0;
  Flight before, after;
  Estimate contact_start_s, contact_end_s, contact_s;
  double t_max_compression_s = 0;  // from the contact's start
  Estimate max_deflection_m;
  double touch_x_m = 0, touch_y_m = 0;  // the centre at the first touch, world axes
  double noise_m = 0;                   // of one centre, one coordinate
  Estimate restitution;
  // Eq. 3.12, with gravity, rolling cap; positive where friction opposes the slip.
  contact::EffectiveFriction friction;
  double friction_sd = 0;
  // The normal position where both flights, carried on, cross, above the lowest one measured. With
  // the restitution it fixes a law's time scale, and needs no sight of the instant of touch.
  Estimate crossing_above_lowest_m;
  double crossing_s = 0;  // when they cross, on the track's clock
};

struct ShotOptions {
  contact::Body body;
  double surface_angle_deg = 0;
  double gravity_m_s2 = 9.81;
  int flight_frames = 100;  // the longest flight used on each side, as in section 3.2.2
};

// Restitution and effective friction from the flights. When the contact is matters through gravity:
// the two velocities are those of its ends.
void derive(Shot& shot, const contact::Body& body, double gravity_m_s2);

// Says that the contact begins and lasts otherwise than the shot has it: carries both flights to
// the new instants and derives anew what follows from them.
void move_contact(Shot& shot, const Estimate& start_s, const Estimate& duration_s,
                  const contact::Body& body, double gravity_m_s2);

// The impact as host/impact/impact_phases.h finds it, with gravity and the body's radius known. A
// centre without a stated deviation is taken for as good as its scatter from frame to frame. Where
// the contact is too short for its ends to be seen they are between flight and turn, and their
// deviations say so. Throws FormatError naming the file where the track shows no contact, or too
// few frames of it or of a flight.
Shot measure_shot(const Track& track, const ShotOptions& options);

}  // namespace impactdic::sim::shot
