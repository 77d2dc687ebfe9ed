// How often the 95 % intervals of a fit hold the truth: shots of chapter 3 with 20 um of noise,
// seeds FIRST to FIRST + COUNT - 1; by the trajectory and by restitution and duration. Also how the
// estimates scatter and correlate against what the fits state, and what becomes of friction where
// the ball rolls.
//   fit_coverage [COUNT [FIRST]]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "sim/fit/calibration.h"
#include "tests/support/fitted_shots.h"
#include "tests/support/scratch.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::bench {
namespace {

constexpr double kStiffness = 12526, kDamping = 6.85;

testing::SyntheticTrack shot(unsigned seed) {
  testing::SyntheticTrack track;
  track.job.normal = NormalModel::kLinearSpringDamper;
  track.job.friction = FrictionModel::kNone;
  track.job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  track.job.contact.stiffness = kStiffness;
  track.job.contact.damping_n_s_per_m = kDamping;
  track.job.initial.vn_m_s = -3.26;
  track.position_noise_m = 20e-6;
  track.seed = seed;
  return track;
}

void report(const char* method, const FitResult& result, double seconds) {
  const auto truth_of = [](const ShotFit&, std::size_t p) {
    const double truths[] = {kStiffness, kDamping, (100 + 0.37) / 10000};
    return truths[p];
  };
  std::printf("%s, %zu shots in %.1f s\n", method, result.shots.size(), seconds);
  const auto count = static_cast<double>(result.shots.size());
  std::vector<double> spread;
  for (std::size_t p = 0; p < result.shots[0].parameters.size(); ++p) {
    double inside = 0, squares = 0, stated = 0, bias = 0;
    for (const ShotFit& fit : result.shots) {
      const ParameterEstimate& e = fit.parameters[p];
      const double off = e.value - truth_of(fit, p);
      inside += e.ci95_low <= truth_of(fit, p) && truth_of(fit, p) <= e.ci95_high;
      squares += off * off, stated += e.sd, bias += off;
    }
    spread.push_back(std::sqrt(squares / count));
    std::printf("  %-20s inside %.2f %%, rms error %.4g, stated %.4g, bias %.2g\n",
                result.shots[0].parameters[p].key.c_str(), 100 * inside / count, spread[p],
                stated / count, bias / count);
  }
  double product = 0, stated = 0;
  for (const ShotFit& fit : result.shots) {
    const std::size_t size = fit.parameters.size();
    product += (fit.parameters[0].value - kStiffness) * (fit.parameters[1].value - kDamping);
    stated += fit.covariance[1] / std::sqrt(fit.covariance[0] * fit.covariance[size + 1]);
  }
  std::printf("  correlation of the two: %.3f, stated %.3f\n",
              product / count / spread[0] / spread[1], stated / count);
}

void run(unsigned count, unsigned first) {
  const testing::ScratchFolder folder;
  FitRequest job;
  job.impact = shot(1).job;
  job.impact.contact.stiffness = job.impact.contact.damping_n_s_per_m = 0;
  job.parameters = {FitParameter::kStiffness, FitParameter::kDamping};
  for (unsigned seed = first; seed < first + count; ++seed) {
    const auto file = folder / (std::to_string(seed) + ".csv");
    write_track(shot(seed), file);
    job.shots.push_back({file, 0});
  }
  for (const auto& [method, name] :
       {std::pair{FitMethod::kTrajectory, "trajectory"},
        std::pair{FitMethod::kRestitutionDuration, "restitution_duration"}}) {
    job.method = method;
    const auto begin = std::chrono::steady_clock::now();
    job.threads = 0;
    const FitResult result = sim::fit::calibrate(job);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    report(name, result, took.count());
  }
}

// A kink: where the ball rolls before it leaves, any greater friction would have done the same.
// Where a fit states an interval of friction it is to hold the truth; elsewhere it is to say that
// friction is not determined.
void run_rolling(unsigned count, unsigned first) {
  constexpr double kFriction = 0.3;
  ImpactJob truth = testing::tennis_shot(30, -0.5, -2.8);
  truth.contact.friction_kinetic = kFriction;
  std::vector<ShotFit> fits(count);
  parallel_for(count, 0, [&](std::size_t i) {
    fits[i] = testing::fit_of_shot(truth, truth, first + static_cast<unsigned>(i), false);
  });
  const double truths[] = {truth.contact.stiffness, truth.contact.damping_n_s_per_m, kFriction};
  std::printf("rolling, friction %g, %u shots\n", kFriction, count);
  for (std::size_t p = 0; p < 3; ++p) {
    unsigned inside = 0, determined = 0, wrong = 0;
    for (const ShotFit& fit : fits) {
      const ParameterEstimate& e = fit.parameters[p];
      const bool holds = e.ci95_low <= truths[p] && truths[p] <= e.ci95_high;
      inside += holds, determined += e.determined, wrong += e.determined && !holds;
    }
    std::printf("  %-20s inside %u, determined %u, determined and wrong %u\n",
                fits[0].parameters[p].key.c_str(), inside, determined, wrong);
  }
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  const auto number = [&](int i, unsigned fallback) {
    return argc > i ? static_cast<unsigned>(std::atoi(argv[i])) : fallback;
  };
  impactdic::bench::run(number(1, 400), number(2, 1));
  impactdic::bench::run_rolling(number(1, 400), number(2, 1));
}
