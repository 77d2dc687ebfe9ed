// Tracks of clips in real light, by the same run as a clip's file, held against their exact truth.
#pragma once

#include <impactdic/track.h>
#include <impactdic/units.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/light_scenes.h"

namespace impactdic::testing {

struct LightFilm {
  LightScene scene;
  std::vector<Frame> frames;
  std::vector<BallPose> poses;
  ClipInfo info;

  LightFilm(const LightScene& how, std::uint64_t seed, int count)
      : LightFilm(how, seed, count, 0, static_cast<std::size_t>(count)) {}
  // Frames first … last - 1 alone; the others are empty.
  LightFilm(const LightScene& how, std::uint64_t seed, int count, std::size_t first,
            std::size_t last)
      : scene(how) {
    LightClip clip(scene, seed, count);
    frames.resize(static_cast<std::size_t>(count));
    for (std::size_t k = first; k < last; ++k) clip.render(k, frames[k]);
    poses = clip.poses();
    info.width = clip.width();
    info.height = clip.height();
    info.bits = 8;
    info.format = "memory";
    info.frame_count = count;
    info.fps = 1000;
  }
  // Reads this; it must outlive the clip.
  std::shared_ptr<FrameSource> source() const {
    return clip_from_callback(info, [this](std::int64_t index, Frame& frame) {
      frame = frames.at(static_cast<std::size_t>(index));
    });
  }
};

// Of the circles and the motions that were measured: the rms error an axis, the same over the
// stated deviations, and how many err by more than five deviations and 0.02 px, at the rim where
// they are turns.
struct LightErrors {
  struct Axis {
    double sum = 0, squares = 0, over_sd = 0;
    int count = 0;
    void add(double off, double sd) {
      sum += off;
      squares += off * off;
      over_sd += off * off / (sd * sd);
      ++count;
    }
    void add(const Axis& other) {
      sum += other.sum;
      squares += other.squares;
      over_sd += other.over_sd;
      count += other.count;
    }
    double mean() const { return sum / count; }
    double rms() const { return std::sqrt(squares / count); }
    double over_sds() const { return std::sqrt(over_sd / count); }
  };
  Axis centre, radius, shift, turn;
  Axis tilt;  // of spheres, about X and Y
  Axis pose;  // of discs, their angle since the first frame
  int circles = 0, motions = 0, wrong = 0;

  void add(const TrackRow& row, const LightFilm& clip) {
    const auto k = static_cast<std::size_t>(row.frame);
    const BallPose& truth = clip.poses[k];
    if (row.circle_ok) {
      ++circles;
      add(centre, row.cx_px - truth.cx_px, row.cx_sd_px);
      add(centre, row.cy_px - truth.cy_px, row.cy_sd_px);
      add(radius, row.r_px - clip.scene.radius_px * (1 - truth.compression / 2), row.r_sd_px);
    }
    if (row.pose.ok && row.pose.origin < row.frame && std::isfinite(row.pose.angle_rad)) {
      const double turned_deg =
          truth.angle_deg - clip.poses[static_cast<std::size_t>(row.pose.origin)].angle_deg;
      pose.add(row.pose.angle_rad * kDegPerRad - turned_deg, row.pose.angle_sd_rad * kDegPerRad);
    }
    if (!row.motion_ok || k + 1 == clip.poses.size()) return;
    ++motions;
    const BallPose& next = clip.poses[k + 1];
    add(shift, row.dx_px - (next.cx_px - truth.cx_px), row.dx_sd_px);
    add(shift, row.dy_px - (next.cy_px - truth.cy_px), row.dy_sd_px);
    const double matters_deg = kMatters_px / clip.scene.radius_px * kDegPerRad;
    add(turn, row.rot_deg - clip.scene.rotation_deg, row.rot_sd_deg, matters_deg);
    if (!clip.scene.sphere || !std::isfinite(row.rot_x_deg)) return;
    add(tilt, row.rot_x_deg - clip.scene.spin_x_deg, row.rot_x_sd_deg, matters_deg);
    add(tilt, row.rot_y_deg - clip.scene.spin_y_deg, row.rot_y_sd_deg, matters_deg);
  }
  void add(const LightErrors& other) {
    centre.add(other.centre);
    radius.add(other.radius);
    shift.add(other.shift);
    turn.add(other.turn);
    tilt.add(other.tilt);
    pose.add(other.pose);
    circles += other.circles;
    motions += other.motions;
    wrong += other.wrong;
  }

 private:
  static constexpr double kMatters_px = 0.02;
  void add(Axis& axis, double off, double sd, double matters = kMatters_px) {
    axis.add(off, sd);
    wrong += !(std::abs(off) <= matters || std::abs(off) <= 5 * sd);
  }
};

// A clip's rows, its ball looked for within a sixth of its radius, or whatever its size.
inline TrackResult track(const LightFilm& clip, bool with_field = true, bool size_told = true,
                         Estimator estimator = Estimator::kBall) {
  TrackRequest request;
  request.estimator = estimator;
  request.clip.source = clip.source();
  request.with_field = with_field;
  request.body = clip.scene.sphere ? Body::kSphere : Body::kDisc;
  if (size_told) request.radius_px = {clip.scene.radius_px * 5 / 6, clip.scene.radius_px * 7 / 6};
  Session session;
  return track(request, session);
}

inline LightErrors errors_of(const TrackResult& result, const LightFilm& clip) {
  LightErrors errors;
  for (const TrackRow& row : result.rows) errors.add(row, clip);
  return errors;
}

}  // namespace impactdic::testing
