#include <impactdic/error.h>
#include <impactdic/fit.h>

#include <algorithm>
#include <cmath>

#include "sim/fit/calibration.h"

namespace impactdic {
namespace {

constexpr std::size_t kFewestCentres = 20;
constexpr double kUnevenness = 0.01;  // of the interval

void require(bool good, const char* what, const char* key, const char* hint = "") {
  if (!good) throw InvalidArgument(what, key, hint);
}

void require_positive(double value, const char* key) {
  require(value > 0 && std::isfinite(value), "must be positive", key);
}

}  // namespace

std::string key_of(FitParameter parameter, NormalModel normal) {
  switch (parameter) {
    case FitParameter::kStiffness:
      return has_hertz_spring(normal) ? "stiffness_n_per_m1p5" : "stiffness_n_per_m";
    case FitParameter::kDamping: {
      const std::string_view key = damping_key(normal);
      return key.empty() ? "damping_n_s_per_m" : std::string(key);
    }
    case FitParameter::kFrictionKinetic:
      return "friction_kinetic";
    case FitParameter::kFrictionStatic:
      return "friction_static";
    case FitParameter::kPoisson:
      return "poisson";
    case FitParameter::kYieldStrength:
      return "yield_strength_pa";
    case FitParameter::kContactTime:
      return "contact_time_s";
    case FitParameter::kSurfaceAngle:
      return "surface_angle_deg";
    case FitParameter::kScale:
      return "scale";
    case FitParameter::kRate:
      return "rate";
    case FitParameter::kDrag:
      return "drag_coefficient";
    case FitParameter::kLift:
      return "lift_coefficient";
    case FitParameter::kShellStiffness:
      return "shell_stiffness_n_per_m";
    case FitParameter::kShellDamping:
      return "shell_damping_n_s_per_m";
    case FitParameter::kFlatFraction:
      return "flat_fraction";
  }
  return "";
}

void MeasuredTrack::validate() const {
  const std::size_t frames = time_s.size();
  const auto fail = [this](const char* what, const char* hint = "") {
    throw InvalidArgument(what, file.empty() ? "track" : file, hint);
  };
  for (const std::vector<double>* list :
       {&x_m, &y_m, &position_sd_m, &dx_m, &dy_m, &motion_sd_m, &turn_rad, &turn_sd_rad}) {
    if (list->size() != frames) fail("its lists differ in length", "one entry a frame in each");
  }
  const auto known = static_cast<std::size_t>(
      std::count_if(x_m.begin(), x_m.end(), [](double v) { return std::isfinite(v); }));
  if (known < kFewestCentres) {
    fail("fewer than 20 frames have a centre", "a calibration needs at least 20");
  }
  if (!(scale_sd >= 0 && scale_sd <= 0.2) || !(rate_sd >= 0 && rate_sd <= 0.2)) {
    fail("scale_sd and rate_sd must be from 0 to 0.2");
  }
  if (!(interval_s > 0)) fail("interval_s must be positive");
  if (!(metre_per_px > 0)) fail("metre_per_px must be positive", "the scale of the pictures");
  for (std::size_t i = 1; i < frames; ++i) {
    if (!(std::abs(time_s[i] - time_s[i - 1] - interval_s) <= kUnevenness * interval_s)) {
      fail("time_s is not evenly spaced by interval_s",
           "keep the entry of a frame without a ball, NaN");
    }
  }
}

void FitRequest::validate() const {
  require(!shots.empty(), "no tracks are named", "tracks");
  for (const FitShot& shot : shots) {
    if (shot.in_memory) shot.in_memory->validate();
  }
  require(!parameters.empty() || method != FitMethod::kTrajectory, "no parameters are named",
          "fit.parameters");
  require(!damping_key(impact.normal).empty() || method == FitMethod::kTrajectory,
          "this method needs a law with stiffness and damping", "fit.method",
          "trajectory fits any law");
  const bool steady = impact.normal == NormalModel::kLinearSpringDamper ||
                      impact.normal == NormalModel::kHertzDamper;
  require(steady || method != FitMethod::kPublishedGrid,
          "the grid is over damping_n_s_per_m, which this law does not have", "fit.method",
          "trajectory or restitution_duration");
  sim::fit::validate_settings(*this);
}

}  // namespace impactdic

namespace impactdic::sim::fit {

void validate_settings(const FitRequest& request) {
  require(request.flight_frames >= 8, "must be at least 8", "fit.flight_frames");
  require_positive(request.outlier_sd, "fit.outlier_sd");
  require_positive(request.grid.stiffness_max, "grid.stiffness_max");
  require_positive(request.grid.damping_max_n_s_per_m, "grid.damping_max_n_s_per_m");
  for (const auto& [key, steps] : {std::pair{"grid.stiffness_steps", request.grid.stiffness_steps},
                                   std::pair{"grid.damping_steps", request.grid.damping_steps}}) {
    require(steps >= 5 && steps <= 1000, "must be from 5 to 1000", key);
  }
  for (const auto& [key, sd] :
       {std::pair{"fit.scale_sd", request.scale_sd}, std::pair{"fit.rate_sd", request.rate_sd}}) {
    require(std::isnan(sd) || (sd >= 0 && sd <= 0.2), "must be from 0 to 0.2", key,
            "a relative standard deviation");
  }
  require(request.threads >= 0, "must not be negative", "threads");
  ImpactJob probe = request.impact;
  probe.initial.vn_m_s = -1;
  for (FitParameter p : request.parameters) {
    require(probe.shell || !is_of_shell(p), "is of a ball that is a shell", "fit.parameters",
            "give a table [shell]");
    if (law_parameter(probe, p) == 0) {
      const bool part = p == FitParameter::kPoisson || p == FitParameter::kFlatFraction;
      set_law_parameter(probe, p, part ? 0.3 : is_of_shell(p) ? 1e-3 : 1);
    }
  }
  if (request.method != FitMethod::kTrajectory) {
    probe.contact.stiffness = 1;
    probe.contact.set_damping(probe.normal, 1);
  }
  probe.contact.friction_static =
      std::max(probe.contact.friction_static, probe.contact.friction_kinetic);
  probe.validate();
}

}  // namespace impactdic::sim::fit
