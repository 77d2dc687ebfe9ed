// How often a fit calls a wrong law inadequate or names the right one, and how often it calls the
// right law inadequate.
//   fit_adequacy [SHOTS]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "tests/support/fitted_shots.h"

namespace impactdic::bench {
namespace {

ImpactJob law(NormalModel normal, RestitutionDamping damping, double angle_deg) {
  ImpactJob job = testing::tennis_shot(angle_deg, -1.6, -2.8);
  job.normal = normal;
  job.contact.restitution_damping = damping;
  if (normal == NormalModel::kHertzDamper) job.contact.stiffness = 200000;
  return job;
}

void run(const char* name, const ImpactJob& truth, const ImpactJob& fitted, int shots) {
  struct Verdict {
    bool inadequate = false, named = false;
  };
  std::vector<Verdict> verdicts(static_cast<std::size_t>(shots));
  parallel_for(verdicts.size(), 0, [&](std::size_t i) {
    const ShotFit fit = testing::fit_of_shot(truth, fitted, static_cast<unsigned>(i + 1), true);
    const RivalFit& best = fit.rivals.front();
    verdicts[i] = {fit.adequacy == Adequacy::kInadequate,
                   best.normal == truth.normal &&
                       best.restitution_damping == truth.contact.restitution_damping};
  });
  const auto count = [&](const auto& test) {
    return static_cast<int>(std::count_if(verdicts.begin(), verdicts.end(), test));
  };
  const int inadequate = count([](const Verdict& v) { return v.inadequate; });
  const int named = count([](const Verdict& v) { return v.named; });
  const int told = count([](const Verdict& v) { return v.inadequate || v.named; });
  std::printf("%-52s inadequate %3d, truth ranked first %3d, either %3d of %d\n", name, inadequate,
              named, told, shots);
  std::fflush(stdout);
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  using namespace impactdic;
  const int shots = argc > 1 ? std::atoi(argv[1]) : 100;
  const auto linear = NormalModel::kLinearSpringDamper, hertz = NormalModel::kHertzDamper;
  const auto none = RestitutionDamping::kNone, force = RestitutionDamping::kToZeroForce;
  const auto job = [](NormalModel n, RestitutionDamping d) { return bench::law(n, d, 30); };
  bench::run("right: linear, none", job(linear, none), job(linear, none), shots);
  bench::run("right: hertz, to_zero_force", job(hertz, force), job(hertz, force), shots);
  bench::run("linear to_zero_force fitted as none", job(linear, force), job(linear, none), shots);
  bench::run("linear none fitted as to_zero_force", job(linear, none), job(linear, force), shots);
  bench::run("hertz none fitted as linear none", job(hertz, none), job(linear, none), shots);
  bench::run("linear none fitted as hertz none", job(linear, none), job(hertz, none), shots);
}
