// What must hold of every impact, over many random shots of each law, and partial slip against
// springs that are followed one by one. Prints a line for every shot that breaks something.
//   impact_properties [SHOTS_PER_LAW [SPRING_SHOTS [SEED]]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "host/base/parallel.h"
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

// The contact point's velocity after the impact against `springs` and twice as many, whose error
// falls with their number or with its square: the better of both extrapolations.
double springs_error(const ImpactJob& job, int springs) {
  const double ours = sim::contact::simulate_impact(job).tip_vt_final_m_s;
  const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s,
                                  job.body.radius_m() * job.initial.omega_rad_s);
  const double few = support::discrete_springs_tip(job, springs, 10 * springs);
  const double many = support::discrete_springs_tip(job, 2 * springs, 20 * springs);
  const double first = 2 * many - few, second = (4 * many - few) / 3;
  return std::min(std::abs(first - ours), std::abs(second - ours)) / speed;
}

std::vector<ImpactJob> spring_shots(std::size_t shots, std::uint32_t seed, bool damped) {
  support::RandomShots random(seed);
  std::vector<ImpactJob> jobs;
  while (jobs.size() < shots) {
    ImpactJob job = random.next({NormalModel::kHertzDamper, FrictionModel::kMawBarberFawcett});
    if (!damped) job.contact.damping_n_s_per_m = 0;
    job.gravity_m_s2 = 0;
    if (!damped || job.contact.damping_n_s_per_m > 0) jobs.push_back(job);
  }
  return jobs;
}

// What misses 1e-6 is followed by four times as many springs, twice over: an error of ours stays,
// one of the springs falls.
void run_springs(int shots, std::uint32_t seed) {
  for (const bool damped : {false, true}) {
    std::vector<ImpactJob> jobs = spring_shots(static_cast<std::size_t>(shots), seed, damped);
    for (const int springs : {1000, 4000, 16000}) {
      if (jobs.empty()) break;
      std::vector<double> errors(jobs.size());
      parallel_for(jobs.size(), 0,
                   [&](std::size_t i) { errors[i] = springs_error(jobs[i], springs); });
      std::vector<ImpactJob> missed;
      for (std::size_t i = 0; i < jobs.size(); ++i) {
        if (errors[i] > 1e-6) missed.push_back(jobs[i]);
      }
      std::printf("%s, %5d and %5d springs: %3zu shots, worst %.1e of the speed, %zu above 1e-6\n",
                  damped ? "damped" : "undamped", springs, 2 * springs, jobs.size(),
                  *std::max_element(errors.begin(), errors.end()), missed.size());
      std::fflush(stdout);
      jobs = std::move(missed);
    }
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
