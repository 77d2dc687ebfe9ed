// How exactly pairs of pictures of a sphere are registered, with its radius known, and how many
// large turns are found without a guess.
//   sphere_accuracy [COUNT [SEED]]
#include <cstdlib>

#include "tests/support/sphere_pairs.h"

int main(int count, char** arguments) {
  using namespace impactdic;
  const int pairs = count > 1 ? std::atoi(arguments[1]) : 100;
  const auto seed = static_cast<unsigned>(count > 2 ? std::atoi(arguments[2]) : 7);
  for (const double noise : {0.01, 2.0}) {
    for (const double most_deg : {0.5, 8.0}) testing::measure_pairs(pairs, most_deg, noise, seed);
  }
  for (const double most_deg : {0.5, 2.0, 8.0}) {
    for (const bool told : {false, true}) {
      for (const testing::PairView view :
           {testing::PairView{25, 0}, testing::PairView{0, 0.05}, testing::PairView{0, 0.1}}) {
        std::printf("seen from %g radii (0: parallel rays), compressed by %g, %s\n  ",
                    view.distance_radii, view.compression, told ? "told" : "not told");
        testing::measure_pairs(pairs, most_deg, 2, seed,
                               {view.distance_radii, view.compression, told});
      }
    }
  }
  for (const double step : {20.0, 60.0, 120.0, 180.0}) testing::count_found(pairs, step, 3, seed);
}
