#pragma once

namespace impactdic::sphere {

// BallTask.blur of pictures in focus, px²: a lens of 0.6 px, the pixel, and the registration's
// pre-smoothing of 0.5 px, as second differences see them.
inline constexpr double kUsualBlur_px2 = 0.75;

}  // namespace impactdic::sphere
