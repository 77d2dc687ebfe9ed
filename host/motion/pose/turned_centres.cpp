#include "host/motion/pose/turned_centres.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/motion/pose/body_motion.h"

namespace impactdic::motion {
namespace {

// Frames of which one is asked, and how many are at least.
constexpr std::size_t kApart = 16, kFewest = 3;
// Turned farther, too little is seen in both pictures; by less, a turn tells nothing.
constexpr double kFarthest_deg = 25, kNearest_deg = 2;
// By how much a circle may lie off the ball, share of the radius: circles have no part in what is
// told.
constexpr double kWide_of_r = 0.02;
// Foreshortened texture displaces pictures by more than noise does, and what light leaves of them
// errs alike over more of the ball than the blocks that are taken to be independent.
constexpr double kMoreThanNoise = 1.4, kMisfitCounts = 2;

// Frames that motions lead through, and the ball's poses in them: from the first one's.
struct Run {
  std::size_t first = 0;
  std::vector<BodyPose> poses;
};

BodyPose first_pose(const Circle& circle) {
  BodyPose pose;
  pose.ok = true;
  pose.x_px = circle.cx_px;
  pose.y_px = circle.cy_px;
  set_orientation(pose, Eigen::Quaterniond::Identity());
  return pose;
}

std::vector<Run> runs_of(std::span<const ChainedFrame> frames) {
  std::vector<Run> runs;
  bool led_on = false;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const ChainedFrame& frame = frames[i];
    if (!frame.circle_ok || frame.shape.is_compressed()) {
      led_on = false;
      continue;
    }
    if (led_on) {
      const ChainedFrame& last = frames[i - 1];
      runs.back().poses.push_back(moved(runs.back().poses.back(), last.circle, *last.next));
    } else {
      runs.push_back({i, {first_pose(frame.circle)}});
    }
    led_on = frame.next != nullptr && frame.next->ok;
  }
  return runs;
}

// The pose that is tilted farthest against that of `i`, within reach; `i` where none is far enough.
std::size_t farthest(const std::vector<BodyPose>& poses, std::size_t i) {
  std::size_t best = i;
  double most = kNearest_deg * kRadPerDeg;
  const auto look = [&](std::size_t k) {
    const double tilt = tilt_between(poses[i], poses[k]);
    if (tilt > kFarthest_deg * kRadPerDeg) return false;
    if (tilt > most) {
      most = tilt;
      best = k;
    }
    return true;
  };
  for (std::size_t k = i + 1; k < poses.size() && look(k); ++k) {
  }
  for (std::size_t k = i; k > 0 && look(k - 1); --k) {
  }
  return best;
}

bool is_good(const BallMotion& motion) {
  return motion.status == static_cast<idic_int>(WindowStatus::kOk) && motion.used > kLeastSeen;
}

}  // namespace

dic::BallOptions TurnedCentres::with_free_centre(dic::BallOptions body) {
  body.free_centre = true;
  return body;
}

std::vector<TurnedCentre> TurnedCentres::measure(std::span<const ChainedFrame> frames) {
  std::vector<std::size_t> asked;  // each with two tasks: the next frame, and one far away
  std::vector<BallTask> tasks;
  const auto add = [&](const Run& run, std::size_t i, std::size_t to) {
    const ChainedFrame &from = frames[run.first + i], &other = frames[run.first + to];
    Keyframe key;
    static_cast<BodyPose&>(key.pose) = run.poses[i];
    key.circle = from.circle;
    key.shape = from.shape;
    BallTask task = aim_.task_of(other, run.poses[to], key);
    task.first = from.slot;
    task.second = other.slot;
    task.centre_sd = static_cast<float>(kWide_of_r * aim_.radius_px());
    tasks.push_back(task);
  };
  for (const Run& run : runs_of(frames)) {
    const std::size_t count = run.poses.size(), looks = std::max(kFewest, count / kApart);
    for (std::size_t k = 0; k < looks && count > kFewest; ++k) {
      const std::size_t i = k * (count - 1) / looks, far = farthest(run.poses, i);
      if (far == i) continue;
      asked.push_back(run.first + i);
      add(run, i, i + 1);
      add(run, i, far);
    }
  }
  if (asked.empty()) return {};
  const std::vector<BallMotion> motions = free_.measure(frames_, tasks);
  std::vector<TurnedCentre> told;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const BallMotion &next = motions[2 * k], &far = motions[2 * k + 1];
    if (!is_good(next) || !is_good(far) || !(next.residual > 0)) continue;
    const double misfit = std::max(0.0, std::pow(far.residual / next.residual, 2) - 1);
    const double more = kMoreThanNoise * std::sqrt(1 + kMisfitCounts * misfit);
    told.push_back({asked[k], tasks[2 * k + 1].cx - far.cx, tasks[2 * k + 1].cy - far.cy,
                    more * far.cx_sd, more * far.cy_sd});
  }
  return told;
}

}  // namespace impactdic::motion
