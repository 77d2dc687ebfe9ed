// How exactly the ball's circle is measured over many balls, and how honest its stated deviations
// are: rendered balls of radius 115 px, noise 2, at places incommensurate with the pixels.
//   circle_accuracy [PATTERNS [FIRST LAST [CONDITIONS [KEEP]]]]
// PATTERNS and CONDITIONS are lists with commas, or "all"; FIRST and LAST are seeds; pictures are
// kept in the folder KEEP and read from there the next time (painting takes longer than all the
// rest).
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/circle/circle.h"
#include "sim/speckle/render.h"

namespace impactdic::bench {
namespace {

constexpr double kRadius = 115;
constexpr int kSide = 272;

struct Condition {
  const char* name;
  bool bar = false;
  double compression = 0;  // along the screen's vertical
  double shading = 0;
  double blur_px = 0.6;
  bool radius_known = false;  // from earlier frames of the clip
  bool tracked = false;       // predicted to a fraction of a pixel from the frame before
};
constexpr Condition kConditions[] = {
    {.name = "plain"},
    {.name = "tracked", .tracked = true},
    {.name = "bar", .bar = true},
    {.name = "bar_known", .bar = true, .radius_known = true},
    {.name = "squash", .compression = 0.05},
    {.name = "both_known", .bar = true, .compression = 0.05, .radius_known = true},
    {.name = "blurred", .blur_px = 1},
    {.name = "shade", .shading = 0.5},
    {.name = "shade_bar", .bar = true, .shading = 0.5, .radius_known = true},
};

struct Measured {
  double error[3];  // cx, cy, r
  double sd[3];
  bool ok;
};

std::vector<std::string> list(const std::string& text) {
  std::vector<std::string> items;
  std::istringstream in(text);
  for (std::string item; std::getline(in, item, ',');) items.push_back(item);
  return items;
}

BallPose pose_of(int seed, const Condition& condition) {
  return {kSide / 2 + std::fmod(0.3819660113 * seed + 0.13, 1),
          kSide / 2 + std::fmod(0.6180339887 * seed + 0.41, 1), 17.0 * seed, condition.compression,
          90};
}

Frame picture(const std::string& pattern, int seed, const Condition& condition,
              const std::string& keep) {
  Frame frame;
  std::ostringstream name;
  name << keep << '/' << pattern << '-' << seed << '-' << condition.bar << '-'
       << condition.compression << '-' << condition.shading << '-' << condition.blur_px;
  if (!keep.empty() && std::filesystem::exists(name.str())) {
    frame.reset(kSide, kSide, 8);
    std::ifstream(name.str(), std::ios::binary)
        .read(reinterpret_cast<char*>(frame.u8.data()), kSide * kSide);
    return frame;
  }
  const BallPose pose = pose_of(seed, condition);
  SynthScene scene;
  scene.width = scene.height = kSide;
  scene.noise_sigma = 2;
  scene.noise_seed = static_cast<std::uint64_t>(seed) + 1;
  scene.shading = condition.shading;
  scene.psf_sigma_px = condition.blur_px;
  if (condition.bar) {
    // The lower 30 % of the rim: a bar whose upper edge cuts it at ±54° from straight down.
    scene.bar.emplace();
    scene.bar->width_px = 2.5 * kRadius;
    scene.bar->x_px = pose.cx_px;
    scene.bar->y_px = pose.cy_px + kRadius * std::cos(0.3 * kPi) + scene.bar->width_px / 2;
  }
  sim::speckle::BallRenderer(
      sim::speckle::paint_ball(pattern, static_cast<std::uint64_t>(seed), kRadius), scene)
      .render(pose, 0, frame);
  if (!keep.empty()) {
    std::ofstream(name.str(), std::ios::binary)
        .write(reinterpret_cast<const char*>(frame.u8.data()), kSide * kSide);
  }
  return frame;
}

Measured measure(const Frame& frame, int seed, const Condition& condition) {
  const BallPose pose = pose_of(seed, condition);
  // As after a Hough transform: a pixel or two away, the shape unknown.
  circle::CirclePrior prior;
  prior.predicted = {pose.cx_px + 1.3, pose.cy_px - 0.9, kRadius + 0.4};
  if (condition.radius_known) {
    prior.radius_px = kRadius;
    prior.radius_sd_px = 0.01;
    prior.compression_axis_rad = kPi / 2;
  }
  circle::CircleFit fit = circle::measure_circle(frame, prior, {});
  if (condition.tracked) {
    prior.predicted = {pose.cx_px + 0.21, pose.cy_px - 0.17, kRadius + 0.1};
    prior.centre_sd_px = prior.rim_sd_px.emplace(0.3);
    prior.bright = fit.bright;
    prior.rim_model = fit.rim_model;
    fit = circle::measure_circle(frame, prior, {});
  }
  return {{fit.circle.cx_px - pose.cx_px, fit.circle.cy_px - pose.cy_px,
           fit.circle.r_px - kRadius * (1 - condition.compression / 2)},
          {fit.cx_sd_px, fit.cy_sd_px, fit.r_sd_px},
          fit.status == circle::CircleStatus::kOk};
}

// Sums over balls.
struct Sums {
  int n = 0, failed = 0;
  double square[3] = {}, radius = 0, normalised[3] = {}, worst = 0;
  void add(const Measured& m) {
    if (!m.ok) {
      ++failed;
      return;
    }
    ++n;
    for (int i = 0; i < 3; ++i) {
      square[i] += m.error[i] * m.error[i];
      normalised[i] += std::pow(m.error[i] / m.sd[i], 2);
    }
    radius += m.error[2];
    worst = std::max(worst, std::hypot(m.error[0], m.error[1]));
  }
  void print(const std::string& pattern) const {
    std::printf("  %-4s %5d %3d   %.4f %.4f   %+.4f %.4f   %.2f %.2f %.2f\n", pattern.c_str(), n,
                failed, std::sqrt((square[0] + square[1]) / (2 * n)), worst, radius / n,
                std::sqrt(square[2] / n), std::sqrt(normalised[0] / n),
                std::sqrt(normalised[1] / n), std::sqrt(normalised[2] / n));
  }
};

void run(const std::vector<std::string>& patterns, int first, int last, const Condition& condition,
         const std::string& keep) {
  std::printf(
      "%s: balls, failed; centre rms an axis, worst; radius mean, rms; error over sd of cx, "
      "cy, r (px)\n",
      condition.name);
  Sums all;
  for (const std::string& pattern : patterns) {
    std::vector<Measured> measured(static_cast<std::size_t>(last - first + 1));
    parallel_for(measured.size(), [&](std::size_t k) {
      const int seed = first + static_cast<int>(k);
      measured[k] = measure(picture(pattern, seed, condition, keep), seed, condition);
    });
    Sums sums;
    for (const Measured& m : measured) {
      sums.add(m);
      all.add(m);
    }
    sums.print(pattern);
  }
  all.print("all");
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  using namespace impactdic;
  using namespace impactdic::bench;
  const auto argument = [&](int i, const char* usual) {
    return std::string(argc > i ? argv[i] : usual);
  };
  std::vector<std::string> patterns = list(argument(1, "a1,a3,b1,c2,e1,e2,f2"));
  if (patterns[0] == "all") {
    patterns.clear();
    for (const sim::speckle::PatternSpec& spec : sim::speckle::pattern_specs())
      patterns.push_back(spec.name);
  }
  const int first = std::atoi(argument(2, "1").c_str()),
            last = std::atoi(argument(3, "20").c_str());
  const std::vector<std::string> wanted = list(argument(4, "all"));
  const std::string keep = argument(5, "");
  if (!keep.empty()) std::filesystem::create_directories(keep);
  for (const Condition& condition : kConditions) {
    if (wanted[0] == "all" ||
        std::find(wanted.begin(), wanted.end(), condition.name) != wanted.end()) {
      run(patterns, first, last, condition, keep);
    }
  }
  return 0;
}
