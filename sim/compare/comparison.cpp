#include "sim/compare/comparison.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/fit/parallel.h"
#include "sim/fit/shot_model.h"

namespace impactdic::sim::compare {
namespace {

double relative(double predicted, double measured) {
  return measured == 0 ? kNotMeasured : (predicted - measured) / std::abs(measured);
}

// The shot with the friction that it is to be run with.
contact::ImpactJob job_for(const contact::ImpactJob& laws, FrictionSource source,
                           const shot::Shot& shot) {
  contact::ImpactJob job = fit::job_of_shot(laws, shot);
  job.friction = laws.friction;
  if (source == FrictionSource::kJob) return job;
  const double effective =
      source == FrictionSource::kEffectivePublished ? shot.friction.published : shot.friction.sound;
  if (std::isnan(effective)) {
    throw InvalidArgument("the shot's effective friction is not known", shot.file,
                          "it needs the velocities after, and effective_sound the contact_s");
  }
  job.contact.friction_kinetic = std::abs(effective);
  job.contact.friction_static = std::max(job.contact.friction_static, std::abs(effective));
  return job;
}

// The track against the prediction, nothing adjusted: only the motion before and the touch, both
// measured, go in.
void compare_path(const fit::MeasuredShot& measured, const contact::ImpactJob& path_job,
                  std::size_t calibrated, ModelOutcome& outcome) {
  const fit::ShotModel path(measured.track, measured.timed, path_job, {}, {});
  std::vector<double> values;
  for (const fit::Unknown& u : path.unknowns()) values.push_back(u.start);
  std::vector<double> residuals(path.residuals());
  outcome.rms_m = path.path_rms_m(values.data());
  if (!path.evaluate(values.data(), residuals.data(), nullptr)) return;
  outcome.chi_square = 0;
  for (double r : residuals) outcome.chi_square += r * r;
  outcome.aic = outcome.chi_square + 2.0 * static_cast<double>(calibrated);
}

// Over those velocities after the impact whose deviation is known.
double final_chi_square(const ModelPrediction& p, const shot::Flight& after) {
  double sum = 0, count = 0;
  for (const auto& [predicted, measured] :
       {std::pair{p.vt_m_s, after.vt_m_s}, std::pair{p.vn_m_s, after.vn_m_s},
        std::pair{p.omega_rad_s, after.omega_rad_s}}) {
    const double off = (predicted - measured.value) / measured.sd;
    if (measured.sd > 0 && !std::isnan(off)) sum += off * off, ++count;
  }
  return count > 0 ? sum : kNotMeasured;
}

ModelOutcome compare_model(const CompareJob& job, const CompareResult& result,
                           const fit::MeasuredShot& measured, const ComparedModel& model) {
  const shot::Shot& shot = measured.timed;
  const std::size_t calibrated = result.calibration.pooled.size();
  const contact::ImpactJob run = job_for(result.laws, job.friction_source, shot);
  ModelOutcome outcome;
  outcome.model = model;
  outcome.friction_kinetic = run.contact.friction_kinetic;
  outcome.prediction = predict_shot(model, run, job.formula);
  const ModelPrediction& p = outcome.prediction;
  outcome.vt_error = relative(p.vt_m_s, shot.after.vt_m_s.value);
  outcome.vn_error = relative(p.vn_m_s, shot.after.vn_m_s.value);
  outcome.omega_error = relative(p.omega_rad_s, shot.after.omega_rad_s.value);
  outcome.final_chi_square = final_chi_square(p, shot.after);
  outcome.final_aic = outcome.final_chi_square + 2.0 * static_cast<double>(calibrated);
  outcome.rms_m = outcome.chi_square = outcome.aic = kNotMeasured;
  if (p.path && !measured.track.time_s.empty()) {
    compare_path(measured, *p.path, calibrated, outcome);
  }
  return outcome;
}

shot::Estimate average(const std::vector<double>& values) {
  shot::Estimate result{0, kNotMeasured};
  const auto count = static_cast<double>(values.size());
  if (values.empty()) result.value = kNotMeasured;
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
  std::map<long, std::vector<const shot::Shot*>> groups;
  for (const ComparedShot& s : shots) {
    groups[std::lround(10 * s.shot.surface_angle_deg)].push_back(&s.shot);
  }
  std::vector<AngleAverage> result;
  for (const auto& [tenths, members] : groups) {
    const auto over = [&, &members = members](auto value) {
      std::vector<double> values;
      for (const shot::Shot* shot : members) {
        if (!std::isnan(value(*shot))) values.push_back(value(*shot));
      }
      return average(values);
    };
    result.push_back({static_cast<double>(tenths) / 10, static_cast<int>(members.size()),
                      over([](const shot::Shot& s) { return s.restitution.value; }),
                      over([](const shot::Shot& s) { return s.friction.published; }),
                      over([](const shot::Shot& s) { return s.friction.sound; }),
                      over([](const shot::Shot& s) { return s.friction.rolling_cap; })});
  }
  return result;
}

}  // namespace

CompareResult compare(const CompareJob& job, int threads) {
  if (job.shots.empty() && job.tables.empty()) {
    throw InvalidArgument("no tracks are named", "tracks");
  }
  if (job.models.empty()) throw InvalidArgument("no models are named", "models");
  CompareResult result;
  result.laws = job.calibration.impact;
  if (!job.calibration.shots.empty()) {
    result.calibration = fit::calibrate(job.calibration, threads);
    for (const fit::PooledEstimate& pooled : result.calibration.pooled) {
      for (const fit::ParameterEstimate& p : result.calibration.shots[0].parameters) {
        // The published calibration is the plain mean; it has no deviations to weigh by.
        if (p.key == pooled.key) {
          fit::set_law_parameter(result.laws, p.parameter,
                                 std::isnan(pooled.value) ? pooled.mean : pooled.value);
        }
      }
    }
  }
  std::vector<shot::PrintedRow> printed;
  if (!job.printed.empty()) printed = shot::read_printed(job.printed);
  std::vector<shot::TableShot> rows;
  for (const auto& table : job.tables) {
    for (const shot::TableShot& row :
         shot::read_shot_table(table, result.laws.body, result.laws.gravity_m_s2)) {
      rows.push_back(row);
    }
  }
  result.shots.resize(job.shots.size() + rows.size());
  fit::parallel_for(result.shots.size(), threads, [&](std::size_t i) {
    const bool tracked = i < job.shots.size();
    const fit::MeasuredShot measured =
        tracked ? fit::load_shot(job.shots[i], result.laws, job.calibration.flight_frames)
                : fit::MeasuredShot{
                      {}, rows[i - job.shots.size()].shot, rows[i - job.shots.size()].shot};
    const std::string name = tracked ? measured.shot.file : rows[i - job.shots.size()].name;
    result.shots[i].shot = measured.shot;
    for (const ComparedModel& model : job.models) {
      ModelOutcome outcome = compare_model(job, result, measured, model);
      outcome.printed = shot::printed_for(printed, name, std::string(name_of(model)));
      result.shots[i].models.push_back(std::move(outcome));
    }
  });
  result.angles = averages(result.shots);
  return result;
}

}  // namespace impactdic::sim::compare
