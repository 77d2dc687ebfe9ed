// How often the 95 % intervals of an impact's figures hold the truth, over shots of any ball,
// surface, speed and framing.
//
// metres_coverage [SHOTS [FEWEST MOST [SEED]]]: FEWEST to MOST frames of free flight on each side.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>

#include "tests/support/filmed_shot.h"

namespace {

using namespace impactdic;

struct Score {
  int inside = 0, stated = 0;
  double squares = 0;  // of the errors over the deviations
};

void count(testing::ScaleBy by, int shots, const testing::Tolerances& tolerances,
           std::uint64_t seed) {
  constexpr double kNormal95 = 1.959964;
  std::mt19937_64 random(seed);
  std::map<std::string, Score> scores;
  int found = 0, warned = 0;
  for (int i = 0; i < shots; ++i) {
    testing::FilmedShot shot = testing::filmed_shot(random, by, tolerances);
    shot.conclude();
    const ImpactFigures& figures = shot.result.impact_si;
    if (!figures.found()) continue;
    ++found;
    warned += !figures.contradictions.empty();
    const auto add = [&](const char* name, const Measured& m, double truth) {
      if (!std::isfinite(m.value) || !(m.sd > 0)) return;
      Score& score = scores[name];
      const double off = (m.value - truth) / m.sd;
      ++score.stated;
      score.inside += std::abs(off) <= kNormal95;
      score.squares += off * off;
    };
    testing::each_figure(shot, add);
    add("spin before", figures.before.spin, shot.truth.before.omega_rad_s);
  }
  std::printf("scale by %s: %d of %d impacts found, %d warned of\n",
              by == testing::ScaleBy::kDiameter ? "diameter" : "ruler", found, shots, warned);
  for (const auto& [name, score] : scores) {
    std::printf("  %-12s %5.1f %% of %d inside, error over stated %.2f\n", name.c_str(),
                100.0 * score.inside / score.stated, score.stated,
                std::sqrt(score.squares / score.stated));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int shots = argc > 1 ? std::atoi(argv[1]) : 400;
  testing::Tolerances tolerances;
  if (argc > 3) {
    tolerances.fewest_frames = std::atoi(argv[2]);
    tolerances.most_frames = std::atoi(argv[3]);
  }
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  for (const auto by : {testing::ScaleBy::kDiameter, testing::ScaleBy::kRuler}) {
    count(by, shots, tolerances, seed);
  }
}
