// How often the 95 % intervals of an impact's figures hold the truth, over shots of any ball,
// surface, speed and framing.
//
// metres_coverage [SHOTS [FEWEST MOST [SEED [BY]]]]: FEWEST to MOST frames of free flight on each
// side; BY: what tells the scale, diameter, ruler or, with the lens and the tilt, a calibration by
// a target that is filmed anew for each shot: checkerboard, charuco or dots. Without it the first
// two.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/support/filmed_shot.h"
#ifdef IMPACTDIC_WITH_CALIBRATION
#include "tests/support/camera/shot_by_target.h"
#endif

namespace {

using namespace impactdic;

// Errors over stated deviations.
class Score {
 public:
  void add(const Measured& found, double truth) {
    if (!std::isfinite(found.value) || !(found.sd > 0)) return;
    constexpr double kNormal95 = 1.959964;
    const double off = (found.value - truth) / found.sd;
    ++stated_;
    inside_ += std::abs(off) <= kNormal95;
    squares_ += off * off;
  }
  void print(const char* name) const {
    std::printf("  %-12s %5.1f %% of %d inside, error over stated %.2f\n", name,
                100.0 * inside_ / stated_, stated_, std::sqrt(squares_ / stated_));
  }

 private:
  int inside_ = 0, stated_ = 0;
  double squares_ = 0;
};

class Tally {
 public:
  void add(const testing::FilmedShot& shot) {
    ++shots_;
    const ImpactFigures& figures = shot.result.impact_si;
    if (!figures.found()) return;
    ++found_;
    warned_ += !figures.contradictions.empty();
    const auto add = [&](const char* name, const Measured& m, double truth) {
      scores_[name].add(m, truth);
    };
    testing::each_figure(shot, add);
    add("spin before", figures.before.spin, shot.truth.before.omega_rad_s);
  }
  void print(const std::string& by) const {
    std::printf("scale by %s: %d of %d impacts found, %d warned of\n", by.c_str(), found_, shots_,
                warned_);
    for (const auto& [name, score] : scores_) score.print(name.c_str());
    std::fflush(stdout);
  }

 private:
  std::map<std::string, Score> scores_;
  int shots_ = 0, found_ = 0, warned_ = 0;
};

// `refused`: calibrations that were, as without the target in the first picture.
testing::FilmedShot concluded(std::mt19937_64& random, const std::string& by,
                              const testing::Tolerances& tolerances, int& refused) {
  if (by == "diameter" || by == "ruler") {
    const auto scale = by == "ruler" ? testing::ScaleBy::kRuler : testing::ScaleBy::kDiameter;
    testing::FilmedShot shot = testing::filmed_shot(random, scale, tolerances);
    shot.conclude();
    return shot;
  }
#ifdef IMPACTDIC_WITH_CALIBRATION
  testing::CalibrationPlan plan;
  plan.target = parse_calibration_target(by);
  plan.most_pictures = 12;  // with few, the camera counts for much
  testing::ShotByTarget shot = testing::shot_by_target_of(random, plan, tolerances);
  shot.conclude();
  refused += shot.refused;
  return shot.shot;
#else
  std::fprintf(stderr, "this build has no calibration\n");
  std::exit(2);
#endif
}

void count(const std::string& by, int shots, const testing::Tolerances& tolerances,
           std::uint64_t seed) {
  constexpr int kPrintEvery = 50;
  std::mt19937_64 random(seed);
  Tally tally;
  int refused = 0;
  for (int i = 1; i <= shots; ++i) {
    tally.add(concluded(random, by, tolerances, refused));
    if (i == shots || (by != "diameter" && by != "ruler" && i % kPrintEvery == 0)) tally.print(by);
  }
  if (refused > 0) std::printf("  %d calibrations were refused and made again\n", refused);
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
  const std::vector<std::string> scales =
      argc > 5 ? std::vector<std::string>{argv[5]} : std::vector<std::string>{"diameter", "ruler"};
  for (const std::string& by : scales) count(by, shots, tolerances, seed);
}
