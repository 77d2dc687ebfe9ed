#include "host/pipeline/fill_row.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/dic/sphere/sphere_errors.h"

namespace impactdic::pipeline {

namespace {

bool is_sphere(const dic::RigidMotion& motion) { return motion.rot_x_sd_rad > 0; }

// The motion was taken to be that of a sphere about the circle's centre.
void set_sphere(TrackRow& row, dic::RigidMotion motion) {
  if (row.circle_ok) {
    dic::add_source_errors(motion, {row.r_px, 0, row.cx_sd_px, row.cy_sd_px});
  }
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  row.rot_x_deg = motion.rot_x_rad * kDegPerRad;
  row.rot_y_deg = motion.rot_y_rad * kDegPerRad;
  row.rot_x_sd_deg = motion.rot_x_sd_rad * kDegPerRad;
  row.rot_y_sd_deg = motion.rot_y_sd_rad * kDegPerRad;
  row.dx_rot_y_corr = motion.dx_rot_y_corr;
  row.dy_rot_x_corr = motion.dy_rot_x_corr;
}

// Motions and circles of some frames along one axis.
struct Way {
  double moved_px = 0, variance_px2 = 0;  // by the motions; independent from frame to frame
  bool leads_elsewhere(double from, double from_sd, double to, double to_sd, double steps) const {
    constexpr double kChance = 6, kLeast_px = 0.02;
    // The outline of a ball 12 radii away is not about its centre: by so much of the way.
    constexpr double kAboutCentre = 0.007;
    const double off = std::abs(moved_px - (to - from)) - kAboutCentre * std::abs(to - from);
    return off > kLeast_px * steps &&
           off > kChance * std::sqrt(variance_px2 + from_sd * from_sd + to_sd * to_sd);
  }
};

bool is_part_of_path(const TrackRow& row) {
  return row.status == TrackStatus::kOk && row.motion_ok && row.circle_ok;
}

// The motions of rows `first` to `last`, not included, whose circle ends them.
bool leads_elsewhere(std::span<const TrackRow> rows, std::size_t first, std::size_t last) {
  Way x, y;
  for (std::size_t i = first; i < last; ++i) {
    x.moved_px += rows[i].dx_px;
    y.moved_px += rows[i].dy_px;
    x.variance_px2 += rows[i].dx_sd_px * rows[i].dx_sd_px;
    y.variance_px2 += rows[i].dy_sd_px * rows[i].dy_sd_px;
  }
  const TrackRow &from = rows[first], &to = rows[last];
  const auto steps = static_cast<double>(last - first);
  return x.leads_elsewhere(from.cx_px, from.cx_sd_px, to.cx_px, to.cx_sd_px, steps) ||
         y.leads_elsewhere(from.cy_px, from.cy_sd_px, to.cy_px, to.cy_sd_px, steps);
}

}  // namespace

TrackRow row_without_ball(const FrameRange& frames, double fps,
                          std::span<const std::int64_t> periods, std::int64_t index) {
  // With those that the camera lost.
  const auto period = [&](std::int64_t i) {
    return periods.empty() ? i : periods[static_cast<std::size_t>(i)];
  };
  TrackRow row;
  row.frame = frames.at(index);
  const double rate = fps > 0 ? fps / static_cast<double>(frames.step) : kNotMeasured;
  row.time_s = static_cast<double>(period(index)) / rate;
  if (index + 1 < frames.count()) {
    row.periods = static_cast<int>(period(index + 1) - period(index));
  }
  return row;
}

void set_circle(TrackRow& row, const circle::CircleFit& fit) {
  row.circle_ok = fit.status == circle::CircleStatus::kOk;
  row.status = fit.status == circle::CircleStatus::kOk          ? TrackStatus::kOk
               : fit.status == circle::CircleStatus::kOutOfView ? TrackStatus::kOutOfView
                                                                : TrackStatus::kNoBall;
  row.by_hand = fit.by_hand;
  if (!row.circle_ok) return;
  row.cx_px = fit.circle.cx_px;
  row.cy_px = fit.circle.cy_px;
  row.r_px = fit.circle.r_px;
  row.cx_sd_px = fit.cx_sd_px;
  row.cy_sd_px = fit.cy_sd_px;
  row.r_sd_px = fit.r_sd_px;
  if (!fit.ellipse) return;
  row.e1_px = fit.e1_px;
  row.e2_px = fit.e2_px;
  row.e1_sd_px = fit.e1_sd_px;
  row.e2_sd_px = fit.e2_sd_px;
}

void set_motion(TrackRow& row, const dic::RigidMotion& motion, const motion::Stretch& stretch) {
  row.motion_ok = motion.ok;
  row.windows = motion.used;
  if (!motion.ok) return;
  row.dx_px = motion.dx_px;
  row.dy_px = motion.dy_px;
  row.rot_deg = motion.rot_rad * kDegPerRad;
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  if (is_sphere(motion)) {
    set_sphere(row, motion);
    return;
  }
  // The point that was followed is off the ball's centre by the circle's error, turns about it and
  // is carried towards it where the ball is compressed.
  if (!row.circle_ok) return;
  const double c = std::cos(motion.rot_rad), s = std::sin(motion.rot_rad);
  const double xx = 1 + stretch.xx, xy = stretch.xy, yy = 1 + stretch.yy;
  const auto with_centre = [&](double sd_px, double by_x, double by_y) {
    return std::hypot(sd_px, by_x * row.cx_sd_px, by_y * row.cy_sd_px);
  };
  row.dx_sd_px = with_centre(row.dx_sd_px, c * xx + s * xy - 1, c * xy + s * yy);
  row.dy_sd_px = with_centre(row.dy_sd_px, c * xy - s * xx, c * yy - s * xy - 1);
}

void set_round_motion(TrackRow& row, const dic::RigidMotion& motion) {
  row.motion_ok = true;
  row.dx_px = motion.dx_px;
  row.dy_px = motion.dy_px;
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_deg = motion.rot_rad * kDegPerRad;
  row.rot_x_deg = motion.rot_x_rad * kDegPerRad;
  row.rot_y_deg = motion.rot_y_rad * kDegPerRad;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  row.rot_x_sd_deg = motion.rot_x_sd_rad * kDegPerRad;
  row.rot_y_sd_deg = motion.rot_y_sd_rad * kDegPerRad;
}

void forget_way(TrackRow& row) {
  row.motion_ok = false;
  row.dx_px = row.dy_px = row.dx_sd_px = row.dy_sd_px = kNotMeasured;
  row.centre_u_px = row.centre_v_px = row.centre_u_sd_px = row.centre_v_sd_px = kNotMeasured;
  row.dx_rot_y_corr = row.dy_rot_x_corr = kNotMeasured;
}

void doubt_motion(TrackRow& row, const TrackRow& next) {
  if (!row.motion_ok || !row.circle_ok || !next.circle_ok) return;
  row.dx_sd_px = std::max(row.dx_sd_px, std::hypot(row.cx_sd_px, next.cx_sd_px));
  row.dy_sd_px = std::max(row.dy_sd_px, std::hypot(row.cy_sd_px, next.cy_sd_px));
}

void compare_with_circles(TrackRow& row, const TrackRow& next) {
  constexpr double kChance = 6, kLeast_px = 0.1;
  if (row.status != TrackStatus::kOk || !row.motion_ok || !next.circle_ok) return;
  const auto differ = [](double motion, double motion_sd, double step, double sd, double next_sd) {
    const double off = std::abs(motion - step);
    return off > kLeast_px && off > kChance * std::hypot(motion_sd, sd, next_sd);
  };
  if (differ(row.dx_px, row.dx_sd_px, next.cx_px - row.cx_px, row.cx_sd_px, next.cx_sd_px) ||
      differ(row.dy_px, row.dy_sd_px, next.cy_px - row.cy_px, row.cy_sd_px, next.cy_sd_px)) {
    row.status = TrackStatus::kInconsistent;
  }
}

void compare_with_path(std::span<TrackRow> rows) {
  constexpr std::size_t kFewest = 3, kMost = 8;
  std::vector<std::size_t> wrong;
  for (std::size_t first = 0; first < rows.size(); ++first) {
    std::size_t last = first;
    while (last + 1 < rows.size() && last < first + kMost && is_part_of_path(rows[last])) ++last;
    if (last < first + kFewest || !rows[last].circle_ok) continue;
    if (!leads_elsewhere(rows, first, last)) continue;
    for (std::size_t i = first; i < last; ++i) wrong.push_back(i);
  }
  for (const std::size_t i : wrong) rows[i].status = TrackStatus::kInconsistent;
}

}  // namespace impactdic::pipeline
