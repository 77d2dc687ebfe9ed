// How exactly pairs of pictures of a sphere are registered, with its radius known, and how many
// large turns are found without a guess; or, with `distance`, how exactly such pairs tell from
// where they are seen; or, with a PATTERN, the pairs of another ball than e1 alone.
//   sphere_accuracy [COUNT [SEED [distance|PATTERN]]]
#include <impactdic/error.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/sphere/sphere_distances.h"

namespace {

void measure_all_distances(int pairs, unsigned seed) {
  using impactdic::testing::DistanceView, impactdic::testing::measure_distances;
  for (const char* pattern : {"e1", "a1", "c2", "f2"}) {
    for (const double radii : {0.0, 12.0, 25.0, 50.0, 100.0}) {
      measure_distances(pairs, {radii, 25, 2, pattern}, seed);
    }
  }
  for (const double turn_deg : {0.3, 1.0, 3.0, 8.0, 15.0}) {
    measure_distances(pairs, {25, turn_deg}, seed);
  }
  measure_distances(pairs, {25, 25, 5}, seed);
  measure_distances(pairs, {25, 25, 2, "e1", 0.5}, seed);
  measure_distances(pairs, {25, 25, 2, "e1", 0, 0.5}, seed);
}

}  // namespace

int main(int count, char** arguments) try {
  using namespace impactdic;
  const int pairs = count > 1 ? std::atoi(arguments[1]) : 100;
  const auto seed = static_cast<unsigned>(count > 2 ? std::atoi(arguments[2]) : 7);
  const std::string what = count > 3 ? arguments[3] : "e1";
  if (what == "distance") {
    measure_all_distances(pairs, seed);
    return 0;
  }
  for (const double noise : {0.01, 2.0}) {
    for (const double most_deg : {0.5, 8.0}) {
      testing::measure_pairs(pairs, most_deg, noise, seed, {.pattern = what});
    }
  }
  if (count > 3) return 0;
  for (const double most_deg : {0.5, 2.0, 8.0}) {
    for (const bool told : {false, true}) {
      for (const testing::PairView& view :
           {testing::PairView{25, 0}, testing::PairView{0, 0.05}, testing::PairView{0, 0.1}}) {
        std::printf("seen from %g radii (0: parallel rays), compressed by %g, %s\n  ",
                    view.distance_radii, view.compression, told ? "told" : "not told");
        testing::measure_pairs(pairs, most_deg, 2, seed,
                               {view.distance_radii, view.compression, told});
      }
    }
  }
  for (const double step : {20.0, 60.0, 120.0, 180.0}) testing::count_found(pairs, step, 3, seed);
} catch (const impactdic::Error& error) {
  std::fprintf(stderr, "sphere_accuracy: %s\n", error.what());
  return 1;
}
