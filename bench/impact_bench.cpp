// How fast impacts are integrated: a grid of 30 stiffnesses, 20 dampings and 15 frictions, 9000
// integrations at the default tolerance, on as many threads as asked for.
//   impact_bench [THREADS]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"

namespace impactdic::bench {
namespace {

void run_grid(const char* name, const ImpactJob& job, int threads) {
  constexpr int kStiffness = 30, kDamping = 20, kFriction = 15;
  std::vector<long> evaluations(kStiffness * kDamping * kFriction);
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  parallel_for(evaluations.size(), threads, [&](std::size_t i) {
    const int n = static_cast<int>(i);
    ImpactJob point = job;
    point.contact.stiffness *= 0.5 + (n / (kDamping * kFriction)) / 20.0;
    point.contact.damping_n_s_per_m *= 0.1 * (n / kFriction % kDamping);
    point.contact.friction_kinetic *= 0.1 + 0.13 * (n % kFriction);
    point.contact.friction_static = 1.4 * point.contact.friction_kinetic;
    evaluations[i] = sim::contact::simulate_impact(point).evaluations;
  });
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  double sum = 0;
  for (long e : evaluations) sum += static_cast<double>(e);
  std::printf("%-22s %5.2f s, %5.2f s of cores, %4.0f right-hand sides each\n", name, took.count(),
              static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC,
              sum / static_cast<double>(evaluations.size()));
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  const int threads = argc > 1 ? std::atoi(argv[1]) : 0;
  impactdic::bench::run_grid("linear, coulomb", impactdic::sim::job::racket_job(), threads);
  impactdic::bench::run_grid("hertz, three phases", impactdic::sim::job::wood_published_job(),
                             threads);
  impactdic::bench::run_grid("maw_barber_fawcett", impactdic::sim::job::wood_sound_job(), threads);
}
