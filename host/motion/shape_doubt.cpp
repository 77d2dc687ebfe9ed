#include "host/motion/shape_doubt.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace impactdic::motion {
namespace {

bool is_ok(const BallMotion& motion) {
  return motion.status == static_cast<idic_int>(WindowStatus::kOk);
}

BallTask as_round(BallTask task) {
  std::fill(std::begin(task.sight.first), std::end(task.sight.first), 0.0F);
  std::fill(std::begin(task.sight.second), std::end(task.sight.second), 0.0F);
  return task;
}

// From where a registration ended.
BallTask from(BallTask task, const BallMotion& motion) {
  task.guess_dx = motion.dx;
  task.guess_dy = motion.dy;
  task.guess_rot_x_rad = motion.rot_x_rad;
  task.guess_rot_y_rad = motion.rot_y_rad;
  task.guess_rot_rad = motion.rot_rad;
  return task;
}

bool is_round(const BallTask& task) {
  const auto is_none = [](float stretch) { return stretch == 0; };
  return std::all_of(std::begin(task.sight.first), std::end(task.sight.first), is_none) &&
         std::all_of(std::begin(task.sight.second), std::end(task.sight.second), is_none);
}

void add_difference(const BallMotion& other, BallMotion& motion, const BallMotion& before) {
  const float by[5] = {other.dx - before.dx, other.dy - before.dy,
                       other.rot_x_rad - before.rot_x_rad, other.rot_y_rad - before.rot_y_rad,
                       other.rot_rad - before.rot_rad};
  for (int i = 0, at = 0; i < 5; ++i) {
    for (int j = 0; j <= i; ++j) motion.covariance[at++] += by[i] * by[j];
  }
}

// The pairs that fit better as round balls become such, and the covariance gets what the two differ
// by: pictures of a ball that is pressed alike in both fit about as well, and tell another turn.
// Returns the others.
std::vector<const ShapedPair*> keep_shaped(dic::BallRegistration& registration,
                                           dic::DeviceFrames& frames,
                                           std::span<const ShapedPair> pairs) {
  std::vector<BallTask> tasks;
  std::vector<const ShapedPair*> of, shaped;
  for (const ShapedPair& pair : pairs) {
    if (is_round(pair.task)) {
      if (is_ok(*pair.motion)) shaped.push_back(&pair);
      continue;
    }
    tasks.push_back(as_round(pair.task));
    of.push_back(&pair);
  }
  std::vector<BallMotion> round;
  if (!tasks.empty()) round = registration.measure(frames, tasks);
  for (std::size_t k = 0; k < round.size(); ++k) {
    BallMotion& motion = *of[k]->motion;
    if (is_ok(round[k]) && !(is_ok(motion) && motion.residual < round[k].residual)) {
      const BallMotion as_shaped = motion;
      motion = round[k];
      if (is_ok(as_shaped)) add_difference(as_shaped, motion, round[k]);
    } else if (is_ok(motion)) {
      shaped.push_back(of[k]);
    }
  }
  return shaped;
}

// The stretch of a picture, xx, xy, yy, changed by e1, e2 or the size.
constexpr int kFigures = 3;
void change(int figure, double by, float* stretch) {
  const auto more = static_cast<float>(by);
  if (figure == 1) {
    stretch[1] += more;
    return;
  }
  stretch[0] += more;
  stretch[2] += figure == 0 ? -more : more;
}

// By how much the stretch of each picture is changed at once.
struct Change {
  double first = 0, second = 0;
};
std::array<Change, 2> changes(const std::array<BallShape, 2>& shapes, int figure) {
  constexpr double kApart = 0.15;  // of a shape that both hide, from a frame to the next
  const auto sd = [&](const BallShape& shape) { return figure == 2 ? shape.size_sd : shape.sd; };
  const double first = sd(shapes[0]), second = sd(shapes[1]);
  if (!hides_shape(shapes[0]) || !hides_shape(shapes[1])) return {{{first, 0}, {0, second}}};
  const double both = std::sqrt((first * first + second * second) / 2);
  return {{{both, both}, {0, kApart * both}}};
}

}  // namespace

void doubt_shapes(dic::BallRegistration& registration, dic::DeviceFrames& frames,
                  std::span<const ShapedPair> pairs) {
  if (pairs.empty()) return;
  std::vector<BallTask> tasks;
  std::vector<BallMotion*> of;
  for (const ShapedPair* pair : keep_shaped(registration, frames, pairs)) {
    for (int figure = 0; figure < kFigures; ++figure) {
      for (const Change& by : changes(pair->shapes, figure)) {
        BallTask task = from(pair->task, *pair->motion);
        change(figure, by.first, task.sight.first);
        change(figure, by.second, task.sight.second);
        tasks.push_back(task);
        of.push_back(pair->motion);
      }
    }
  }
  if (tasks.empty()) return;
  const std::vector<BallMotion> others = registration.measure(frames, tasks);
  const BallMotion* last = nullptr;
  BallMotion before{};
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (of[k] != last) before = *(last = of[k]);
    if (is_ok(others[k])) add_difference(others[k], *of[k], before);
  }
}

}  // namespace impactdic::motion
