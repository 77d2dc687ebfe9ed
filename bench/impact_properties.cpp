// What must hold of every impact, over many random shots of each law, and partial slip against
// springs that are followed one by one. Prints a line for every shot that breaks something.
//   impact_properties [SHOTS_PER_LAW [SPRING_SHOTS [SEED]]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "host/base/parallel/parallel_for.h"
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

// How far the contact point's velocity after the impact is from that by so many springs, over the
// speed. The springs' own error falls with the square of their number.
double springs_error(const ImpactJob& job, int springs) {
  const double ours = sim::contact::simulate_impact(job).tip_vt_final_m_s;
  const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s,
                                  job.body.radius_m() * job.initial.omega_rad_s);
  return std::abs(support::discrete_springs_tip(job, springs, 10 * springs) - ours) / speed;
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

void run_springs(int shots, std::uint32_t seed) {
  for (const bool damped : {false, true}) {
    const std::vector<ImpactJob> jobs = spring_shots(static_cast<std::size_t>(shots), seed, damped);
    if (jobs.empty()) continue;
    for (const int springs : {250, 500, 1000, 2000}) {
      std::vector<double> errors(jobs.size());
      parallel_for(jobs.size(), 0,
                   [&](std::size_t i) { errors[i] = springs_error(jobs[i], springs); });
      std::printf("%s, %5d springs: %3zu shots, worst %.1e of the speed, %td above 1e-6\n",
                  damped ? "damped" : "undamped", springs, jobs.size(),
                  *std::max_element(errors.begin(), errors.end()),
                  std::count_if(errors.begin(), errors.end(), [](double e) { return e > 1e-6; }));
      std::fflush(stdout);
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
