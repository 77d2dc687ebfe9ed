#include "sim/compare/comparison.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "host/base/parallel/parallel_for.h"
#include "sim/compare/compared_model.h"
#include "sim/fit/calibration.h"
#include "sim/fit/residuals/shot_model.h"
#include "sim/shot/shot_table.h"

namespace impactdic::sim::compare {
namespace {

double relative(double predicted, double measured) {
  return measured == 0 ? kNotMeasured : (predicted - measured) / std::abs(measured);
}

// The shot with the friction that it is to be run with.
ImpactJob job_for(const ImpactJob& laws, FrictionSource source, const MeasuredShot& shot) {
  ImpactJob job = fit::job_of_shot(laws, shot);
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
void compare_path(const fit::LoadedShot& measured, const ImpactJob& path_job,
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
double final_chi_square(const ModelPrediction& p, const ShotFlight& after) {
  double sum = 0, count = 0;
  for (const auto& [predicted, measured] :
       {std::pair{p.vt_m_s, after.vt_m_s}, std::pair{p.vn_m_s, after.vn_m_s},
        std::pair{p.omega_rad_s, after.omega_rad_s}}) {
    const double off = (predicted - measured.value) / measured.sd;
    if (measured.sd > 0 && !std::isnan(off)) sum += off * off, ++count;
  }
  return count > 0 ? sum : kNotMeasured;
}

ModelOutcome compare_model(const CompareRequest& job, const CompareResult& result,
                           const fit::LoadedShot& measured, const ComparedModel& model) {
  const MeasuredShot& shot = measured.timed;
  const std::size_t calibrated = result.calibration.pooled.size();
  const ImpactJob run = job_for(result.laws, job.friction_source, shot);
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

Measured average(const std::vector<double>& values) {
  Measured result{0, kNotMeasured};
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
  std::map<long, std::vector<const MeasuredShot*>> groups;
  for (const ComparedShot& s : shots) {
    groups[std::lround(10 * s.shot.surface_angle_deg)].push_back(&s.shot);
  }
  std::vector<AngleAverage> result;
  for (const auto& [tenths, members] : groups) {
    const auto over = [&, &members = members](auto value) {
      std::vector<double> values;
      for (const MeasuredShot* shot : members) {
        if (!std::isnan(value(*shot))) values.push_back(value(*shot));
      }
      return average(values);
    };
    result.push_back({static_cast<double>(tenths) / 10, static_cast<int>(members.size()),
                      over([](const MeasuredShot& s) { return s.restitution.value; }),
                      over([](const MeasuredShot& s) { return s.friction.published; }),
                      over([](const MeasuredShot& s) { return s.friction.sound; }),
                      over([](const MeasuredShot& s) { return s.friction.rolling_cap; })});
  }
  return result;
}

// The laws with the pooled values. The published calibration is the plain mean; it has no
// deviations to weigh by.
void take_calibrated(const FitResult& calibration, ImpactJob& laws) {
  if (calibration.shots.empty()) return;
  for (const PooledEstimate& pooled : calibration.pooled) {
    for (const ParameterEstimate& p : calibration.shots[0].parameters) {
      if (p.key == pooled.key) {
        fit::set_law_parameter(laws, p.parameter,
                               std::isnan(pooled.value) ? pooled.mean : pooled.value);
      }
    }
  }
}

}  // namespace

CompareResult compare_shots(const CompareRequest& request, const RunControl& control) {
  request.validate();
  CompareResult result;
  result.laws = request.calibration.impact;
  if (!request.calibration.shots.empty()) {
    FitRequest calibration = request.calibration;
    calibration.threads = request.threads;
    result.calibration = fit::calibrate(calibration, control);
    take_calibrated(result.calibration, result.laws);
    result.cancelled = result.calibration.cancelled;
    if (result.cancelled) return result;
  }
  std::vector<PrintedFigures> printed;
  if (!request.printed.empty()) printed = shot::read_printed(request.printed);
  std::vector<shot::TableShot> rows;
  for (const auto& table : request.tables) {
    for (const shot::TableShot& row :
         shot::read_shot_table(table, result.laws.body, result.laws.gravity_m_s2)) {
      rows.push_back(row);
    }
  }
  result.shots.resize(request.shots.size() + rows.size());
  const auto compare_one = [&](std::size_t i) {
    const bool tracked = i < request.shots.size();
    const fit::LoadedShot loaded =
        tracked ? fit::load_shot(request.shots[i], result.laws, request.calibration.flight_frames)
                : fit::LoadedShot{
                      {}, rows[i - request.shots.size()].shot, rows[i - request.shots.size()].shot};
    const std::string name = tracked ? loaded.shot.file : rows[i - request.shots.size()].name;
    result.shots[i].shot = loaded.shot;
    result.shots[i].initial = fit::job_of_shot(result.laws, loaded.timed).initial;
    for (const ComparedModel& model : request.models) {
      ModelOutcome outcome = compare_model(request, result, loaded, model);
      outcome.printed = shot::printed_for(printed, name, std::string(name_of(model)));
      result.shots[i].models.push_back(std::move(outcome));
    }
  };
  const std::vector<char> done =
      parallel_pieces(result.shots.size(), request.threads, "compare", control, compare_one);
  result.cancelled = keep_done(done, result.shots);
  result.angles = averages(result.shots);
  return result;
}

}  // namespace impactdic::sim::compare
