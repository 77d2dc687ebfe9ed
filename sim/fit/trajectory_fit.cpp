#include "sim/fit/trajectory_fit.h"

#include <ceres/ceres.h>
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdio>
#include <limits>

#include "host/base/statistics.h"
#include "sim/fit/covariance/fit_covariance.h"
#include "sim/fit/derived_figures.h"
#include "sim/fit/residuals/residual_weights.h"
#include "sim/fit/residuals/shot_model.h"
#include "sim/fit/restitution_duration.h"
#include "sim/fit/verdict.h"

namespace impactdic::sim::fit {
namespace {

constexpr double kChiSquare95 = 3.841458820694124;  // one degree of freedom
// An interval wider than this part of its value is not parabolic any more: profile it.
constexpr double kWeak = 0.2;
// Of two springs in series an interval of this part of its value tells them apart.
constexpr double kSplit = 0.5;
constexpr int kWeighings = 2;
// A fit whose chi square is exceeded by chance less often is inadequate.
constexpr double kLeastPValue = 0.01;
constexpr std::array<double, 2> kFrictionStarts{0.15, 0.6};
constexpr double kFirstMotionFactor = 30;

class Cost final : public ceres::CostFunction {
 public:
  // `fixed`: an unknown held at its value (its column is zero), or none if >= size.
  Cost(const ShotModel& model, std::size_t fixed) : model_(model), fixed_(fixed) {
    set_num_residuals(static_cast<int>(model.residuals()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(model.size()));
  }
  bool Evaluate(const double* const* values, double* residuals, double** jacobians) const override {
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    if (!model_.evaluate(values[0], residuals, jacobian)) return false;
    if (jacobian != nullptr && fixed_ < model_.size()) {
      for (std::size_t r = 0; r < model_.residuals(); ++r) {
        jacobian[r * model_.size() + fixed_] = 0;
      }
    }
    return true;
  }

 private:
  const ShotModel& model_;
  std::size_t fixed_;
};

bool is_friction(const Unknown& unknown) {
  return unknown.kind == Unknown::Kind::kParameter &&
         (unknown.parameter == FitParameter::kFrictionKinetic ||
          unknown.parameter == FitParameter::kFrictionStatic);
}

struct Solution {
  std::vector<double> values;
  double chi_square = std::numeric_limits<double>::infinity();
  bool converged = false;
};

Solution solve(const ShotModel& model, std::vector<double> start, std::size_t fixed) {
  Solution solution{std::move(start)};
  ceres::Problem::Options problem_options;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(new Cost(model, fixed), nullptr, solution.values.data());
  for (std::size_t i = 0; i < model.size(); ++i) {
    const Unknown& u = model.unknowns()[i];
    const int index = static_cast<int>(i);
    if (std::isfinite(u.lower)) {
      problem.SetParameterLowerBound(solution.values.data(), index, u.lower);
    }
    if (std::isfinite(u.upper)) {
      problem.SetParameterUpperBound(solution.values.data(), index, u.upper);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-11;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type == ceres::FAILURE) return solution;
  solution.chi_square = 2 * summary.final_cost;
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

std::vector<double> start_values(const ShotModel& model) {
  std::vector<double> values;
  for (const Unknown& u : model.unknowns()) {
    values.push_back(std::clamp(u.start, u.lower, u.upper));
  }
  return values;
}

// The shell's spring lies in series with the surface's: half of the way each, or what is left of
// it. (Of a Hertz contact the numbers only have the right size.)
void share_stiffness(ImpactJob& laws, double both, const FitRequest& job) {
  const auto fits = [&](FitParameter p) {
    return std::find(job.parameters.begin(), job.parameters.end(), p) != job.parameters.end();
  };
  const auto rest = [both](double other) {
    return other > both ? 1 / (1 / both - 1 / other) : 4 * both;
  };
  if (fits(FitParameter::kStiffness) && fits(FitParameter::kShellStiffness)) {
    laws.contact.stiffness = laws.shell->stiffness_n_per_m = 2 * both;
  } else if (fits(FitParameter::kStiffness) && laws.normal == NormalModel::kLinearSpringDamper) {
    laws.contact.stiffness = rest(laws.shell->stiffness_n_per_m);
  } else if (fits(FitParameter::kShellStiffness)) {
    laws.shell->stiffness_n_per_m = rest(laws.contact.stiffness);
  }
}

// The laws at the start: stiffness and damping from (e, T), friction from the impulses.
ImpactJob laws_at_start(const MeasuredShot& shot, const FitRequest& job) {
  ImpactJob laws = job.impact;
  const auto fits = [&](FitParameter p) {
    return std::find(job.parameters.begin(), job.parameters.end(), p) != job.parameters.end();
  };
  if (fits(FitParameter::kStiffness) || fits(FitParameter::kDamping) ||
      fits(FitParameter::kShellStiffness)) {
    const double e = std::clamp(shot.restitution.value, 0.05, 0.999);
    const contact::SpringDamperParameters pair =
        spring_and_damper(job_of_shot(one_spring(laws), shot), e, shot.contact_s.value);
    if (fits(FitParameter::kStiffness)) laws.contact.stiffness = pair.stiffness;
    if (laws.shell) share_stiffness(laws, pair.stiffness, job);
    if (fits(FitParameter::kDamping)) laws.contact.set_damping(laws.normal, pair.damping_n_s_per_m);
  }
  if (fits(FitParameter::kFrictionKinetic) && laws.contact.friction_kinetic == 0) {
    laws.contact.friction_kinetic = std::clamp(std::abs(shot.friction.sound), 1e-3, 2.0);
    laws.contact.friction_static =
        std::max(laws.contact.friction_static, laws.contact.friction_kinetic);
  }
  return laws;
}

// Where the chi square, minimised over all the others, has risen by the 95 % quantile. NaN where it
// does not rise that far before the bound or 64 steps of one deviation.
double profile_end(const ShotModel& model, const Solution& best, std::size_t index, double step,
                   double rise) {
  const Unknown& unknown = model.unknowns()[index];
  const double centre = best.values[index];
  double inside = centre, outside = kNotMeasured;
  std::vector<double> values = best.values;
  const auto excess = [&](double at) {
    std::vector<double> start = values;
    start[index] = at;
    const Solution solution = solve(model, start, index);
    if (!std::isfinite(solution.chi_square)) return std::numeric_limits<double>::infinity();
    values = solution.values;
    return solution.chi_square - best.chi_square - rise;
  };
  for (int i = 0; i < 7 && std::isnan(outside); ++i, step *= 2) {
    const double at = std::clamp(centre + step, unknown.lower, unknown.upper);
    if (excess(at) > 0) {
      outside = at;
    } else {
      inside = at;
      if (at == unknown.lower || at == unknown.upper) return kNotMeasured;
    }
  }
  if (std::isnan(outside)) return kNotMeasured;
  for (int i = 0; i < 12; ++i) {
    const double middle = (inside + outside) / 2;
    (excess(middle) > 0 ? outside : inside) = middle;
  }
  return (inside + outside) / 2;
}

ParameterEstimate estimate(const ShotModel& model, const Solution& best, std::size_t index,
                           double sd, double inflation, bool flat_above, const FitRequest& job) {
  const Unknown& unknown = model.unknowns()[index];
  ParameterEstimate p;
  p.parameter = unknown.parameter;
  p.key = key_of(unknown.parameter, job.impact.normal);
  p.value = best.values[index];
  p.sd = std::isfinite(sd) ? sd : kNotMeasured;
  p.ci95_low = p.value - kNormal95 * p.sd;
  p.ci95_high = p.value + kNormal95 * p.sd;
  const bool positive = unknown.lower >= 0;  // a quantity whose size is its meaning
  const bool weak =
      std::isnan(p.sd) || flat_above || (positive && kNormal95 * p.sd > kWeak * std::abs(p.value));
  const bool in_series = job.impact.shell && (p.parameter == FitParameter::kStiffness ||
                                              p.parameter == FitParameter::kShellStiffness);
  if (weak && in_series) {
    // The other spring takes over whatever this one loses: beyond this neither is told.
    if (!(kNormal95 * p.sd < kSplit * p.value)) p.ci95_low = p.ci95_high = kNotMeasured;
  } else if (weak) {
    p.profiled = true;
    const double step = std::isnan(p.sd) ? std::max(std::abs(p.value), unknown.step) / 8
                                         : std::max(p.sd, unknown.step);
    const double rise = kChiSquare95 * inflation;
    p.ci95_low = profile_end(model, best, index, -step, rise);
    p.ci95_high = profile_end(model, best, index, step, rise);
    if (flat_above) p.ci95_high = kNotMeasured;
  }
  p.determined = !std::isnan(p.ci95_low) && !std::isnan(p.ci95_high);
  return p;
}

struct Weighed {
  Solution best;
  DeviationFactors factors{};
  double stated_chi_square = 0;
  std::vector<bool> flat_above;  // of each unknown: much larger values fit as well
};

// Solves, sees from the residuals how far the stated deviations reach, and solves again with these.
// Centres are absolute, whereas motions are differences whose bias adds up over a flight and can
// pass for another stiffness: the first path is the centres', and the motions are judged by it.
Weighed solve_and_weigh(ShotModel& model) {
  Weighed result;
  result.factors = {1, kFirstMotionFactor, 1};
  model.weigh(result.factors);
  result.best = solve(model, start_values(model), model.size());
  std::vector<double> residuals(model.residuals());
  const auto look = [&] {
    model.weigh({1, 1, 1});
    model.evaluate(result.best.values.data(), residuals.data(), nullptr);
  };
  for (int i = 0; i < kWeighings && std::isfinite(result.best.chi_square); ++i) {
    look();
    result.factors = deviation_factors(model, residuals);
    model.weigh(result.factors, residuals);
    result.best = solve(model, result.best.values, model.size());
  }
  if (!std::isfinite(result.best.chi_square)) return result;
  const std::vector<double> weighed_by = residuals;
  look();
  for (double r : residuals) result.stated_chi_square += r * r;
  model.weigh(result.factors, weighed_by);
  return result;
}

// Friction that rolls the ball from the start leaves a chi square that is flat above a kink, below
// which another minimum may lie. Starts far away leave it; and where they end far away and fit as
// well, the friction is not determined upwards.
void leave_local_minimum(const ShotModel& model, Weighed& weighed) {
  Solution& best = weighed.best;
  std::vector<Solution> others;
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!is_friction(model.unknowns()[i])) continue;
    for (const double start : kFrictionStarts) {
      std::vector<double> values = best.values;
      values[i] = start;
      others.push_back(solve(model, values, i));  // held there, so that no step leaves the plateau
      if (others.back().chi_square > best.chi_square - 1e-6) continue;
      best = solve(model, others.back().values, model.size());
    }
  }
  const double left = static_cast<double>(model.residuals() - model.size());
  const double rise = kChiSquare95 * std::max(1.0, best.chi_square / left);
  weighed.flat_above.assign(model.size(), false);
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!is_friction(model.unknowns()[i])) continue;
    for (const Solution& other : others) {
      if (other.chi_square - best.chi_square < rise && other.values[i] > 2 * best.values[i]) {
        weighed.flat_above[i] = true;
      }
    }
  }
}

ShotFit goodness(const ShotModel& model, const MeasuredShot& shot, const Weighed& weighed) {
  const auto& [best, factors, stated_chi_square, flat_above] = weighed;
  ShotFit fit;
  fit.shot = shot;
  fit.chi_square = stated_chi_square;
  fit.deviation_factors = {factors.begin(), factors.end()};
  fit.measurements = static_cast<long>(model.residuals());
  fit.free_parameters = static_cast<long>(model.size());
  fit.reduced_chi_square =
      stated_chi_square / static_cast<double>(fit.measurements - fit.free_parameters);
  fit.aic = stated_chi_square + 2.0 * static_cast<double>(fit.free_parameters);
  fit.rms_m = model.path_rms_m(best.values.data());
  fit.converged = best.converged;
  if (!best.converged) fit.warnings.push_back("the fit had not converged after 100 iterations");
  const double left = static_cast<double>(fit.measurements - fit.free_parameters);
  fit.p_value = boost::math::gamma_q(left / 2, stated_chi_square / 2);
  fit.adequacy = fit.p_value < kLeastPValue ? Adequacy::kInadequate : Adequacy::kAdequate;
  if (fit.adequacy == Adequacy::kInadequate) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "inadequate: the model leaves %.3g times the chi square that the stated deviations "
        "explain (p %.1e); the law is wrong, or the deviations are too small",
        fit.reduced_chi_square, fit.p_value);
    fit.warnings.emplace_back(text);
  }
  return fit;
}

Weighed solve_shot(ShotModel& model, const MeasuredShot& shot) {
  Weighed weighed = solve_and_weigh(model);
  if (!std::isfinite(weighed.best.chi_square)) {
    throw InvalidArgument("the model has no impact at its start values", shot.file,
                          "are mass, diameter and the fixed contact values right?");
  }
  leave_local_minimum(model, weighed);
  return weighed;
}

}  // namespace

ShotFit fit_values(const MeasuredTrack& track, const MeasuredShot& shot, const FitRequest& job) {
  ShotModel model(track, shot, laws_at_start(shot, job), job.parameters, job.unknowns);
  const Weighed weighed = solve_shot(model, shot);
  ShotFit fit = goodness(model, shot, weighed);
  for (std::size_t i = 0; i < job.parameters.size(); ++i) {
    ParameterEstimate p;
    p.parameter = job.parameters[i];
    p.key = key_of(p.parameter, job.impact.normal);
    p.value = weighed.best.values[i];
    p.sd = p.ci95_low = p.ci95_high = kNotMeasured;
    fit.parameters.push_back(std::move(p));
  }
  return fit;
}

ShotFit fit_trajectory(const MeasuredTrack& track, const MeasuredShot& shot,
                       const FitRequest& job) {
  ShotModel model(track, shot, laws_at_start(shot, job), job.parameters, job.unknowns);
  const Weighed weighed = solve_shot(model, shot);
  const Solution& best = weighed.best;
  ShotFit fit = goodness(model, shot, weighed);
  const double inflation =
      std::max(1.0, best.chi_square / static_cast<double>(fit.measurements - fit.free_parameters));
  const Eigen::MatrixXd unit = cofactor(model, best.values);
  const Eigen::MatrixXd covariance = widened(model, unit, inflation);
  const std::size_t reported = job.parameters.size() + job.unknowns.size();
  for (std::size_t i = 0; i < reported; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    fit.parameters.push_back(estimate(model, best, i, std::sqrt(covariance(at, at)), inflation,
                                      weighed.flat_above[i], job));
    for (std::size_t j = 0; j < reported; ++j) {
      const double value = covariance(at, static_cast<Eigen::Index>(j));
      fit.covariance.push_back(std::isfinite(value) ? value : kNotMeasured);
    }
  }
  add_parts(fit, model, unit);
  fit.residuals = model.residuals_at(best.values.data());
  fit.derived = derived_figures(model, best.values, covariance);
  add_verdicts(fit, model.impact_of(best.values.data()));
  return fit;
}

}  // namespace impactdic::sim::fit
