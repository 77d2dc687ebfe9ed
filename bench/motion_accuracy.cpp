// How exactly the motion of rendered balls is measured: the rows of docs/accuracy/ball.md, every
// one with its fixed seeds.
//   motion_accuracy STUDY [PAIRS-PER-BALL [PATTERN[:SEED]...]]
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sim/speckle/pattern.h"
#include "tests/support/motion_truth.h"
#include "tests/support/rendered_clip.h"

namespace impactdic::testing {
namespace {

constexpr double kRadiusPx = 115;
constexpr int kSide = 300;
constexpr double kMargin = 4;

struct Study {
  int pairs = 0;  // per ball
  std::vector<std::string> patterns;
};

SynthScene scene(double noise, std::uint64_t seed) {
  SynthScene out;
  out.width = out.height = kSide;
  out.noise_sigma = noise;
  out.noise_seed = seed;
  return out;
}

// Of a ball named PATTERN or PATTERN:SEED.
std::uint64_t seed_of(const std::string& name) {
  const auto colon = name.find(':');
  return colon == std::string::npos ? 1 : std::stoull(name.substr(colon + 1));
}
sim::speckle::SpeckleBall paint(const std::string& name) {
  return sim::speckle::paint_ball(name.substr(0, name.find(':')), seed_of(name));
}

std::vector<std::string> patterns(bool d) {
  std::vector<std::string> names;
  for (const sim::speckle::PatternSpec& spec : sim::speckle::pattern_specs()) {
    if ((spec.name[0] == 'd') == d) names.push_back(spec.name);
  }
  return names;
}

void fractions(const Study& study) {
  PairMeasurement measurement(Estimator::kBall, kRadiusPx);
  PosePairs pairs;
  for (int k = 0; k <= 20; ++k) {
    BallPose first;
    first.cx_px = 149.3;
    first.cy_px = 150.6;
    first.angle_deg = 7;
    BallPose second = first;
    second.cx_px += 0.05 * k;
    pairs.add(first, second);
  }
  MotionErrors all;
  for (const std::string& name : study.patterns) {
    const auto got = measurement.measure(paint(name), scene(0, 1), pairs, Centres::kKnown, {});
    got.at_point.print(name);
    all.add(got.at_point);
  }
  all.print("all");
}

// Both kinds of motions, of a known point and of the measured centre.
void motions(const Study& study, Estimator estimator, double hidden) {
  PairMeasurement measurement(estimator, kRadiusPx);
  std::map<std::string, MotionErrors> pooled;
  for (const std::string& name : study.patterns) {
    const sim::speckle::SpeckleBall ball = paint(name);
    SynthScene the_scene = scene(2, 1);
    BallPose middle;
    middle.cx_px = middle.cy_px = 0.5 * kSide;
    if (hidden > 0) the_scene.bar = sim::speckle::bar_hiding(hidden, middle, kRadiusPx);
    const MotionBound bound = motion_bound(ball, the_scene, kMargin);
    const PosePairs fixed = fixed_motions(study.pairs, 1, 1, 3, 8, 0.5 * kSide);
    const PosePairs random = random_motions(study.pairs, 9, 0.5 * kSide);
    for (const Centres centres : {Centres::kKnown, Centres::kMeasured}) {
      for (const auto* kind : {&fixed, &random}) {
        the_scene.noise_seed = (kind == &fixed ? 100 : 200) + (centres == Centres::kKnown ? 0 : 10);
        const auto got = measurement.measure(ball, the_scene, *kind, centres, bound);
        const std::string what = kind == &fixed ? " 1,1 px 3 deg" : " random";
        if (centres == Centres::kKnown) {
          got.at_point.print(name + what);
          pooled[what + ", point"].add(got.at_point);
        } else {
          got.at_centre.print(name + what + " centre");
          pooled[what + ", point found"].add(got.at_point);
          pooled[what + ", centre"].add(got.at_centre);
        }
      }
    }
  }
  for (const auto& [what, errors] : pooled) errors.print("all" + what);
}

void ring_turns(const Study& study) {
  PairMeasurement measurement(Estimator::kRing, kRadiusPx);
  for (const double turn_deg : {3.0, 20.0, 90.0, 170.0}) {
    MotionErrors known, measured;
    for (const std::string& name : study.patterns) {
      const sim::speckle::SpeckleBall ball = paint(name);
      const MotionBound bound = motion_bound(ball, scene(2, 1), 5);
      const PosePairs pairs = fixed_motions(study.pairs, 0.37, -0.61, turn_deg, 18, 0.5 * kSide);
      known.add(measurement.measure(ball, scene(2, 1), pairs, Centres::kKnown, bound).at_point);
      const auto got = measurement.measure(ball, scene(2, 2), pairs, Centres::kMeasured, bound);
      got.at_point.print(name);
      measured.add(got.at_point);
    }
    known.print(std::to_string(turn_deg) + " known centre");
    measured.print(std::to_string(turn_deg) + " own centre");
  }
}

// Light that is fixed to the lamp while the pattern turns under it.
void shading(const Study& study) {
  PairMeasurement measurement(Estimator::kBall, kRadiusPx);
  for (const double strength : {0.0, 0.25, 0.5}) {
    for (const double turn_deg : {3.0, 30.0, 90.0, 180.0}) {
      MotionErrors all;
      for (const std::string& name : study.patterns) {
        const sim::speckle::SpeckleBall ball = paint(name);
        SynthScene lit = scene(2, 3);
        lit.shading = strength;
        const MotionBound bound = motion_bound(ball, lit, kMargin);
        const PosePairs pairs = fixed_motions(study.pairs, 1, 1, turn_deg, 48, 0.5 * kSide);
        all.add(measurement.measure(ball, lit, pairs, Centres::kKnown, bound).at_point);
      }
      all.print("shading " + std::to_string(strength) + ", " + std::to_string(turn_deg) + " deg");
    }
  }
}

// A ball that turns by 3° a frame on a path that fits no grid, `frames` frames.
std::vector<BallPose> rolling_path(int frames, double middle_px, double reach_px) {
  std::vector<BallPose> poses;
  for (int k = 0; k < frames; ++k) {
    BallPose pose;
    pose.cx_px = middle_px + reach_px * std::sin(0.037 * k);
    pose.cy_px = middle_px + reach_px * std::sin(0.023 * k + 1);
    pose.angle_deg = 3.01 * k + 11;
    poses.push_back(pose);
  }
  return poses;
}

void print(const std::string& name, const DriftErrors& errors) {
  std::printf(
      "%-16s poses: %d, %d lost, rms %.5f %.5f px %.5f deg, worst %.4f %.4f %.4f, at the end %+.5f "
      "%+.5f %+.5f, over sd %.2f %.2f %.2f; steps summed %+.5f %+.5f px %+.5f deg\n",
      name.c_str(), errors.x.count, errors.lost, errors.x.rms(), errors.y.rms(),
      errors.angle_deg.rms(), errors.x.largest, errors.y.largest, errors.angle_deg.largest,
      errors.end_x_px, errors.end_y_px, errors.end_angle_deg, errors.x.over_sd(),
      errors.y.over_sd(), errors.angle_deg.over_sd(), errors.sum_x_px, errors.sum_y_px,
      errors.sum_angle_deg);
  std::fflush(stdout);
}

// `pairs` frames of each ball, the light falling by `shade` across it.
void drifts(const Study& study, double shade) {
  DriftErrors all;
  for (const std::string& name : study.patterns) {
    SynthScene lit = scene(2, 5);
    lit.shading = shade;
    RenderedClip clip(paint(name), lit, rolling_path(study.pairs, 0.5 * kSide, 20));
    const DriftErrors errors = drift(track(clip, Estimator::kBall), clip.poses());
    print(name, errors);
    all.x.add(errors.x);
    all.y.add(errors.y);
    all.angle_deg.add(errors.angle_deg);
    all.lost += errors.lost;
  }
  print("all", all);
}

// Errors over stated deviations of everything in track.csv, `pairs` frames of each ball.
void uncertainty(const Study& study, Estimator estimator) {
  struct Column {
    const char* name;
    Errors all;
  };
  Column columns[] = {{"cx", {}}, {"cy", {}}, {"r", {}}, {"dx", {}}, {"dy", {}}, {"rot", {}}};
  for (const std::string& name : study.patterns) {
    RenderedClip clip(paint(name), scene(2, 5 + seed_of(name)),
                      rolling_path(study.pairs, 0.5 * kSide, 20));
    const auto& truth = clip.poses();
    const std::vector<TrackRow> rows = track(clip, estimator);
    Errors own[6];
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const TrackRow& row = rows[k];
      own[0].add(row.cx_px - truth[k].cx_px, row.cx_sd_px);
      own[1].add(row.cy_px - truth[k].cy_px, row.cy_sd_px);
      own[2].add(row.r_px - kRadiusPx, row.r_sd_px);
      if (!row.motion_ok) continue;
      own[3].add(row.dx_px - (truth[k + 1].cx_px - truth[k].cx_px), row.dx_sd_px);
      own[4].add(row.dy_px - (truth[k + 1].cy_px - truth[k].cy_px), row.dy_sd_px);
      const double turn_deg = truth[k + 1].angle_deg - truth[k].angle_deg;
      own[5].add(row.rot_deg - turn_deg, row.rot_sd_deg);
    }
    std::printf("%-4s", name.c_str());
    for (int i = 0; i < 6; ++i) {
      std::printf("  %s %.5f (mean %+.5f, over sd %.2f)", columns[i].name, own[i].rms(),
                  own[i].mean(), own[i].over_sd());
      columns[i].all.add(own[i]);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  for (const Column& column : columns) {
    std::printf("all %s: %d, rms %.5f, over sd %.2f\n", column.name, column.all.count,
                column.all.rms(), column.all.over_sd());
  }
}

int run(const std::string& name, Study study) {
  const auto set = [&](int pairs, const std::vector<std::string>& names) {
    if (study.pairs == 0) study.pairs = pairs;
    if (study.patterns.empty()) study.patterns = names;
  };
  if (name == "fractions") {
    set(21, patterns(false));
    fractions(study);
  } else if (name == "motions") {
    set(16, patterns(false));
    motions(study, Estimator::kBall, 0);
  } else if (name == "sparse") {
    set(16, patterns(true));
    motions(study, Estimator::kBall, 0);
  } else if (name == "bar") {
    set(16, patterns(false));
    motions(study, Estimator::kBall, 0.3);
  } else if (name == "ring") {
    set(8, patterns(false));
    ring_turns(study);
  } else if (name == "shading") {
    set(4, patterns(false));
    shading(study);
  } else if (name == "drift") {
    set(61, patterns(false));
    drifts(study, 0);
  } else if (name == "drift_shaded") {
    set(61, patterns(false));
    drifts(study, 0.3);
  } else if (name == "uncertainty") {
    set(12, patterns(false));
    uncertainty(study, Estimator::kBall);
  } else if (name == "uncertainty_field") {
    set(12, patterns(false));
    uncertainty(study, Estimator::kField);
  } else if (name == "field") {
    set(8, patterns(false));
    motions(study, Estimator::kField, 0);
  } else {
    std::fprintf(stderr,
                 "studies: fractions motions sparse bar ring shading drift drift_shaded "
                 "uncertainty uncertainty_field field\n");
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace impactdic::testing

int main(int argc, char** argv) {
  impactdic::testing::Study study;
  if (argc > 2) study.pairs = std::atoi(argv[2]);
  for (int k = 3; k < argc; ++k) study.patterns.push_back(argv[k]);
  return impactdic::testing::run(argc > 1 ? argv[1] : "", study);
}
