// What a standard deviation is made of: the budget of a figure's uncertainty, in the sense of the
// Guide to the Expression of Uncertainty in Measurement (JCGM 100:2008, section 5).
#pragma once

#include <impactdic/export.h>

#include <array>
#include <cstddef>

namespace IMPACTDIC_PUBLIC impactdic {

// A contribution to a figure's deviation. The first is evaluated from scatter (type A of the
// Guide), the others are not (type B).
enum class ErrorSource {
  kNoise,    // scatter of centres, motions and turns from frame to frame
  kCircle,   // what all frames of a flight share: the circle's error, the motion's bias
  kContact,  // the instants at which the contact begins and ends, and the law that finds them
  kAngle,    // the direction of the surface, as far as its tolerance was given
  kScale,    // metres a pixel
  kTime,     // the rate of frames
  kCamera,   // lens and plane of motion, as far as the calibration knows them
};
inline constexpr std::size_t kErrorSources = 7;
const char* to_string(ErrorSource source);

// Standard deviations in the figure's own unit, indexed by ErrorSource. The root of the sum of
// their squares is the figure's deviation.
using ErrorParts = std::array<double, kErrorSources>;

}  // namespace impactdic
