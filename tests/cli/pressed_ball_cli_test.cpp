// A ball in a long contact, measured without a word of what body it is.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <vector>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

void must(const std::string& arguments) {
  const Outcome outcome = run_program(arguments);
  ASSERT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
}

// Errors of the motions over what they state, rms of both axes.
double over_stated(const CsvTable& track, const CsvTable& truth) {
  double squares = 0;
  int count = 0;
  for (const char* axis : {"dx_px", "dy_px"}) {
    const std::string sd_name = std::string(axis).substr(0, 2) + "_sd_px";
    const std::vector<double> found = track.numbers(axis), sd = track.numbers(sd_name),
                              there = truth.numbers(axis);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!std::isfinite(found[i])) continue;
      squares += std::pow((found[i] - there[i]) / sd[i], 2);
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

// A pressed ball looks as if it tilted. Every motion of the clip stated that: 10 to 30 times what
// it erred by.
TEST(PressedBall, ItsShapeIsTakenForNoTilt) {
  const ScratchFolder folder;
  std::ofstream(folder / "impact.toml")
      << "normal = \"linear_spring_damper\"\nfriction = \"coulomb\"\n"
         "[body]\nshape = \"hollow_sphere\"\nmass_kg = 0.0567\ndiameter_m = 0.067\n"
         "[contact]\nstiffness_n_per_m = 12526.0\ndamping_n_s_per_m = 6.85\n"
         "friction_kinetic = 0.0941\n"
         "[surface]\nangle_deg = 30.0\n[initial]\nvt_m_s = -1.81\nvn_m_s = -3.52\n";
  for (const char* pattern : {"d1", "c3"}) {
    must("synth --simulate " + quoted(folder / "impact.toml") + " --pattern " + pattern +
         " --noise 2 --size 400x400 --radius-px 60 --frames 190 --touch-frame 55 --format mraw" +
         " --force -o " + quoted(folder / "clip"));
    must("track " + quoted(folder / "clip/video.cihx") +
         " --ball-diameter-mm 67 --surface-angle-deg 30 --force -o " + quoted(folder / "track"));
    const double ratio =
        over_stated(CsvTable(folder / "track/track.csv"), CsvTable(folder / "clip/truth.csv"));
    EXPECT_GT(ratio, 0.7) << pattern;
    EXPECT_LT(ratio, 1.3) << pattern;
  }
}

}  // namespace
}  // namespace impactdic::testing
