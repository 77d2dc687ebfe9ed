#include "host/run/metres/sphere_sight.h"

#include <cmath>
#include <cstdio>

namespace impactdic::run {
namespace {

constexpr double kBeyondChance = 2;

}  // namespace

motion::Perspective perspective_of(const TrackRequest& request, const std::optional<Camera>& camera,
                                   const ClipInfo& clip, double radius_px) {
  using P = CameraParameter;
  if (camera && camera->focal_length_known) {
    // Where the ball is, a px of it is the distance over the focal length. Both lengths err alike.
    const double f_px = std::sqrt((*camera)[P::kFx] * (*camera)[P::kFy]);
    const double f_sd_px = std::sqrt((camera->variance(P::kFx) + camera->variance(P::kFy)) / 2);
    return {1 / f_px, (*camera)[P::kCx], (*camera)[P::kCy], radius_px / f_px * (f_sd_px / f_px)};
  }
  motion::Perspective seen;
  seen.axis_x_px = (clip.width - 1) / 2.0;
  seen.axis_y_px = (clip.height - 1) / 2.0;
  seen.nearness_sd = motion::kUnknownNearness;
  double mm_per_px = request.mm_per_px, by_scale = 0;
  if (request.ball_diameter_mm > 0) {
    mm_per_px = request.ball_diameter_mm / (2 * radius_px);
    by_scale = request.ball_diameter_sd_mm / request.ball_diameter_mm;
  } else if (mm_per_px > 0) {
    by_scale = request.mm_per_px_sd / mm_per_px;
  }
  if (!(request.distance_mm > 0 && mm_per_px > 0 && std::isfinite(mm_per_px))) return seen;
  seen.by_distance_per_px = mm_per_px / request.distance_mm;
  seen.nearness_sd = seen.by_distance_per_px * radius_px *
                     std::hypot(by_scale, request.distance_sd_mm / request.distance_mm);
  return seen;
}

motion::Perspective as_pictures_show(motion::Perspective seen, const Measured& nearness,
                                     double radius_px) {
  if (!std::isfinite(nearness.value) || !(nearness.sd < motion::kUnknownNearness)) return seen;
  // Below, rays are as good as parallel, and registered faster.
  const bool told = nearness.value > kBeyondChance * nearness.sd;
  seen.by_distance_per_px = told ? nearness.value / radius_px : 0;
  seen.nearness_sd = told ? nearness.sd : std::hypot(nearness.value, nearness.sd);
  return seen;
}

Measured outline_radius(const Measured& radius_px, const motion::Perspective& seen) {
  const double nearness = seen.by_distance_per_px * radius_px.value, sd = seen.nearness_sd;
  const double within = std::sqrt(1 - nearness * nearness);
  const double by_nearness = nearness * sd / (within * within * within) + sd * sd / 2;
  return {radius_px.value / within, std::hypot(radius_px.sd, radius_px.value * by_nearness)};
}

motion::Perspective in_region(motion::Perspective perspective, const Roi& roi) {
  perspective.axis_x_px -= roi.x;
  perspective.axis_y_px -= roi.y;
  return perspective;
}

void state_nearness(const std::optional<Camera>& camera, const motion::Perspective& perspective,
                    const Measured& shown, TrackResult& result) {
  result.sphere_nearness = {perspective.by_distance_per_px * result.sphere_radius_px.value,
                            perspective.nearness_sd};
  const char* given = camera && camera->focal_length_known ? "camera" : "distance";
  result.nearness_from = perspective.is_unknown()     ? "nothing"
                         : std::isfinite(shown.value) ? "pictures"
                                                      : given;
}

std::string sphere_in_words(const Measured& radius_px, const motion::Perspective& perspective) {
  char text[160];
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
