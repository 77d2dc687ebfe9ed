#include "sim/fit/calibration.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"
#include "sim/fit/grid_fit.h"
#include "sim/fit/parallel.h"
#include "sim/fit/restitution_duration.h"
#include "sim/fit/trajectory_fit.h"

namespace impactdic::sim::fit {
namespace {

constexpr double kNormal95 = 1.959963984540054;

ShotFit fit_restitution_duration(const shot::Shot& shot, const FitJob& job) {
  const contact::ImpactJob impact = job_of_shot(job.impact, shot);
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
  fit.aic = fit.chi_square = fit.reduced_chi_square = fit.rms_m = kNotMeasured;
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

std::string key_of(FitParameter parameter, contact::NormalModel normal) {
  switch (parameter) {
    case FitParameter::kStiffness:
      return normal == contact::NormalModel::kHertzDamper ? "stiffness_n_per_m1p5"
                                                          : "stiffness_n_per_m";
    case FitParameter::kDamping:
      return "damping_n_s_per_m";
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
  }
  return "";
}

double law_parameter(const contact::ImpactJob& job, FitParameter parameter) {
  const contact::Contact& contact = job.contact;
  switch (parameter) {
    case FitParameter::kStiffness:
      return contact.stiffness;
    case FitParameter::kDamping:
      return contact.damping_n_s_per_m;
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

void set_law_parameter(contact::ImpactJob& job, FitParameter parameter, double value) {
  switch (parameter) {
    case FitParameter::kStiffness:
      job.contact.stiffness = value;
      break;
    case FitParameter::kDamping:
      job.contact.damping_n_s_per_m = value;
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

contact::ImpactJob job_of_shot(const contact::ImpactJob& laws, const shot::Shot& shot) {
  contact::ImpactJob job = laws;
  job.surface_angle_deg = shot.surface_angle_deg;
  job.initial = {};
  job.initial.vt_m_s = shot.before.vt_m_s.value;
  job.initial.vn_m_s = shot.before.vn_m_s.value;
  const double spin = shot.before.omega_rad_s.value;
  job.initial.omega_rad_s = std::isnan(spin) ? 0 : spin;
  // Without a coefficient Coulomb's law is no friction.
  if (job.friction == contact::FrictionModel::kCoulomb && job.contact.friction_kinetic == 0) {
    job.friction = contact::FrictionModel::kNone;
  }
  return job;
}

void time_contact(shot::Shot& shot, const contact::ImpactJob& laws) {
  if (laws.normal != contact::NormalModel::kLinearSpringDamper &&
      laws.normal != contact::NormalModel::kHertzDamper) {
    return;
  }
  const shot::Estimate crossing = shot.crossing_above_lowest_m;
  const ContactTiming timing =
      timing_from_crossing(job_of_shot(laws, shot), std::clamp(shot.restitution.value, 0.05, 0.999),
                           crossing.value, shot.contact_s.value);
  const double sd = std::abs(timing.duration_s * crossing.sd / crossing.value);
  shot::move_contact(shot, {shot.crossing_s - timing.crossing_s, sd}, {timing.duration_s, sd},
                     laws.body, laws.gravity_m_s2);
}

MeasuredShot load_shot(const FitShot& source, const contact::ImpactJob& laws, int flight_frames) {
  MeasuredShot measured{shot::read_track(source.track), {}, {}};
  double angle = source.surface_angle_deg;
  if (std::isnan(angle)) angle = measured.track.surface_angle_deg;
  if (std::isnan(angle)) {
    throw InvalidArgument("the surface's angle is not known", source.track.string(),
                          "give surface.angle_deg, or track with --surface-angle-deg");
  }
  measured.shot =
      shot::measure_shot(measured.track, {laws.body, angle, laws.gravity_m_s2, flight_frames});
  measured.timed = measured.shot;
  time_contact(measured.timed, laws);
  return measured;
}

FitResult calibrate(const FitJob& job, int threads) {
  if (job.shots.empty()) throw InvalidArgument("no tracks are named", "tracks");
  const bool spring = job.impact.normal == contact::NormalModel::kLinearSpringDamper ||
                      job.impact.normal == contact::NormalModel::kHertzDamper;
  if (!spring && job.method != FitMethod::kTrajectory) {
    throw InvalidArgument("this method needs a law with stiffness and damping", "fit.method",
                          "trajectory fits any law");
  }
  FitResult result;
  result.shots.resize(job.shots.size());
  if (job.method == FitMethod::kPublishedGrid) result.surfaces.resize(job.shots.size());
  parallel_for(job.shots.size(), threads, [&](std::size_t i) {
    const auto [track, shot, timed] = load_shot(job.shots[i], job.impact, job.flight_frames);
    switch (job.method) {
      case FitMethod::kTrajectory:
        result.shots[i] = fit_trajectory(track, timed, job);
        result.shots[i].shot = shot;
        break;
      case FitMethod::kPublishedGrid:
        result.shots[i] = fit_grid(track, timed, job, result.surfaces[i]);
        result.shots[i].shot = shot;
        break;
      case FitMethod::kRestitutionDuration:
        result.shots[i] = fit_restitution_duration(timed, job);
        break;
    }
  });
  const std::size_t laws =
      job.method == FitMethod::kTrajectory ? job.parameters.size() : std::size_t{2};
  for (std::size_t i = 0; i < laws; ++i) {
    result.pooled.push_back(pool(result, i, job.outlier_sd));
  }
  return result;
}

}  // namespace impactdic::sim::fit
