#include "sim/fit/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/base/error.h"
#include "host/base/units.h"
#include "sim/fit/parallel.h"
#include "sim/fit/shot_model.h"

namespace impactdic {
namespace {

double relative(double predicted, double measured) {
  return measured == 0 ? kNotMeasured : (predicted - measured) / std::abs(measured);
}

ImpactJob laws_of(const ImpactJob& laws, FrictionModel model, FrictionSource source,
                  const Shot& shot) {
  ImpactJob job = laws;
  job.friction = model;
  if (source != FrictionSource::kJob) {
    const double effective = source == FrictionSource::kEffectivePublished ? shot.friction.published
                                                                           : shot.friction.sound;
    job.contact.friction_kinetic = std::abs(effective);
    job.contact.friction_static =
        std::max(job.contact.friction_static, job.contact.friction_kinetic);
  }
  return job;
}

ModelOutcome predict(const MeasuredShot& measured, const ImpactJob& laws, FrictionModel model,
                     FrictionSource source, std::size_t calibrated) {
  const Shot& shot = measured.shot;
  const ImpactJob job = laws_of(laws, model, source, shot);
  const ImpactResult impact = simulate_impact(job_of_shot(job, shot));
  ModelOutcome outcome;
  outcome.model = model;
  outcome.friction_kinetic = job.contact.friction_kinetic;
  outcome.vt_m_s = impact.final.vt_m_s;
  outcome.vn_m_s = impact.final.vn_m_s;
  outcome.omega_rad_s = impact.final.omega_rad_s;
  outcome.vt_error = relative(outcome.vt_m_s, shot.after.vt_m_s.value);
  outcome.vn_error = relative(outcome.vn_m_s, shot.after.vn_m_s.value);
  outcome.omega_error = relative(outcome.omega_rad_s, shot.after.omega_rad_s.value);
  outcome.contact_s = impact.contact_s;
  outcome.t_max_compression_s = impact.t_max_compression_s;
  outcome.phases = impact.phases;
  // The track against the prediction, nothing adjusted: only the motion before and the touch, both
  // measured, go in.
  const ShotModel path(measured.track, shot, job, {}, {});
  std::vector<double> values;
  for (const Unknown& u : path.unknowns()) values.push_back(u.start);
  std::vector<double> residuals(path.residuals());
  outcome.rms_m = path.path_rms_m(values.data());
  outcome.chi_square = kNotMeasured;
  if (path.evaluate(values.data(), residuals.data(), nullptr)) {
    outcome.chi_square = 0;
    for (double r : residuals) outcome.chi_square += r * r;
  }
  outcome.aic = outcome.chi_square + 2.0 * static_cast<double>(calibrated);
  return outcome;
}

Estimate average(const std::vector<double>& values) {
  Estimate result{0, kNotMeasured};
  const auto count = static_cast<double>(values.size());
  for (double v : values) result.value += v / count;
  if (values.size() > 1) {
    double squares = 0;
    for (double v : values) squares += (v - result.value) * (v - result.value);
    result.sd = std::sqrt(squares / (count - 1));
  }
  return result;
}

std::vector<AngleAverage> averages(const std::vector<ComparedShot>& shots) {
  // Angles read from tracks differ in their last digits: tenths of a degree are one angle.
  std::map<long, std::vector<const Shot*>> groups;
  for (const ComparedShot& s : shots) {
    groups[std::lround(10 * s.shot.surface_angle_deg)].push_back(&s.shot);
  }
  std::vector<AngleAverage> result;
  for (const auto& [tenths, members] : groups) {
    const auto over = [&, &members = members](auto value) {
      std::vector<double> values;
      for (const Shot* shot : members) values.push_back(value(*shot));
      return average(values);
    };
    result.push_back({static_cast<double>(tenths) / 10, static_cast<int>(members.size()),
                      over([](const Shot& s) { return s.restitution.value; }),
                      over([](const Shot& s) { return s.friction.published; }),
                      over([](const Shot& s) { return s.friction.sound; }),
                      over([](const Shot& s) { return s.friction.rolling_cap; })});
  }
  return result;
}

}  // namespace

CompareResult compare(const CompareJob& job, int threads) {
  if (job.shots.empty()) throw InvalidArgument("no tracks are named", "tracks");
  if (job.models.empty()) throw InvalidArgument("no models are named", "models");
  CompareResult result;
  result.laws = job.calibration.impact;
  if (!job.calibration.shots.empty()) {
    result.calibration = calibrate(job.calibration, threads);
    for (const PooledEstimate& pooled : result.calibration.pooled) {
      for (const ParameterEstimate& p : result.calibration.shots[0].parameters) {
        // The published calibration is the plain mean; it has no deviations to weigh by.
        if (p.key == pooled.key) {
          set_law_parameter(result.laws, p.parameter,
                            std::isnan(pooled.value) ? pooled.mean : pooled.value);
        }
      }
    }
  }
  result.shots.resize(job.shots.size());
  parallel_for(job.shots.size(), threads, [&](std::size_t i) {
    const MeasuredShot measured =
        load_shot(job.shots[i], result.laws, job.calibration.flight_frames);
    result.shots[i].shot = measured.shot;
    for (FrictionModel model : job.models) {
      result.shots[i].models.push_back(predict(measured, result.laws, model, job.friction_source,
                                               result.calibration.pooled.size()));
    }
  });
  result.angles = averages(result.shots);
  return result;
}

}  // namespace impactdic
