// A background that changes from pixel to pixel. Internal to host/circle.
#pragma once

#include <optional>

#include "host/circle/rays/rays.h"

namespace impactdic::circle {

// Its level at each edge; Rays::ball and Rays::outside must be known.
class UnevenGround {
 public:
  // nullopt where it changes within sectors by no more than noise does.
  static std::optional<UnevenGround> find(Rays& rays, int n, double per_ray_px, float noise);
  // Just outside the edge of ray `i`, along the line through what it and the rays beside it show
  // farther out.
  float beside(int i) const;

 private:
  UnevenGround(const Rays& rays, int n, int beside, float usual_fall)
      : rays_(&rays), n_(n), beside_(beside), usual_fall_(usual_fall) {}

  const Rays* rays_;
  int n_, beside_;
  float usual_fall_;
};

}  // namespace impactdic::circle
