#include "sim/fit/calibration.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/parallel.h"
#include "host/base/statistics.h"
#include "sim/fit/grid_fit.h"
#include "sim/fit/restitution_duration.h"
#include "sim/fit/rivals.h"
#include "sim/fit/trajectory_fit.h"

namespace impactdic::sim::fit {
namespace {

constexpr double kNormal95 = 1.959963984540054;

ShotFit fit_restitution_duration(const MeasuredShot& shot, const FitRequest& job) {
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
  ShotFit fit;
  fit.shot = shot;
  const auto add = [&](FitParameter p, double value, double sd) {
    fit.parameters.push_back({p, key_of(p, job.impact.normal), value, sd, value - kNormal95 * sd,
                              value + kNormal95 * sd, true, false, "determined by the data"});
  };
  add(FitParameter::kStiffness, pair.stiffness, std::hypot(k_e, k_t));
  add(FitParameter::kDamping, pair.damping_n_s_per_m, std::hypot(b_e, b_t));
  fit.covariance = {k_e * k_e + k_t * k_t, k_e * b_e + k_t * b_t, k_e * b_e + k_t * b_t,
                    b_e * b_e + b_t * b_t};
  fit.measurements = fit.free_parameters = 2;
  fit.aic = fit.chi_square = fit.reduced_chi_square = fit.rms_m = fit.p_value = kNotMeasured;
  return fit;
}

PooledEstimate pool(const FitResult& result, std::size_t index, double outlier_sd) {
  PooledEstimate pooled;
  pooled.key = result.shots[0].parameters[index].key;
  std::vector<double> values;
  double weights = 0, weighted = 0;
  for (const ShotFit& shot : result.shots) {
    const ParameterEstimate& p = shot.parameters[index];
    values.push_back(p.value);
    if (p.determined && p.sd > 0) weights += 1 / (p.sd * p.sd), weighted += p.value / (p.sd * p.sd);
  }
  const auto count = static_cast<double>(values.size());
  for (double v : values) pooled.mean += v / count;
  for (double v : values) pooled.scatter_sd += (v - pooled.mean) * (v - pooled.mean);
  pooled.scatter_sd = count > 1 ? std::sqrt(pooled.scatter_sd / (count - 1)) : kNotMeasured;
  pooled.value = weights > 0 ? weighted / weights : kNotMeasured;
  pooled.sd = weights > 0 ? std::sqrt(1 / weights) : kNotMeasured;
  double compared = 0;
  for (const ShotFit& shot : result.shots) {
    const ParameterEstimate& p = shot.parameters[index];
    if (!(p.determined && p.sd > 0)) continue;
    pooled.chi_square += std::pow((p.value - pooled.value) / p.sd, 2);
    ++compared;
  }
  // Shots that scatter more than their own deviations widen the pooled one (Birge 1932).
  if (compared > 1) pooled.sd *= std::sqrt(std::max(1.0, pooled.chi_square / (compared - 1)));
  pooled.determined = compared > 0 || std::all_of(result.shots.begin(), result.shots.end(),
                                                  [&](const ShotFit& shot) {
                                                    return shot.parameters[index].determined;
                                                  });
  const double middle = median(values);
  std::vector<double> off;
  for (double v : values) off.push_back(std::abs(v - middle));
  const double spread = kSdOfMad * median(off);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double own = result.shots[i].parameters[index].sd;
    const double allowed = std::hypot(spread, std::isnan(own) ? 0 : own);
    if (values.size() >= 4 && off[i] > outlier_sd * allowed) {
      pooled.outliers.push_back(result.shots[i].shot.file);
    }
  }
  return pooled;
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
    default:
      break;
  }
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
  const ContactTiming timing =
      timing_from_crossing(job_of_shot(laws, shot), std::clamp(shot.restitution.value, 0.05, 0.999),
                           crossing.value, shot.contact_s.value);
  const double sd = std::abs(timing.duration_s * crossing.sd / crossing.value);
  shot::move_contact(shot, {shot.crossing_s - timing.crossing_s, sd}, {timing.duration_s, sd},
                     laws.body, laws.gravity_m_s2);
}

LoadedShot load_shot(const FitShot& source, const ImpactJob& laws, int flight_frames) {
  LoadedShot loaded{source.in_memory ? *source.in_memory : shot::read_track(source.track), {}, {}};
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
        const auto [track, shot, timed] =
            load_shot(request.shots[i], request.impact, request.flight_frames);
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
            result.shots[i] = fit_restitution_duration(timed, request);
            break;
        }
      });
  result.cancelled = keep_done(done, result.shots);
  if (!result.surfaces.empty()) keep_done(done, result.surfaces);
  if (result.shots.empty()) return result;
  const std::size_t laws =
      request.method == FitMethod::kTrajectory ? request.parameters.size() : std::size_t{2};
  for (std::size_t i = 0; i < laws; ++i) {
    result.pooled.push_back(pool(result, i, request.outlier_sd));
  }
  return result;
}

}  // namespace impactdic::sim::fit
