#include "host/run/metres/scale.h"

#include <cmath>
#include <utility>

#include "host/clip/track_row.h"
#include "host/run/metres/contradictions.h"
#include "host/run/metres/impact_figures.h"
#include "host/run/metres/sphere_sight.h"

namespace impactdic::run {
namespace {

// The rim of a sphere lies inside of where its surface turns away, by 0.1 to 0.35 px
// (docs/accuracy/sphere.md): that much a radius by the rim alone is in doubt.
constexpr double kSphereRimSd_px = 0.25;

// What film that is coded for screens shows of a radius that is not its light's: half of the light
// is not half of the grey level. [measured] docs/accuracy/light.md: 0.10 to 0.73 px
constexpr double kCodedLightSd_px = 0.35;

bool is_light_in_doubt(const TrackRequest& request, const ClipInfo& clip) {
  return clip.lossy && request.clip.open.gamma == 0;
}

Measured as_light(const TrackRequest& request, const ClipInfo& clip, Measured radius_px) {
  if (is_light_in_doubt(request, clip)) {
    radius_px.sd = std::hypot(radius_px.sd, kCodedLightSd_px);
  }
  return radius_px;
}

void set_scale(const TrackRequest& request, const Measured& radius_px, SiScale& scale) {
  if (request.mm_per_px > 0) {
    scale.metre_per_px = request.mm_per_px * 1e-3;
    scale.metre_per_px_sd = request.mm_per_px_sd * 1e-3;
  } else if (request.ball_diameter_mm > 0 && radius_px.value > 0) {
    scale.metre_per_px = request.ball_diameter_mm * 1e-3 / (2 * radius_px.value);
    const double radius_sd = std::isfinite(radius_px.sd) ? radius_px.sd / radius_px.value : 0.0;
    scale.metre_per_px_sd =
        scale.metre_per_px *
        std::hypot(radius_sd, request.ball_diameter_sd_mm / request.ball_diameter_mm);
  }
}

bool is_found(const ImpactAnalysis& impact) {
  return impact.status == ImpactStatus::kFound || impact.status == ImpactStatus::kNotResolved;
}

// With which gravity is fitted to the flights.
SiScale no_scale(const TrackResult& result) {
  SiScale scale = result.scale;
  scale.metre_per_px = 0;
  return scale;
}

// A surface far from the one that was given shows no impact, or one that turns the wrong way.
void look_for_another_surface(const TrackRequest& request, const TrackRows& rows,
                              const FilmedBall& ball, TrackResult& result) {
  for (const double off_deg : {45.0, -45.0, 90.0, -90.0, 135.0, -135.0}) {
    SiScale scale = result.scale;
    scale.surface_angle_rad += off_deg * kRadPerDeg;
    const ImpactAnalysis other = analyse_impact(request, rows, scale, ball);
    if (other.status != ImpactStatus::kFound) continue;
    note_other_surface(request, other, request.surface_angle_deg + off_deg, result.impact_si);
    return;
  }
}

}  // namespace

std::string light_warning(const TrackRequest& request, const ClipInfo& clip) {
  const bool by_radius = request.ball_diameter_mm > 0 && !(request.mm_per_px > 0);
  if (!by_radius || !is_light_in_doubt(request, clip)) return "";
  return "the grey levels of film are seldom in proportion to the light, which shifts the ball's "
         "rim: the scale holds 0.35 px for that; --gamma 2.2 (most film) turns them back to "
         "light, --gamma 1 says that they are";
}

void conclude_metres(const TrackRequest& request, const std::optional<Measured>& sphere_radius_px,
                     const TrackRows& measured, TrackResult& result,
                     const motion::Perspective& perspective, Impacts impacts) {
  const EvenRows even(measured, about_centres(perspective));
  const TrackRows rows(even);
  // The flights are found with gravity in px/frame^2, for which about the scale will do.
  const auto about = median_radius_px(measured);
  set_scale(request, {about.value_or(kNotMeasured), 0}, result.scale);
  ImpactAnalysis first = analyse_impact(
      request, rows, result.scale, {sphere_radius_px, perspective, result.clip.lossy}, impacts);
  const double first_metre_per_px = result.scale.metre_per_px;
  std::optional<Measured> radius = sphere_radius_px;
  if (result.body == Body::kSphere && !radius) {
    radius = first.radius_px;
    radius->sd = std::hypot(radius->sd, kSphereRimSd_px);
  }
  const FilmedBall ball = {radius, perspective, result.clip.lossy};
  set_scale(request, as_light(request, result.clip, radius.value_or(first.radius_px)),
            result.scale);
  // `with`: the scale that gave the analysis its gravity.
  const auto conclude = [&](ImpactAnalysis impact, const SiScale& with) {
    result.impact = std::move(impact);
    result.impact_si = convert_impact(request, rows, result.scale, result.impact);
    find_contradictions(request, result.impact, result.impact_si);
    result.more_impacts_si.clear();
    if (impacts == Impacts::kKnown) return;
    for (const ImpactAnalysis& other : other_impacts(request, rows, with, ball, result.impact)) {
      result.more_impacts_si.push_back(convert_impact(request, rows, result.scale, other));
    }
  };
  // Where scale and radius are given, the first analysis had them.
  const bool as_first = result.scale.metre_per_px == first_metre_per_px &&
                        radius.has_value() == sphere_radius_px.has_value();
  conclude(as_first ? std::move(first) : analyse_impact(request, rows, result.scale, ball, impacts),
           result.scale);
  if (is_found(result.impact) && !contradicts(result.impact_si, "gravity")) return;
  // With a scale or rate that is far off, so is gravity, and bends the flights.
  const SiScale without = no_scale(result);
  ImpactAnalysis free = analyse_impact(request, rows, without, ball, impacts);
  if (!is_found(free)) {
    if (impacts == Impacts::kLookedFor) {
      look_for_another_surface(request, rows, ball, result);
    }
    return;
  }
  set_scale(request, as_light(request, result.clip, radius.value_or(free.radius_px)), result.scale);
  conclude(std::move(free), without);
}

void conclude_metres(const TrackRequest& request, const std::optional<Measured>& sphere_radius_px,
                     TrackResult& result) {
  conclude_metres(request, sphere_radius_px, result.rows, result);
}

}  // namespace impactdic::run
