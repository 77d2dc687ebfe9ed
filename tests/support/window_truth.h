// Windows on a rendered ball whose motion is known exactly, knowing nothing but the circles: what
// they say beside what they should.
#pragma once

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/dic/correlator.h"
#include "host/dic/frame_noise.h"
#include "host/dic/frames/bspline.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic::testing {

// A ball's motion from one frame to the next.
struct PlaneMotion {
  double dx_px, dy_px, turn_deg;
};
// The four of the dissertation, whole pixels, and four that lie on no grid.
inline constexpr PlaneMotion kEightMotions[] = {
    {1, 0, 0},        {1, 1, 0},          {0, 0, 3},          {1, 1, 3},
    {0.37, -0.61, 0}, {-1.43, 0.78, 1.7}, {0.13, 0.29, -2.3}, {2.71, -1.62, 2.9}};

// What a window can be measured to: Cramér–Rao bound of the centre's displacement with affine warp,
// gain and offset free, from the exact picture's gradients; px² a grey level² of noise in each of
// two pictures.
struct VarianceBound {
  double u = 0, v = 0;
};
inline VarianceBound affine_bound(const dic::BSplineImage& exact, const Window& window, int side,
                                  const BallPose& ball, double disc_px) {
  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const double px = window.x0 + i, py = window.y0 + j;
      if (std::hypot(px - ball.cx_px, py - ball.cy_px) > disc_px) continue;
      const auto s = exact.sample(px, py);
      const double x = i - (side - 1) / 2.0, y = j - (side - 1) / 2.0;
      Eigen::Matrix<double, 8, 1> row;
      row << s.slope_x, s.slope_y, s.slope_x * x, s.slope_x * y, s.slope_y * x, s.slope_y * y, 1,
          s.value / 100;
      information += row * row.transpose();
    }
  }
  const Eigen::Matrix<double, 8, 8> inverse = information.inverse();
  return {2 * inverse(0, 0), 2 * inverse(1, 1)};
}

// One window: errors in px, what noise allows at best, and what the window says of itself.
struct JudgedWindow {
  Window window;
  WindowMotion got;
  bool cut = false;  // by the rim
  double error_u = 0, error_v = 0;
  double bound_u = 0, bound_v = 0;  // one standard deviation
  bool found() const { return got.status == static_cast<idic_int>(WindowStatus::kOk); }
};

// Windows of 15 px on a ball of pose `a` that moves, those that the rim cuts too.
inline std::vector<JudgedWindow> judge_windows(const sim::speckle::SpeckleBall& ball,
                                               const PlaneMotion& motion, double noise, int seed) {
  constexpr int kSide = 15;
  const double disc_px = ball.radius_px - 3;
  const int place = (seed - 1) % 8 + 1;
  SynthScene scene;
  scene.width = scene.height = 256;
  scene.noise_sigma = noise;
  scene.noise_seed = static_cast<std::uint64_t>(seed);
  const BallPose a = pose(127.3 + 0.13 * place, 128.4 - 0.17 * place, 40.0 * seed);
  const BallPose b =
      pose(a.cx_px + motion.dx_px, a.cy_px + motion.dy_px, a.angle_deg + motion.turn_deg);
  const auto frames = render_frames(ball, scene, {a, b});
  const dic::BSplineImage exact(sim::speckle::BallRenderer(ball, scene).exact(a), 5);
  auto windows = dic::disc_grid(a.cx_px, a.cy_px, disc_px, kSide, 11, 0.55);
  for (Window& window : windows) {
    window.second = 1;
    window.guess_u = static_cast<idic_int>(std::lround(motion.dx_px));
    window.guess_v = static_cast<idic_int>(std::lround(motion.dy_px));
  }
  FieldOptions options;
  options.noise = dic::estimate_noise(frames[0].to_float().view(), frames[0].full_scale());
  const auto correlator = dic::make_opencl_correlator(shared_engine(), options, 2);
  correlator->set_frame(0, frames[0]);
  correlator->set_frame(1, frames[1]);
  correlator->set_disc(0, a.cx_px, a.cy_px, disc_px);
  const auto motions = correlator->correlate(windows);
  const double turn = motion.turn_deg * kRadPerDeg, c = std::cos(turn) - 1, s = std::sin(turn);
  const double sigma = std::sqrt(noise * noise + 1.0 / 12);
  std::vector<JudgedWindow> judged;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const double x = windows[i].x0 + 7 - a.cx_px, y = windows[i].y0 + 7 - a.cy_px;
    JudgedWindow one{windows[i], motions[i]};
    one.cut = std::hypot(std::abs(x) + 7, std::abs(y) + 7) > disc_px;
    one.error_u = motions[i].u - (motion.dx_px + c * x + s * y);
    one.error_v = motions[i].v - (motion.dy_px - s * x + c * y);
    const VarianceBound bound = affine_bound(exact, windows[i], kSide, a, disc_px);
    one.bound_u = sigma * std::sqrt(bound.u);
    one.bound_v = sigma * std::sqrt(bound.v);
    judged.push_back(one);
  }
  return judged;
}

}  // namespace impactdic::testing
