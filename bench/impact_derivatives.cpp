// The derivatives of impacts by every number of their jobs against extrapolated differences, over
// random shots of each law, in the plane and in space. Prints a line a law.
//   impact_derivatives [SHOTS_PER_LAW [SEED [CONVERGED]]]
// CONVERGED: by how much the last extrapolation may move (default 1e-9).
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "tests/support/impacts/derivative_check.h"
#include "tests/support/random_shots.h"

namespace impactdic::bench {
namespace {

struct Row {
  int shots = 0, above = 0, compared = 0, undecided = 0, missing = 0, failed = 0;
  double worst = 0;
  std::string where;
};

Row run(const support::LawPair& laws, bool space, int shots, std::uint32_t seed, double converged) {
  support::RandomShots random(seed);
  std::vector<ImpactJob> jobs;
  for (int i = 0; i < shots; ++i) {
    jobs.push_back(space ? random.next_in_space(laws) : random.next(laws));
  }
  std::vector<support::DerivativeError> errors(jobs.size());
  std::vector<char> failed(jobs.size(), 0);
  parallel_for(jobs.size(), 0, [&](std::size_t i) {
    try {
      errors[i] = support::derivative_error(jobs[i], converged);
    } catch (const Error& error) {
      failed[i] = 1;
      errors[i].where = error.what();
    }
  });
  Row row;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const support::DerivativeError& e = errors[i];
    ++row.shots;
    row.above += e.worst > 1e-8;
    row.compared += e.compared, row.undecided += e.undecided, row.missing += e.missing;
    row.failed += failed[i];
    if (e.worst > row.worst || failed[i] != 0 || (row.where.empty() && e.missing > 0)) {
      row.worst = std::max(row.worst, e.worst);
      row.where = "shot " + std::to_string(i) + ": " + e.where;
    }
  }
  return row;
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  using namespace impactdic;
  const int shots = argc > 1 ? std::atoi(argv[1]) : 20;
  const auto seed = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 1);
  const double converged = argc > 3 ? std::atof(argv[3]) : 1e-9;
  for (const bool space : {false, true}) {
    for (const support::LawPair& laws : support::kSoundLaws) {
      const bench::Row row = bench::run(laws, space, shots, seed, converged);
      std::printf(
          "%-5s %-22s %-18s %3d shots, %3d above 1e-8, worst %.1e, %6d compared, %5d "
          "undecided, %4d missing, %d failed; %s\n",
          space ? "space" : "plane", std::string(name_of(laws.first)).c_str(),
          std::string(name_of(laws.second)).c_str(), row.shots, row.above, row.worst, row.compared,
          row.undecided, row.missing, row.failed, row.where.c_str());
      std::fflush(stdout);
    }
  }
}
