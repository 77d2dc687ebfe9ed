#include "host/clip/ball_by_hand.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>

#include "host/base/parse.h"
#include "host/base/statistics.h"

namespace impactdic {
namespace {

constexpr char kOption[] = "--ball-at";
constexpr double kLeastRadius_px = 3;  // as of --radius-px

BallByHand read_one(const std::string& text) {
  const auto parts = split(text, ':');
  if (parts.size() != 2) {
    throw InvalidArgument("'" + text + "' is not FRAME:X,Y,R or FRAME:none", kOption);
  }
  BallByHand ball;
  ball.frame = parse_int(parts[0], kOption);
  if (parts[1] == "none") return ball;
  const std::vector<double> circle = parse_doubles(parts[1], ',', 3, kOption);
  ball.cx_px = circle[0];
  ball.cy_px = circle[1];
  ball.r_px = circle[2];
  if (ball.r_px == 0) {
    throw InvalidArgument("a circle needs a radius", kOption, "FRAME:none says that there is none");
  }
  return ball;
}

}  // namespace

std::vector<BallByHand> read_balls_by_hand(const std::string& text) {
  std::vector<BallByHand> balls;
  for (const std::string& one : split(text, '/')) balls.push_back(read_one(one));
  check_balls_by_hand(balls);
  return in_order(std::move(balls));
}

std::string to_text(const std::vector<BallByHand>& balls) {
  std::string text;
  for (const BallByHand& ball : balls) {
    text += (text.empty() ? "" : "/") + std::to_string(ball.frame) + ":";
    text += ball.r_px == 0
                ? std::string("none")
                : shortest(ball.cx_px) + "," + shortest(ball.cy_px) + "," + shortest(ball.r_px);
  }
  return text;
}

void check_balls_by_hand(const std::vector<BallByHand>& balls) {
  for (auto ball = balls.begin(); ball != balls.end(); ++ball) {
    const std::string frame = std::to_string(ball->frame);
    if (ball->frame < 0) throw InvalidArgument("there is no frame " + frame, kOption);
    if (!std::isfinite(ball->cx_px) || !std::isfinite(ball->cy_px) || !std::isfinite(ball->r_px) ||
        (ball->r_px != 0 && ball->r_px < kLeastRadius_px)) {
      throw InvalidArgument("the circle of frame " + frame + " needs a place and a radius of " +
                                shortest(kLeastRadius_px) + " px or more",
                            kOption);
    }
    const auto same = [&](const BallByHand& other) { return other.frame == ball->frame; };
    if (std::any_of(balls.begin(), ball, same)) {
      throw InvalidArgument("frame " + frame + " stands twice", kOption);
    }
  }
}

void check_balls_by_hand(const std::vector<BallByHand>& balls, const ClipInfo& clip) {
  for (const BallByHand& ball : balls) {
    const std::string frame = std::to_string(ball.frame);
    if (ball.frame >= clip.frame_count) {
      throw InvalidArgument("the clip has no frame " + frame, kOption);
    }
    const bool inside = ball.cx_px >= 0 && ball.cy_px >= 0 && ball.cx_px <= clip.width - 1 &&
                        ball.cy_px <= clip.height - 1;
    if (!inside) {
      throw InvalidArgument("the centre in frame " + frame + " is not in the picture", kOption);
    }
  }
}

std::vector<BallByHand> in_order(std::vector<BallByHand> balls) {
  std::stable_sort(balls.begin(), balls.end(),
                   [](const BallByHand& a, const BallByHand& b) { return a.frame < b.frame; });
  return balls;
}

std::vector<BallByHand> as_analysed(const std::vector<BallByHand>& balls, const FrameRange& frames,
                                    const Roi& roi) {
  std::vector<BallByHand> analysed;
  for (const BallByHand& ball : balls) {
    const std::int64_t ahead = ball.frame - frames.first;
    if (ahead < 0 || ball.frame >= frames.end || ahead % frames.step != 0) continue;
    analysed.push_back({ahead / frames.step, ball.cx_px - roi.x, ball.cy_px - roi.y, ball.r_px});
  }
  return in_order(std::move(analysed));
}

std::optional<double> radius_by_hand(std::optional<double> found_px,
                                     const std::vector<BallByHand>& balls) {
  constexpr double kSame = 0.2;  // of the radius
  std::vector<double> drawn;
  for (const BallByHand& ball : balls) {
    if (ball.r_px > 0) drawn.push_back(ball.r_px);
  }
  if (drawn.empty()) return found_px;
  const double drawn_px = upper_median(drawn);
  return found_px && std::abs(*found_px - drawn_px) < kSame * drawn_px ? *found_px : drawn_px;
}

std::optional<std::int64_t> first_difference(const std::vector<BallByHand>& one,
                                             const std::vector<BallByHand>& other) {
  const auto [at, there] = std::mismatch(one.begin(), one.end(), other.begin(), other.end());
  if (at == one.end() && there == other.end()) return std::nullopt;
  if (at == one.end()) return there->frame;
  return there == other.end() ? at->frame : std::min(at->frame, there->frame);
}

}  // namespace impactdic
