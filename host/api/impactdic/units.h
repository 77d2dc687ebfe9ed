// Constants and conversions between the file's units (px, frame, degrees) and SI.
#pragma once

#include <impactdic/export.h>

#include <limits>
#include <numbers>

namespace IMPACTDIC_PUBLIC impactdic {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegPerRad = 180.0 / kPi;
inline constexpr double kRadPerDeg = kPi / 180.0;
// A value that could not be measured: empty in CSV, NaN in HDF5, null in JSON.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

}  // namespace impactdic
