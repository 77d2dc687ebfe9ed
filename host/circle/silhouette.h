// The outline of a body that is no sphere, as an ellipse: of what stands alone before an even
// background.
#pragma once

#include <impactdic/image.h>

#include <optional>

#include "host/circle/circle.h"

namespace impactdic::circle {

struct Silhouette {
  // The ellipse with the area and the second moments of what the outline encloses, as in CircleFit:
  // semi-axes r_px ± |e|, the long one at ½ atan2(e2, e1).
  Circle circle;
  double e1_px = 0, e2_px = 0;
  double rim_px = 0;           // rms distance of the outline from the ellipse
  double centre_sd_px = 0;     // of each coordinate, and of the radius and e1, e2, by that distance
  Image<std::uint8_t> inside;  // not 0: enclosed by the outline; of the frame's size

  double long_px() const;
  double short_px() const;
  // The long semi-axis over the short one.
  double stretch() const { return long_px() / short_px(); }
};

// The largest thing that differs from the level of the picture's border. nullopt where there is
// none, where the border is no even background, or where an ellipse is no picture of the outline.
std::optional<Silhouette> find_silhouette(const Frame& frame);

// As a row of a track states it.
CircleFit as_fit(const Silhouette& silhouette);

}  // namespace impactdic::circle
