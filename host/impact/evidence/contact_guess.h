// About when a surface acts on a ball: it seeds the fits. Internal to the impact analysis.
#pragma once

#include <cstddef>
#include <vector>

#include "host/impact/flight_fit.h"
#include "host/impact/impact_series.h"

namespace impactdic::impact {

// Where the motion turns from towards the surface to away from it, and about how long the surface
// acts. Coarse: it seeds the fits.
struct ContactGuess {
  bool found = false;
  double turn = 0;                  // the instant at which the normal velocity changes sign
  std::size_t first = 0, last = 0;  // instants within which the surface acts
  double peak_acceleration = 0;     // px/frame^2
  double step_noise = 0;            // px, from the scatter of second differences
  double faint = 0;                 // part of the peak below which noise hides the acceleration
};
// Looks at the track frame by frame and, where noise hides the contact, at blocks of 2, 4, … 16
// frames. `gravity_n`: normal acceleration of free flight, px/frame^2 (0 where it is unknown).
ContactGuess guess_contact(const ImpactSeries& series, double gravity_n);

// The noise of values that follow each other, out of second differences, which no smooth path
// makes.
double noise_of(const std::vector<double>& values);

// A flight is no shorter; and so far at least lies it from the contact, but in short clips.
inline constexpr std::size_t kFewestFlightFrames = 6, kLeastGuard = 3;  // frames
// How far the flights shall lie from a contact in rows 0 … last_row, frames.
std::size_t guard_of(const ContactGuess& guess, std::size_t last_row);

// `flight`, less another impact or a hand at the end far from the contact: ten frames must go on as
// those nearer to the contact do. `before`: it is the flight before the contact.
FlightRange trimmed(const ImpactSeries& series, const ContactGuess& guess, FlightRange flight,
                    bool before, double gravity_n);

}  // namespace impactdic::impact
