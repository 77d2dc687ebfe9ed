#include "host/study/motion_errors.h"

#include <cmath>

namespace impactdic::study {
namespace {

constexpr double kRimPx = 3;  // as far in from the circle the picture is the ball's alone

// How a point of the ball moves that lies (x, y) px from its centre.
struct Shift {
  double u, v;
};
Shift shift_at(double x, double y, double dx, double dy, double rot_rad) {
  const double c = std::cos(rot_rad) - 1, s = std::sin(rot_rad);
  return {dx + c * x + s * y, dy - s * x + c * y};
}

void add_motion(const motion::PairMotion& pair, const PairTruth& truth, MotionErrors& errors) {
  const dic::RigidMotion& got = pair.motion;
  const StudyMotion& want = truth.motion;
  errors.dx_px.add(got.dx_px - want.dx_px);
  errors.dy_px.add(got.dy_px - want.dy_px);
  errors.rot_deg.add(got.rot_rad * kDegPerRad - want.rot_deg);
  const Shift centre = shift_at(truth.cx_px - pair.first.cx_px, truth.cy_px - pair.first.cy_px,
                                got.dx_px, got.dy_px, got.rot_rad);
  errors.shift_px.add(centre.u - want.dx_px);
  errors.shift_px.add(centre.v - want.dy_px);
}

}  // namespace

void add_pair(const motion::PairMotion& pair, const PairTruth& truth, int window_px,
              const dic::PictureSlopes& slopes, double noise, MotionErrors& errors) {
  ++errors.pairs;
  if (pair.motion.ok) {
    add_motion(pair, truth, errors);
  } else {
    ++errors.failed_pairs;
  }
  const StudyMotion& want = truth.motion;
  const double half = (window_px - 1) / 2.0;
  for (std::size_t i = 0; i < pair.field.size(); ++i) {
    const Window& window = pair.windows[i];
    const WindowMotion& got = pair.field[i];
    ++errors.windows;
    if (got.status != static_cast<idic_int>(WindowStatus::kOk)) {
      ++(got.status == static_cast<idic_int>(WindowStatus::kNoTexture) ? errors.no_texture
                                                                       : errors.failed);
      continue;
    }
    const Shift right = shift_at(window.x0 + half - truth.cx_px, window.y0 + half - truth.cy_px,
                                 want.dx_px, want.dy_px, want.rot_deg * kRadPerDeg);
    const double du = got.u - right.u, dv = got.v - right.v;
    if (std::hypot(du, dv) > kWrongPx) {
      ++errors.wrong;
      continue;
    }
    // The bound of a window that the rim cuts would count the rim.
    const double out_x = std::abs(window.x0 + half - pair.first.cx_px) + half;
    const double out_y = std::abs(window.y0 + half - pair.first.cy_px) + half;
    if (std::hypot(out_x, out_y) > pair.first.r_px - kRimPx) continue;
    const dic::WindowBound bound = slopes.window(window.x0, window.y0, window_px, noise);
    if (std::hypot(bound.u_sd_px, bound.v_sd_px) > kUsablePx) continue;
    errors.window_px.add(du);
    errors.window_px.add(dv);
    errors.window_bound_px.add(bound.u_sd_px);
    errors.window_bound_px.add(bound.v_sd_px);
  }
}

}  // namespace impactdic::study
