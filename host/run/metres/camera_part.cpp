#include "host/run/metres/camera_part.h"

#include <impactdic/error.h>

#include <array>
#include <cmath>
#include <utility>

#include "host/base/parallel/parallel_for.h"
#include "host/camera/correct_rows.h"
#include "host/camera/lens.h"
#include "host/camera/spread.h"
#include "host/clip/track_row.h"
#include "host/dic/rim_margin.h"
#include "host/run/metres/contradictions.h"
#include "host/run/metres/impact_figures.h"
#include "host/run/metres/scale.h"

namespace impactdic::run {
namespace {

using camera::PlaneView;
using camera::RowCorrection;

// Every figure with a deviation; the first are those that have a budget, in their order.
std::vector<Measured*> measured_figures(ImpactFigures& f) {
  const auto first = figures_with_budget(f);
  std::vector<Measured*> all(first.begin(), first.end());
  for (Measured* more :
       {&f.flight.vx, &f.flight.vy, &f.flight.vt, &f.flight.vn, &f.flight.spin, &f.gravity_m_s2,
        &f.surface_angle_deg, &f.gravity_angle_deg, &f.max_deflection_px, &f.closure.ratio}) {
    all.push_back(more);
  }
  return all;
}

// What follows from the rows as one camera corrects them.
struct Conclusion {
  TrackResult result;                        // its rows are the corrected ones, where they are kept
  std::vector<std::array<double, 3>> rates;  // of each row: along x and y, m/s; spin, rad/s
};

class ThroughCamera {
 public:
  ThroughCamera(const TrackRequest& request, const std::vector<TrackRow>& rows,
                const std::optional<Measured>& sphere_radius_px, const motion::Perspective& seen,
                const TrackResult& measured, double metre_per_px)
      : request_(request),
        rows_(rows),
        sphere_radius_px_(sphere_radius_px),
        seen_(seen),
        measured_(measured),
        metre_per_px_(metre_per_px),
        seen_radius_px_(median_radius_px(rows)) {}

  Conclusion operator()(const Camera& camera, Impacts impacts, bool keep_rows) const {
    Conclusion found;
    const bool sphere = measured_.body == Body::kSphere;
    TrackResult& result = found.result;
    result.rows = RowCorrection(camera, sphere, metre_per_px_, dic::kRimMarginPx).correct(rows_);
    result.scale = measured_.scale;
    result.body = measured_.body;
    std::optional<Measured> radius = sphere_radius_px_;
    const auto corrected = median_radius_px(result.rows);
    if (radius && corrected && seen_radius_px_) {
      const double larger = *corrected / *seen_radius_px_;
      radius = {radius->value * larger, radius->sd * larger};
    }
    TrackRequest request = request_;
    if (request.ball_diameter_mm == 0) request.mm_per_px = metre_per_px_ * 1e3;
    if (request.distance_mm == 0 && camera.focal_length_known) {
      request.distance_mm = PlaneView(camera).eye().z() * 1e3;
    }
    // The corrected rows of a camera that knows its focal length are about the ball's centre.
    motion::Perspective seen = seen_;
    if (camera.focal_length_known) seen.by_distance_per_px = 0;
    conclude_metres(request, radius, result.rows, result, seen, impacts);
    for (const TrackRow& row : result.rows) {
      const SiRow si = to_si(row, result.scale);
      found.rates.push_back({si.vx_m_s, si.vy_m_s, si.omega_rad_s});
    }
    if (!keep_rows) result.rows = {};
    return found;
  }

 private:
  const TrackRequest& request_;
  const std::vector<TrackRow>& rows_;
  const std::optional<Measured>& sphere_radius_px_;
  const motion::Perspective& seen_;
  const TrackResult& measured_;
  double metre_per_px_;
  std::optional<double> seen_radius_px_;
};

void add(double difference, double& sd) {
  if (std::isfinite(difference)) sd = std::hypot(sd, difference);
}

// How far before the plane the ball flies: its size tells, where its diameter is known. Seen from
// the distance L a ball at z before the plane looks L / (L - z) times as large.
std::optional<Measured> before_plane(const PlaneView& view, const Measured& scale,
                                     const TrackRequest& request, const TrackResult& result) {
  const Measured& radius = result.impact.radius_px;
  if (request.ball_diameter_mm == 0 || !(radius.value > 0)) return std::nullopt;
  const double ratio = result.scale.metre_per_px / scale.value;
  const double distance = view.eye().z();
  const double relative =
      std::hypot(result.scale.metre_per_px_sd / result.scale.metre_per_px, scale.sd / scale.value);
  return Measured{distance * (1 - ratio), distance * ratio * relative};
}

void add_camera_parts(const std::vector<Conclusion>& plus, const std::vector<Conclusion>& minus,
                      const std::vector<camera::CameraStep>& steps, TrackResult& result) {
  ImpactFigures& figures = result.impact_si;
  const std::vector<Measured*> stated = measured_figures(figures);
  std::vector<double> parts(stated.size(), 0.0);
  std::vector<CameraRowSd>& row_sd = result.camera->row_sd;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const double width = 2 * steps[s].deviations;
    ImpactFigures up = plus[s].result.impact_si, down = minus[s].result.impact_si;
    const std::vector<Measured*> high = measured_figures(up), low = measured_figures(down);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      add((high[i]->value - low[i]->value) / width, parts[i]);
    }
    for (std::size_t i = 0; i < row_sd.size(); ++i) {
      const auto &a = plus[s].rates[i], &b = minus[s].rates[i];
      add((a[0] - b[0]) / width, row_sd[i].vx_m_s);
      add((a[1] - b[1]) / width, row_sd[i].vy_m_s);
      add((a[2] - b[2]) / width, row_sd[i].omega_rad_s);
    }
  }
  for (std::size_t i = 0; i < stated.size(); ++i) {
    if (!std::isfinite(stated[i]->value)) continue;
    stated[i]->sd = std::hypot(stated[i]->sd, parts[i]);
    if (i < kImpactFigures) {
      figures.budgets[i][static_cast<std::size_t>(ErrorSource::kCamera)] = parts[i];
    }
  }
}

}  // namespace

void check_camera_fits(const Camera& camera, const ClipInfo& clip, const std::string& file) {
  if (camera.width == clip.width && camera.height == clip.height) return;
  throw InvalidArgument("the camera was calibrated with pictures of " +
                            std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                            " px, the clip has " + std::to_string(clip.width) + " x " +
                            std::to_string(clip.height),
                        "--camera " + file);
}

void conclude_through_camera(const Camera& camera, const TrackRequest& request,
                             const std::vector<TrackRow>& rows,
                             const std::optional<Measured>& sphere_radius_px, TrackResult& result,
                             const motion::Perspective& perspective) {
  const PlaneView view(camera);
  const Measured scale = camera::scale_at_middle(camera);
  const ThroughCamera through(request, rows, sphere_radius_px, perspective, result, scale.value);
  Conclusion found = through(camera, Impacts::kLookedFor, true);
  const std::vector<camera::CameraStep> steps = camera::principal_steps(camera);
  std::vector<Conclusion> plus(steps.size()), minus(steps.size());
  const Impacts impacts = found.result.impact_si.found() ? Impacts::kKnown : Impacts::kLookedFor;
  parallel_for(2 * steps.size(), 0, [&](std::size_t i) {
    const camera::CameraStep& step = steps[i / 2];
    if (i % 2 == 0)
      plus[i / 2] = through(step.plus, impacts, false);
    else
      minus[i / 2] = through(step.minus, impacts, false);
  });
  result.scale = found.result.scale;
  result.impact = std::move(found.result.impact);
  result.impact_si = std::move(found.result.impact_si);
  result.more_impacts_si = std::move(found.result.more_impacts_si);
  result.camera.emplace();
  CameraFigures& figures = *result.camera;
  figures.rows = std::move(found.result.rows);
  figures.row_sd.resize(figures.rows.size());
  figures.metre_per_px = scale;
  figures.tilt_deg = camera.focal_length_known ? view.tilt_rad() * kDegPerRad : kNotMeasured;
  figures.from = camera.from;
  if (camera.focal_length_known) {
    if (const auto z = before_plane(view, scale, request, result)) figures.before_plane_m = *z;
  }
  add_camera_parts(plus, minus, steps, result);
  // What is known less well contradicts less.
  if (result.impact_si.found()) {
    result.impact_si.contradictions.clear();
    find_contradictions(request, result.impact, result.impact_si);
  }
}

}  // namespace impactdic::run
