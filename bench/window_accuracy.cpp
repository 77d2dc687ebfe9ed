// How exactly windows of 15 px measure rendered balls, and how many that call themselves right are
// wrong: the rows of docs/accuracy/windows.md, eight motions of each ball.
//   window_accuracy NOISE FIRST-SEED LAST-SEED PATTERN...
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "sim/speckle/pattern.h"
#include "tests/support/window_truth.h"

namespace impactdic::testing {
namespace {

constexpr double kWrongPx = 0.3;  // of a component

struct Sums {
  int windows = 0, found = 0, wrong = 0;
  std::map<int, int> lost;  // by status
  double squares = 0, bound = 0, normalised = 0, worst = 0, worst_px = 0;

  void add(const JudgedWindow& window) {
    ++windows;
    if (!window.found()) {
      ++lost[window.got.status];
      return;
    }
    ++found;
    const double largest = std::max(std::abs(window.error_u), std::abs(window.error_v));
    wrong += largest > kWrongPx;
    worst_px = std::max(worst_px, largest);
    squares += window.error_u * window.error_u + window.error_v * window.error_v;
    bound += window.bound_u * window.bound_u + window.bound_v * window.bound_v;
    for (const double ratio :
         {window.error_u / window.got.u_sd, window.error_v / window.got.v_sd}) {
      normalised += ratio * ratio;
      worst = std::max(worst, std::abs(ratio));
    }
  }
  void print(const std::string& name) const {
    const double components = 2.0 * found;
    std::printf(
        "%-9s %6d windows, found %.4f, wrong %d; rms %.5f px, over bound %.3f, over sd "
        "%.3f; worst %.3f px, %.1f sd;",
        name.c_str(), windows, static_cast<double>(found) / windows, wrong,
        std::sqrt(squares / components), std::sqrt(squares / bound),
        std::sqrt(normalised / components), worst_px, worst);
    for (const auto& [status, count] : lost) {
      std::printf(" %s %d", to_string(static_cast<WindowStatus>(status)), count);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
};

int run(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "window_accuracy NOISE FIRST-SEED LAST-SEED PATTERN...\n");
    return 2;
  }
  const double noise = std::atof(argv[1]);
  for (int k = 4; k < argc; ++k) {
    Sums whole, cut;
    for (int seed = std::atoi(argv[2]); seed <= std::atoi(argv[3]); ++seed) {
      const sim::speckle::SpeckleBall ball =
          sim::speckle::paint_ball(argv[k], static_cast<std::uint64_t>(seed));
      int number = 0;
      for (const PlaneMotion& motion : kEightMotions) {
        ++number;
        for (const JudgedWindow& window :
             judge_windows(ball, motion, noise, 8 * seed - 8 + number)) {
          (window.cut ? cut : whole).add(window);
        }
      }
    }
    whole.print(std::string(argv[k]) + " whole");
    cut.print(std::string(argv[k]) + " cut");
  }
  return 0;
}

}  // namespace
}  // namespace impactdic::testing

int main(int argc, char** argv) { return impactdic::testing::run(argc, argv); }
