// What must hold of every impact, over many random shots of each law, and partial slip against
// springs that are followed one by one. Prints a line for every shot that breaks something.
//   impact_properties [SHOTS_PER_LAW [SPRING_SHOTS [SEED]]]
#include <cstdio>
#include <cstdlib>

#include "tests/support/discrete_springs.h"
#include "tests/support/random_shots.h"

namespace impactdic::bench {
namespace {

int run_laws(int shots, std::uint32_t seed) {
  int broken = 0;
  for (const support::LawPair& laws : support::kSoundLaws) {
    support::RandomShots random(seed);
    int of_law = 0;
    double longest = 0;
    for (int i = 0; i < shots; ++i) {
      const ImpactJob job = random.next(laws);
      double seconds = 0;
      const std::string what = support::broken_law(job, seconds);
      longest = std::max(longest, seconds);
      if (what.empty()) continue;
      if (++of_law <= 5) std::printf("  shot %d: %s\n", i, what.c_str());
    }
    std::printf("%-20s %-18s %4d shots, %d broken, longest %.1f ms\n",
                std::string(name_of(laws.first)).c_str(), std::string(name_of(laws.second)).c_str(),
                shots, of_law, 1e3 * longest);
    broken += of_law;
  }
  return broken;
}

void run_springs(int shots, std::uint32_t seed) {
  for (const bool damped : {false, true}) {
    support::RandomShots random(seed);
    double worst = 0, sum = 0;
    int above = 0, run = 0;
    while (run < shots) {
      ImpactJob job = random.next({NormalModel::kHertzDamper, FrictionModel::kMawBarberFawcett});
      if (!damped) job.contact.damping_n_s_per_m = 0;
      job.gravity_m_s2 = 0;
      if (damped && job.contact.damping_n_s_per_m == 0) continue;
      ++run;
      const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s,
                                      job.body.radius_m() * job.initial.omega_rad_s);
      const ImpactResult ours = sim::contact::simulate_impact(job);
      // The error falls with the number: extrapolated to infinitely many springs.
      const auto tip = [&](int springs) {
        const double few = support::discrete_springs_tip(job, springs, 10 * springs);
        const double many = support::discrete_springs_tip(job, 2 * springs, 20 * springs);
        return 2 * many - few;
      };
      const double error = std::abs(tip(1000) - ours.tip_vt_final_m_s) / speed;
      const double limit = 1e-6;
      if (error > limit) {
        ++above;
        const double finer = std::abs(tip(4000) - ours.tip_vt_final_m_s) / speed;
        if (above <= 12) {
          std::printf("  springs %d: %.2e, with four times as many %.2e\n", run, error, finer);
        }
        if (finer < error) sum += 1;
      }
      worst = std::max(worst, error);
    }
    std::printf(
        "springs, %s: %d shots, worst %.1e of the speed, %d above 1e-6 (%g of them converge)\n",
        damped ? "damped" : "undamped", shots, worst, above, sum);
  }
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  const int shots = argc > 1 ? std::atoi(argv[1]) : 2000,
            springs = argc > 2 ? std::atoi(argv[2]) : 200;
  const auto seed = static_cast<std::uint32_t>(argc > 3 ? std::atoi(argv[3]) : 1);
  const int broken = impactdic::bench::run_laws(shots, seed);
  impactdic::bench::run_springs(springs, seed);
  return broken == 0 ? 0 : 1;
}
