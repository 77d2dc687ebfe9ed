#include "host/run/metres/noise_floor.h"

#include <algorithm>
#include <cmath>

namespace impactdic::run {
namespace {

constexpr int kFewestFrames = 3, kMostFrames = 1000;
constexpr std::size_t kFewestWindows = 3;
// A scene that moves by more in all is none that is still.
constexpr double kStill_px = 0.1;
// A frame moves where it lies farther off those before than this and chance.
constexpr double kStep_px = 0.01, kFloorChance = 5;
// So many times the variance over the windows of the frames before, and chance: the scene deforms.
constexpr double kDeforms = 1.5;
// Mean square of the slopes over time, over what chance makes it: the scene creeps.
constexpr double kCreeps = 4;

bool is_ok(const WindowMotion& motion) {
  return motion.status == static_cast<std::int32_t>(WindowStatus::kOk);
}

struct Spread {
  std::size_t windows = 0;
  double u = 0, v = 0;                // mean
  double u_var = 0, v_var = 0;        // about it
  double u_stated = 0, v_stated = 0;  // mean square of the stated deviations
};

Spread over_windows(std::span<const WindowMotion> field) {
  Spread s;
  for (const WindowMotion& motion : field) {
    if (!is_ok(motion)) continue;
    ++s.windows;
    s.u += motion.u, s.v += motion.v;
    s.u_stated += static_cast<double>(motion.u_sd) * motion.u_sd;
    s.v_stated += static_cast<double>(motion.v_sd) * motion.v_sd;
  }
  if (s.windows < kFewestWindows) return {};
  const auto count = static_cast<double>(s.windows);
  s.u /= count, s.v /= count, s.u_stated /= count, s.v_stated /= count;
  for (const WindowMotion& motion : field) {
    if (!is_ok(motion)) continue;
    s.u_var += (motion.u - s.u) * (motion.u - s.u) / (count - 1);
    s.v_var += (motion.v - s.v) * (motion.v - s.v) / (count - 1);
  }
  return s;
}

// Sum of (t - mean)^2 of t = 1 … frames.
double spread_of_time(int frames) {
  return frames * (static_cast<double>(frames) * frames - 1) / 12;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double scatter(const std::vector<double>& values) {
  if (values.size() < 3) return 0;
  const double middle = mean(values);
  double squares = 0;
  for (const double value : values) squares += (value - middle) * (value - middle);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

bool lies_apart(const std::vector<double>& before, double now, double sd) {
  if (before.empty()) return false;
  return std::abs(now - mean(before)) > kStep_px + kFloorChance * std::max(sd, scatter(before));
}

}  // namespace

void StillFrames::Series::add(double measured, bool from_first, int frame) {
  now = from_first ? measured : now + measured;
  sum += measured, squares += measured * measured;
  place += now, place_squares += now * now, drift += frame * now;
}

double StillFrames::Series::variance(int frames) const {
  return std::max(0.0, (squares - sum * sum / frames) / (frames - 1));
}

double StillFrames::Series::slope_squared(int frames) const {
  const double along = drift - place * (frames + 1) / 2.0;
  return along * along / spread_of_time(frames);
}

double StillFrames::Series::variance_about_line(int frames) const {
  const double all = place_squares - place * place / frames;
  return std::max(0.0, (all - slope_squared(frames)) / (frames - 2));
}

bool StillFrames::is_still(const MotionRow& row, double spatial_variance,
                           std::size_t windows) const {
  if (!row.motion_ok || row.status != TrackStatus::kOk) return false;
  const bool first = reference_ == ReferenceFrame::kFirst;
  const double x = row.dx_px + (first || x_.empty() ? 0.0 : x_.back());
  const double y = row.dy_px + (first || y_.empty() ? 0.0 : y_.back());
  const double turn = (row.rot_deg + (first ? 0.0 : rot_deg_)) * kRadPerDeg * reach_px_;
  if (std::hypot(x, y) > kStill_px || std::abs(turn) > kStill_px) return false;
  if (lies_apart(x_, x, row.dx_sd_px) || lies_apart(y_, y, row.dy_sd_px)) return false;
  const double allowed = kDeforms + kFloorChance * std::sqrt(2.0 / static_cast<double>(windows));
  return frames_ == 0 || spatial_variance < allowed * (spatial_u_ + spatial_v_) / frames_;
}

void StillFrames::add(const MotionRow& row, std::span<const WindowMotion> field) {
  if (ended_) return;
  if (row.is_reference) {
    found_.first_frame = found_.last_frame = row.frame;
    return;
  }
  const Spread spread = over_windows(field);
  if (frames_ >= kMostFrames || spread.windows == 0 ||
      !is_still(row, spread.u_var + spread.v_var, spread.windows)) {
    ended_ = true;
    return;
  }
  const bool first = reference_ == ReferenceFrame::kFirst;
  x_.push_back(row.dx_px + (first || x_.empty() ? 0.0 : x_.back()));
  y_.push_back(row.dy_px + (first || y_.empty() ? 0.0 : y_.back()));
  rot_deg_ = row.rot_deg + (first ? 0.0 : rot_deg_);
  spatial_u_ += spread.u_var, spatial_v_ += spread.v_var;
  stated_u_ += spread.u_stated, stated_v_ += spread.v_stated;
  found_.last_frame = row.frame;
  ++frames_;
  windows_.resize(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!is_ok(field[i])) continue;
    AtWindow& window = windows_[i];
    ++window.frames;
    window.u.add(field[i].u, first, frames_);
    window.v.add(field[i].v, first, frames_);
  }
}

bool StillFrames::creeps() const {
  double slopes = 0, chance = 0;
  for (const AtWindow& window : windows_) {
    if (window.frames != frames_) continue;
    for (const Series* one : {&window.u, &window.v}) {
      slopes += one->slope_squared(frames_);
      chance += one->variance_about_line(frames_);
    }
  }
  return slopes > kCreeps * chance;
}

std::optional<NoiseFloor> StillFrames::floor() const {
  if (frames_ < kFewestFrames || creeps()) return std::nullopt;
  NoiseFloor floor = found_;
  floor.frames = frames_;
  double u_var = 0, v_var = 0;
  for (const AtWindow& window : windows_) {
    if (window.frames != frames_) continue;
    ++floor.windows;
    floor.u_mean += window.u.sum / frames_, floor.v_mean += window.v.sum / frames_;
    u_var += window.u.variance(frames_), v_var += window.v.variance(frames_);
  }
  if (floor.windows < kFewestWindows) return std::nullopt;
  const auto count = static_cast<double>(floor.windows);
  floor.u_mean /= count, floor.v_mean /= count;
  floor.u_temporal_sd = std::sqrt(u_var / count), floor.v_temporal_sd = std::sqrt(v_var / count);
  floor.u_spatial_sd = std::sqrt(spatial_u_ / frames_);
  floor.v_spatial_sd = std::sqrt(spatial_v_ / frames_);
  floor.u_stated_sd = std::sqrt(stated_u_ / frames_);
  floor.v_stated_sd = std::sqrt(stated_v_ / frames_);
  return floor;
}

}  // namespace impactdic::run
