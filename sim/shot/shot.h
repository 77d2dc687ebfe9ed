// What a track tells of its impact: the flights on both sides, when the contact begins and ends,
// restitution and effective friction. The analysis is that of `track` (host/impact), in SI units.
#pragma once

#include <impactdic/fit.h>

#include "sim/shot/track_table.h"

namespace impactdic::sim::shot {

struct ShotOptions {
  ImpactBody body;
  double surface_angle_deg = 0;
  double gravity_m_s2 = 9.81;
  int flight_frames = 100;  // the longest flight used on each side, as in section 3.2.2
};

// Restitution and effective friction from the flights. When the contact is matters through gravity:
// the two velocities are those of its ends.
void derive(MeasuredShot& shot, const ImpactBody& body, double gravity_m_s2);

// Says that the contact begins and lasts otherwise than the shot has it: carries both flights to
// the new instants and derives anew what follows from them.
void move_contact(MeasuredShot& shot, const Measured& start_s, const Measured& duration_s,
                  const ImpactBody& body, double gravity_m_s2);

// The impact as host/impact/impact_phases.h finds it, with gravity and the body's radius known. A
// centre without a stated deviation is taken for as good as its scatter from frame to frame. Where
// the contact is too short for its ends to be seen they are between flight and turn, and their
// deviations say so. Throws FormatError naming the file where the track shows no contact, or too
// few frames of it or of a flight.
MeasuredShot measure_shot(const MeasuredTrack& track, const ShotOptions& options);

}  // namespace impactdic::sim::shot
