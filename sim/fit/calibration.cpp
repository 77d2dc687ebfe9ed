#include "sim/fit/calibration.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "sim/fit/grid_fit.h"
#include "sim/fit/pooling.h"
#include "sim/fit/restitution_duration.h"
#include "sim/fit/rivals.h"
#include "sim/fit/trajectory_fit.h"
#include "sim/shot/track_accuracy.h"

namespace impactdic::sim::fit {
namespace {

constexpr double kStep = 1e-4;  // relative, of differences

ShotFit fit_restitution_duration(const MeasuredTrack& track, const MeasuredShot& shot,
                                 const FitRequest& job) {
  const ImpactJob impact = job_of_shot(job.impact, shot);
  const double e = shot.restitution.value;
  const double duration = shot.contact_s.value;
  const contact::SpringDamperParameters pair = spring_and_damper(impact, e, duration);
  // Carried over by differences: both figures have their own deviation.
  const double e_step = 1e-4 * e, t_step = 1e-4 * duration;
  const contact::SpringDamperParameters other_e = spring_and_damper(impact, e - e_step, duration);
  const contact::SpringDamperParameters other_t = spring_and_damper(impact, e, duration + t_step);
  const double k_e = (pair.stiffness - other_e.stiffness) / e_step * shot.restitution.sd;
  const double k_t = (other_t.stiffness - pair.stiffness) / t_step * shot.contact_s.sd;
  const double b_e =
      (pair.damping_n_s_per_m - other_e.damping_n_s_per_m) / e_step * shot.restitution.sd;
  const double b_t =
      (other_t.damping_n_s_per_m - pair.damping_n_s_per_m) / t_step * shot.contact_s.sd;
  // The restitution is a ratio; scale and rate change velocities, and the rate durations.
  const auto slope = [&](double length, double time) {
    ImpactJob other = impact;
    other.initial.vt_m_s *= length / time;
    other.initial.vn_m_s *= length / time;
    other.initial.omega_rad_s /= time;
    const contact::SpringDamperParameters moved = spring_and_damper(other, e, duration * time);
    return std::pair{(moved.stiffness - pair.stiffness) / kStep,
                     (moved.damping_n_s_per_m - pair.damping_n_s_per_m) / kStep};
  };
  const auto [k_scale, b_scale] = slope(1 + kStep, 1);
  const auto [k_rate, b_rate] = slope(1, 1 + kStep);
  const double s = track.scale_sd, r = track.rate_sd;
  ShotFit fit;
  fit.shot = shot;
  const auto add = [&](FitParameter p, double value, double sd, double scale, double rate) {
    sd = std::hypot(sd, scale, rate);
    ParameterEstimate estimate{p,
                               key_of(p, job.impact.normal),
                               value,
                               sd,
                               value - kNormal95 * sd,
                               value + kNormal95 * sd,
                               true,
                               false,
                               "determined by the data"};
    estimate.scale_part = scale, estimate.rate_part = rate;
    fit.parameters.push_back(std::move(estimate));
  };
  add(FitParameter::kStiffness, pair.stiffness, std::hypot(k_e, k_t), s * k_scale, r * k_rate);
  add(FitParameter::kDamping, pair.damping_n_s_per_m, std::hypot(b_e, b_t), s * b_scale,
      r * b_rate);
  const double both = k_e * b_e + k_t * b_t + s * s * k_scale * b_scale + r * r * k_rate * b_rate;
  fit.covariance = {std::pow(fit.parameters[0].sd, 2), both, both,
                    std::pow(fit.parameters[1].sd, 2)};
  fit.measurements = fit.free_parameters = 2;
  fit.aic = fit.chi_square = fit.reduced_chi_square = fit.rms_m = fit.p_value = kNotMeasured;
  return fit;
}

}  // namespace

double law_parameter(const ImpactJob& job, FitParameter parameter) {
  const ContactParameters& contact = job.contact;
  switch (parameter) {
    case FitParameter::kStiffness:
      return contact.stiffness;
    case FitParameter::kDamping:
      return contact.damping(job.normal);
    case FitParameter::kFrictionKinetic:
      return contact.friction_kinetic;
    case FitParameter::kFrictionStatic:
      return contact.friction_static;
    case FitParameter::kPoisson:
      return contact.poisson;
    case FitParameter::kYieldStrength:
      return contact.yield_strength_pa;
    case FitParameter::kDrag:
      return job.air.drag_coefficient;
    case FitParameter::kLift:
      return job.air.lift_coefficient;
    case FitParameter::kShellStiffness:
      return job.shell ? job.shell->stiffness_n_per_m : kNotMeasured;
    case FitParameter::kShellDamping:
      return job.shell ? job.shell->damping_n_s_per_m : kNotMeasured;
    case FitParameter::kFlatFraction:
      return job.shell ? job.shell->flat_fraction : kNotMeasured;
    default:
      return kNotMeasured;
  }
}

void set_law_parameter(ImpactJob& job, FitParameter parameter, double value) {
  switch (parameter) {
    case FitParameter::kStiffness:
      job.contact.stiffness = value;
      break;
    case FitParameter::kDamping:
      job.contact.set_damping(job.normal, value);
      break;
    case FitParameter::kFrictionKinetic:
      job.contact.friction_kinetic = value;
      break;
    case FitParameter::kFrictionStatic:
      job.contact.friction_static = value;
      break;
    case FitParameter::kPoisson:
      job.contact.poisson = value;
      break;
    case FitParameter::kYieldStrength:
      job.contact.yield_strength_pa = value;
      break;
    case FitParameter::kDrag:
      job.air.drag_coefficient = value;
      break;
    case FitParameter::kLift:
      job.air.lift_coefficient = value;
      break;
    case FitParameter::kShellStiffness:
      job.shell->stiffness_n_per_m = value;
      break;
    case FitParameter::kShellDamping:
      job.shell->damping_n_s_per_m = value;
      break;
    case FitParameter::kFlatFraction:
      job.shell->flat_fraction = value;
      break;
    default:
      break;
  }
}

bool is_of_shell(FitParameter p) {
  return p == FitParameter::kShellStiffness || p == FitParameter::kShellDamping ||
         p == FitParameter::kFlatFraction;
}

ImpactJob one_spring(ImpactJob laws) {
  laws.shell.reset();
  return laws;
}

ImpactJob job_of_shot(const ImpactJob& laws, const MeasuredShot& shot) {
  ImpactJob job = laws;
  job.surface_angle_deg = shot.surface_angle_deg;
  job.initial = {};
  job.initial.vt_m_s = shot.before.vt_m_s.value;
  job.initial.vn_m_s = shot.before.vn_m_s.value;
  const double spin = shot.before.omega_rad_s.value;
  job.initial.omega_rad_s = std::isnan(spin) ? 0 : spin;
  // Without a coefficient Coulomb's law is no friction.
  if (job.friction == FrictionModel::kCoulomb && job.contact.friction_kinetic == 0) {
    job.friction = FrictionModel::kNone;
  }
  return job;
}

void time_contact(MeasuredShot& shot, const ImpactJob& laws) {
  if (damping_key(laws.normal).empty()) return;
  const Measured crossing = shot.crossing_above_lowest_m;
  const ContactTiming timing = timing_from_crossing(job_of_shot(one_spring(laws), shot),
                                                    std::clamp(shot.restitution.value, 0.05, 0.999),
                                                    crossing.value, shot.contact_s.value);
  const double sd = std::abs(timing.duration_s * crossing.sd / crossing.value);
  shot::move_contact(shot, {shot.crossing_s - timing.crossing_s, sd}, {timing.duration_s, sd},
                     laws.body, laws.gravity_m_s2);
}

LoadedShot load_shot(const FitShot& source, const ImpactJob& laws, int flight_frames) {
  LoadedShot loaded{source.in_memory ? *source.in_memory : shot::read_track(source.track), {}, {}};
  if (!source.in_memory) shot::read_accuracy(source.track, loaded.track);
  double angle = source.surface_angle_deg;
  if (std::isnan(angle)) angle = loaded.track.surface_angle_deg;
  if (std::isnan(angle)) {
    throw InvalidArgument("the surface's angle is not known",
                          source.in_memory ? loaded.track.file : source.track.string(),
                          "give surface.angle_deg, or track with --surface-angle-deg");
  }
  loaded.shot =
      shot::measure_shot(loaded.track, {laws.body, angle, laws.gravity_m_s2, flight_frames});
  loaded.timed = loaded.shot;
  time_contact(loaded.timed, laws);
  return loaded;
}

FitResult calibrate(const FitRequest& request, const RunControl& control) {
  request.validate();
  FitResult result;
  result.shots.resize(request.shots.size());
  if (request.method == FitMethod::kPublishedGrid) result.surfaces.resize(request.shots.size());
  const std::vector<char> done =
      parallel_pieces(request.shots.size(), request.threads, "fit", control, [&](std::size_t i) {
        auto [track, shot, timed] =
            load_shot(request.shots[i], request.impact, request.flight_frames);
        if (!std::isnan(request.scale_sd)) track.scale_sd = request.scale_sd;
        if (!std::isnan(request.rate_sd)) track.rate_sd = request.rate_sd;
        switch (request.method) {
          case FitMethod::kTrajectory:
            result.shots[i] = fit_trajectory(track, timed, request);
            if (request.rivals) rank_rivals(result.shots[i], track, timed, request);
            result.shots[i].shot = shot;
            break;
          case FitMethod::kPublishedGrid:
            result.shots[i] = fit_grid(track, timed, request, result.surfaces[i]);
            result.shots[i].shot = shot;
            break;
          case FitMethod::kRestitutionDuration:
            result.shots[i] = fit_restitution_duration(track, timed, request);
            break;
        }
      });
  result.cancelled = keep_done(done, result.shots);
  if (!result.surfaces.empty()) keep_done(done, result.surfaces);
  if (result.shots.empty()) return result;
  const std::size_t laws =
      request.method == FitMethod::kTrajectory ? request.parameters.size() : std::size_t{2};
  for (std::size_t i = 0; i < laws; ++i) {
    result.pooled.push_back(pool(result.shots, i, request.outlier_sd));
  }
  return result;
}

}  // namespace impactdic::sim::fit
