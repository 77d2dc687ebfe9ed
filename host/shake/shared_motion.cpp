#include "host/shake/shared_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "host/shake/camera_motion.h"

namespace impactdic::shake {
namespace {

constexpr double kPlain = 4;              // deviations of a bend
constexpr std::size_t kFewestFrames = 8;  // that tell
constexpr double kMuchEvener = 0.4;       // of bends as the pictures show them
constexpr double kMostlyFree = 0.25;      // a contact bends the ball's path, too, for a part of it

// How far a path is bent about row `i`: the way to the row `lag` on, less the way from that before.
struct Bend {
  double x = 0, y = 0;
  double size() const { return std::hypot(x, y); }
};

// Of the background's path, where it is plain.
std::optional<Bend> background_bend(const CameraMotion& motion, std::size_t i, std::size_t lag) {
  const PictureShift &before = motion.of_rows[i - lag], &here = motion.of_rows[i],
                     &behind = motion.of_rows[i + lag];
  if (!before.known || !here.known || !behind.known) return std::nullopt;
  const Bend bend = {before.x_px - 2 * here.x_px + behind.x_px,
                     before.y_px - 2 * here.y_px + behind.y_px};
  const double sd = std::sqrt(6.0) * std::hypot(here.x_sd_px, here.y_sd_px);
  if (!(bend.size() > kPlain * sd)) return std::nullopt;
  return bend;
}

std::optional<Bend> ball_bend(const TrackRows& rows, std::size_t i, std::size_t lag) {
  Bend bend;
  for (std::size_t k = i - lag; k < i + lag; ++k) {
    const TrackRow row = rows[k];
    if (!row.motion_ok) return std::nullopt;
    const double sign = k < i ? -1 : 1;
    bend.x += sign * row.dx_px, bend.y += sign * row.dy_px;
  }
  return bend;
}

// By how much the bends of the free ball are less as the pictures show them than against the
// background, in proportion; 1 where too few frames tell.
double evener_as_shown(const CameraMotion& motion, const TrackRows& rows, std::size_t lag) {
  std::vector<double> as_shown, against_background;
  for (std::size_t i = lag; i + lag < rows.size(); ++i) {
    const std::optional<Bend> background = background_bend(motion, i, lag);
    const std::optional<Bend> ball = background ? ball_bend(rows, i, lag) : std::nullopt;
    if (!ball) continue;
    as_shown.push_back(ball->size());
    against_background.push_back(std::hypot(ball->x - background->x, ball->y - background->y));
  }
  if (as_shown.size() < kFewestFrames) return 1;
  const auto rank = static_cast<std::ptrdiff_t>(kMostlyFree * static_cast<double>(as_shown.size()));
  for (std::vector<double>* bends : {&as_shown, &against_background}) {
    std::nth_element(bends->begin(), bends->begin() + rank, bends->end());
  }
  return as_shown[static_cast<std::size_t>(rank)] /
         std::max(against_background[static_cast<std::size_t>(rank)], 1e-9);
}

}  // namespace

bool moves_with_ball(const CameraMotion& motion, const TrackRows& rows) {
  double least = 1, most = 1;
  for (const std::size_t lag : {1, 2, 4, 8}) {
    const double evener = evener_as_shown(motion, rows, lag);
    least = std::min(least, evener), most = std::max(most, evener);
  }
  return least > kMuchEvener || most > 1 / kMuchEvener;
}

std::string by_itself_in_words(const CameraMotion& motion) {
  const MotionExtent extent = extent_of(motion);
  char text[240];
  std::snprintf(text, sizeof text,
                "what lies behind the ball moves, by up to %.2f px, and the ball in flight does "
                "not move with it: a surface that gives way, and no camera that shakes",
                extent.farthest_px);
  return text;
}

}  // namespace impactdic::shake
