#include "host/run/metres/verify_budgets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host/run/metres/camera_part.h"
#include "host/run/metres/impact_figures.h"
#include "host/run/metres/scale.h"
#include "sim/verify/filmed_impact.h"

namespace impactdic::run {
namespace {

constexpr double kWithin = 0.01;
// A part below this share of the whole deviation does not count in it: 2 % in squares.
constexpr double kCounts = 0.2;
constexpr int kSide_px = 1024;

// The deviations of what is given.
constexpr double kAngleSd_deg = 0.05, kRateSd = 2e-4, kDiameterSd_mm = 0.03, kRadiusSd_px = 0.02;
constexpr double kDistanceSd = 5e-4, kCornerSd = 5e-4;

using P = CameraParameter;

// A shot as it is measured, with all that is given.
struct Shot {
  TrackRequest request;
  TrackResult result;
  std::optional<Camera> camera;

  ImpactFigures conclude() {
    result.scale.surface_angle_rad = request.surface_angle_deg * kRadPerDeg;
    if (camera) {
      conclude_through_camera(*camera, request, result.rows, std::nullopt, result);
    } else {
      conclude_metres(request, std::nullopt, result);
    }
    return result.impact_si;
  }
};

double corner_of(const Camera& camera) { return kSide_px / 2.0 * std::sqrt(2.0) / camera[P::kFx]; }

// Square to the plane, without distortion; its distance and distortion are not known exactly.
Camera camera_of(double metre_per_px) {
  Camera camera;
  camera.width = camera.height = kSide_px;
  camera.from = "dots";
  camera.focal_length_known = true;
  camera[P::kFx] = camera[P::kFy] = 4.0 * kSide_px;
  camera[P::kCx] = camera[P::kCy] = (kSide_px - 1) / 2.0;
  camera[P::kPositionZ] = camera[P::kFx] * metre_per_px;
  const auto state = [&](P parameter, double sd) {
    camera.covariance[static_cast<std::size_t>(parameter) * (kCameraParameters + 1)] = sd * sd;
  };
  state(P::kPositionZ, kDistanceSd * camera[P::kPositionZ]);
  state(P::kK1, kCornerSd / (corner_of(camera) * corner_of(camera)));
  return camera;
}

Shot tennis_shot(bool with_camera) {
  const sim::verify::FilmedImpact filmed = sim::verify::tennis_on_racket();
  Shot shot;
  const sim::verify::FilmedTruth truth = film(filmed, shot.result.rows);
  const TrackRow touch = shot.result.rows[static_cast<std::size_t>(truth.start)];
  for (TrackRow& row : shot.result.rows) {  // the touch comes to the picture's middle
    row.cx_px += kSide_px / 2.0 - touch.cx_px;
    row.cy_px += kSide_px / 2.0 - touch.cy_px;
    row.r_sd_px = kRadiusSd_px;
  }
  TrackRequest& request = shot.request;
  request.surface_angle_deg = filmed.job.surface_angle_deg;
  request.surface_angle_sd_deg = kAngleSd_deg;
  request.inertia_factor = filmed.job.body.inertia_factor();
  shot.result.scale.fps = filmed.fps;
  shot.result.scale.fps_sd = kRateSd * filmed.fps;
  shot.result.scale.image_height = kSide_px;
  if (with_camera) {
    shot.camera = camera_of(filmed.metre_per_px);
  } else {
    request.ball_diameter_mm = 1e3 * filmed.job.body.diameter_m;
    request.ball_diameter_sd_mm = kDiameterSd_mm;
  }
  return shot;
}

// A change of what is given, by so many of its deviations.
struct Change {
  ErrorSource source;
  std::function<void(Shot&, double deviations)> apply;
};

void add_to(Camera& camera, P parameter, double deviations) {
  camera[parameter] += deviations * std::sqrt(camera.variance(parameter));
}

// `scale_sd`: relative.
std::vector<Change> changes_of(bool with_camera, double scale_sd) {
  std::vector<Change> changes = {
      {ErrorSource::kAngle,
       [](Shot& s, double by) { s.request.surface_angle_deg += by * kAngleSd_deg; }},
      {ErrorSource::kTime, [](Shot& s, double by) { s.result.scale.fps *= 1 + by * kRateSd; }}};
  if (with_camera) {
    for (const P parameter : {P::kPositionZ, P::kK1}) {
      changes.push_back({ErrorSource::kCamera,
                         [parameter](Shot& s, double by) { add_to(*s.camera, parameter, by); }});
    }
  } else {
    changes.push_back({ErrorSource::kScale, [scale_sd](Shot& s, double by) {
                         s.request.ball_diameter_mm *= 1 + by * scale_sd;
                       }});
  }
  return changes;
}

// The figures and, by finite differences, their parts; worked out when the first row asks.
class Chain {
 public:
  explicit Chain(bool with_camera) : with_camera_(with_camera) {}

  const Measured& figure(std::size_t which) { return *figures_with_budget(all().figures)[which]; }
  double stated(std::size_t which, ErrorSource source) {
    return all().figures.budgets[which][static_cast<std::size_t>(source)];
  }
  double by_differences(std::size_t which, ErrorSource source) {
    return all().slopes[which][static_cast<std::size_t>(source)];
  }

 private:
  struct All {
    ImpactFigures figures;
    std::array<ErrorParts, kImpactFigures> slopes;
  };

  All& all() {
    if (all_) return *all_;
    all_.emplace();
    const Shot shot = tennis_shot(with_camera_);
    Shot at = shot;
    all_->figures = at.conclude();
    const SiScale& scale = at.result.scale;
    constexpr double kStep = 0.2;  // deviations
    for (const Change& change :
         changes_of(with_camera_, scale.metre_per_px_sd / scale.metre_per_px)) {
      Shot up = shot, down = shot;
      change.apply(up, kStep);
      change.apply(down, -kStep);
      ImpactFigures high = up.conclude(), low = down.conclude();
      const auto plus = figures_with_budget(high), minus = figures_with_budget(low);
      for (std::size_t i = 0; i < kImpactFigures; ++i) {
        double& slope = all_->slopes[i][static_cast<std::size_t>(change.source)];
        slope = std::hypot(slope, (plus[i]->value - minus[i]->value) / (2 * kStep));
      }
    }
    return *all_;
  }

  bool with_camera_;
  std::optional<All> all_;
};

void add_cases(bool with_camera, std::vector<sim::verify::VerifyCase>& cases) {
  const auto chain = std::make_shared<Chain>(with_camera);
  const std::string group = with_camera ? "budgets, with a camera" : "budgets, with the diameter";
  const auto given = with_camera ? ErrorSource::kCamera : ErrorSource::kScale;
  for (std::size_t i = 0; i < kImpactFigures; ++i) {
    const std::string name = to_string(static_cast<ImpactFigure>(i));
    for (const ErrorSource source : {ErrorSource::kAngle, ErrorSource::kTime, given}) {
      cases.push_back({group, name + ": error of the part by " + to_string(source),
                       "independent calculation, finite differences of the whole chain", 0, kWithin,
                       [chain, i, source] {
                         const double slope = chain->by_differences(i, source);
                         const double counts = std::max(slope, kCounts * chain->figure(i).sd);
                         return (chain->stated(i, source) - slope) / counts;
                       }});
    }
    cases.push_back({group, name + ": sum of the parts over the deviation",
                     "limit, GUM 5.1.2: parts add in squares", 1, kWithin, [chain, i] {
                       double squares = 0;
                       for (std::size_t s = 0; s < kErrorSources; ++s) {
                         const double part = chain->stated(i, static_cast<ErrorSource>(s));
                         squares += part * part;
                       }
                       return std::sqrt(squares) / chain->figure(i).sd;
                     }});
  }
}

}  // namespace

std::vector<sim::verify::VerifyCase> budget_cases() {
  std::vector<sim::verify::VerifyCase> cases;
  for (const bool with_camera : {false, true}) add_cases(with_camera, cases);
  return cases;
}

}  // namespace impactdic::run
