#include "host/run/metres/sphere_sight.h"

#include <cmath>
#include <cstdio>

namespace impactdic::run {

motion::Perspective perspective_of(const TrackRequest& request, const std::optional<Camera>& camera,
                                   const ClipInfo& clip, double radius_px) {
  using P = CameraParameter;
  if (camera) {
    // Where the ball is, a px of it is the distance over the focal length.
    if (!camera->focal_length_known) return {};
    return {1 / std::sqrt((*camera)[P::kFx] * (*camera)[P::kFy]), (*camera)[P::kCx],
            (*camera)[P::kCy]};
  }
  double mm_per_px = request.mm_per_px;
  if (request.ball_diameter_mm > 0) mm_per_px = request.ball_diameter_mm / (2 * radius_px);
  if (!(request.distance_mm > 0 && mm_per_px > 0 && std::isfinite(mm_per_px))) return {};
  return {mm_per_px / request.distance_mm, (clip.width - 1) / 2.0, (clip.height - 1) / 2.0};
}

motion::Perspective in_region(motion::Perspective perspective, const Roi& roi) {
  perspective.axis_x_px -= roi.x;
  perspective.axis_y_px -= roi.y;
  return perspective;
}

std::string sphere_in_words(const Measured& radius_px, const motion::Perspective& perspective) {
  char text[120];
  const int end = std::snprintf(text, sizeof text, "radius of the sphere: %.3f +- %.3f px",
                                radius_px.value, radius_px.sd);
  if (perspective) {
    std::snprintf(text + end, sizeof text - static_cast<std::size_t>(end),
                  ", seen from %.4g of its radii away",
                  1 / (perspective.by_distance_per_px * radius_px.value));
  }
  return text;
}

std::function<void(TrackRow&)> about_centres(const motion::Perspective& perspective) {
  if (!perspective) return {};
  return [perspective](TrackRow& row) {
    if (!row.circle_ok) return;
    const Circle ball = motion::about_centre({row.cx_px, row.cy_px, row.r_px}, perspective);
    row.cx_px = ball.cx_px;
    row.cy_px = ball.cy_px;
  };
}

}  // namespace impactdic::run
