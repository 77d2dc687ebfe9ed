#include "host/advice/still_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/dic/sphere/rotation.h"

namespace impactdic::advice {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

// Frames about a pair, fewest of which must show the ball at a pixel; way of the rim between the
// first and the last, px: what is wanted, and the least that tells.
constexpr int kViews = 8, kFewestViews = 5;
constexpr double kWay_px = 6, kLeastWay_px = 1.5;
// The rim's own edge does not count, nor does what circles are off by.
constexpr double kRim_px = 5;
// Where the ball lies elsewhere than it would if it went on, it did not.
constexpr double kOff_px = 1, kOffOfWay = 0.2;
// An edge carried on changes a pixel by so many deviations of the noise, rms, and as if by so many
// px, rms, at most: then another part of the texture follows.
constexpr double kChanges = 3, kMostWay_px = 0.7;
// One that stands still leaves the noise, by this many of its variance's deviations more at most.
constexpr double kChance = 2;
// Of 3 x 3 pixels, those that must stand still; how far an edge's blur reaches.
constexpr int kTogether = 3, kBlur_px = 3;
// The cosine of the angle by which an edge turns from pixel to pixel at most.
constexpr double kStraight = 0.97;
// Pixels, and of all that would change, the share above which it is the ball that stands still.
constexpr int kLeastPixels = 40;
constexpr double kMostShare = 0.6;

// The ball in one frame: how far its material has moved since the pair's first frame.
struct View {
  BallPicture seen;
  Eigen::Matrix3d turn;
  Vector2d centre, first_centre;
  double radius_px = 0;

  bool shows(int x, int y) const {
    return (Vector2d(x, y) - centre).norm() < seen.ball.r_px - kRim_px;
  }
  // Of the material that is at (x, y) in the first frame.
  Vector2d moved(int x, int y) const {
    const Vector2d off = Vector2d(x, y) - first_centre;
    const double depth = std::sqrt(std::max(radius_px * radius_px - off.squaredNorm(), 0.0));
    const Vector3d to = turn * Vector3d(off.x(), -off.y(), depth);  // y up
    return centre + Vector2d(to.x(), -to.y()) - Vector2d(x, y);
  }
};

float level(const Frame& frame, int x, int y) {
  return frame.type == PixelType::kU8 ? static_cast<float>(frame.u8(x, y))
                                      : static_cast<float>(frame.u16(x, y));
}

// Frames about the pair's first one.
std::vector<View> views_about(const MovedBall& ball, const FarFrames& frames) {
  const BallPair& pair = *ball.pair;
  const dic::RigidMotion& step = ball.step;
  const Vector3d turn(step.rot_x_rad, step.rot_y_rad, step.rot_rad);
  const Vector2d shift(step.dx_px, step.dy_px);
  const double by_step_px = shift.norm() + turn.norm() * pair.first_ball.r_px;
  if (!(by_step_px > 0)) return {};
  const auto most = static_cast<double>((frames.count - 1) / (kViews - 1));
  const double wanted = std::ceil(kWay_px / (by_step_px * (kViews - 1)));
  const auto apart = static_cast<std::int64_t>(std::clamp(wanted, 1.0, std::max(most, 1.0)));
  const std::int64_t last = apart * (kViews - 1);
  const std::int64_t first = std::clamp<std::int64_t>(pair.index - last / 2, 0,
                                                      std::max<std::int64_t>(0, frames.count - 1 - last));
  std::vector<View> views;
  for (int k = 0; k < kViews; ++k) {
    const std::int64_t index = first + k * apart;
    if (index >= frames.count) break;
    const auto steps = static_cast<double>(index - pair.index);
    Circle near = pair.first_ball;
    near.cx_px += steps * shift.x();
    near.cy_px += steps * shift.y();
    auto found = frames.find(index, near);
    if (!found) continue;
    const Vector2d centre(found->ball.cx_px, found->ball.cy_px);
    const double off_px = (centre - Vector2d(near.cx_px, near.cy_px)).norm();
    if (off_px > kOff_px + kOffOfWay * std::abs(steps) * shift.norm()) continue;
    views.push_back({std::move(*found), dic::quaternion_of(steps * turn).toRotationMatrix(), centre,
                     {pair.first_ball.cx_px, pair.first_ball.cy_px}, pair.first_ball.r_px});
  }
  if (std::getenv("STILL_DEBUG")) std::fprintf(stderr, "pair %d apart %d views %zu step %.3f %.3f %.5f by %.3f\n", int(pair.index), int(apart), views.size(), shift.x(), shift.y(), turn.z(), by_step_px);
  const double way_px = static_cast<double>(last) * by_step_px;
  if (static_cast<int>(views.size()) < kFewestViews || way_px < kLeastWay_px) return {};
  return views;
}

// The pixels that show the ball in frames enough, and what they do from frame to frame.
class Stack {
 public:
  explicit Stack(const std::vector<View>& views)
      : views_(views),
        width_(views.front().seen.picture.width()),
        height_(views.front().seen.picture.height()),
        mean_(width_, height_, kNone),
        variance_(width_, height_, 0) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) sum(x, y);
    }
  }
  int width() const { return width_; }
  int height() const { return height_; }
  float mean(int x, int y) const { return mean_(x, y); }

  // What a pixel shows of an edge that the ball may carry on.
  struct Edge {
    Vector2d slope{0, 0};  // of the mean picture; 0 where it is hardly one
    bool would_change = false;
    bool stays = false;
  };
  Edge edge(int x, int y, double noise) const {
    Edge edge;
    if (x < 1 || y < 1 || x + 1 >= width_ || y + 1 >= height_) return edge;
    const float left = mean_(x - 1, y), right = mean_(x + 1, y);
    const float above = mean_(x, y - 1), below = mean_(x, y + 1);
    if (std::min({left, right, above, below, mean_(x, y)}) == kNone) return edge;
    const Vector2d slope(0.5 * (right - left), 0.5 * (below - above));
    const double least = kChanges * noise, most = kMostWay_px * slope.norm();
    if (most < least) return edge;
    double sum = 0, squares = 0, count = 0;
    for (const View& view : views_) {
      if (!view.shows(x, y)) continue;
      const double by = slope.dot(view.moved(x, y));
      sum += by;
      squares += by * by;
      ++count;
    }
    const double expected = std::min((squares - sum * sum / count) / (count - 1), most * most);
    edge.slope = slope;
    edge.would_change = expected > least * least;
    edge.stays = variance_(x, y) < noise * noise * (1 + kChance * std::sqrt(2 / (count - 1)));
    return edge;
  }

 private:
  static constexpr float kNone = -1;

  void sum(int x, int y) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const View& view : views_) {
      if (!view.shows(x, y)) continue;
      const double value = level(view.seen.picture, x, y);
      sum += value;
      squares += value * value;
      ++count;
    }
    if (count < kFewestViews) return;
    mean_(x, y) = static_cast<float>(sum / count);
    variance_(x, y) = static_cast<float>((squares - sum * sum / count) / (count - 1));
  }

  const std::vector<View>& views_;
  int width_, height_;
  Image<float> mean_, variance_;
};

// The edges about one pair that stand still.
class StillEdges {
 public:
  StillEdges(const Stack& stack, double noise)
      : width_(stack.width()), height_(stack.height()), still_(width_, height_, 0) {
    edges_.reserve(still_.size());
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const Stack::Edge& edge = edges_.emplace_back(stack.edge(x, y, noise));
        change_ += edge.would_change;
        if (edge.would_change && edge.stays) begins_.push_back(y * width_ + x);
      }
    }
  }
  // Or it is the ball that stands still.
  bool are_told() const {
    const auto count = static_cast<int>(begins_.size());
    return count >= kLeastPixels && count < kMostShare * change_;
  }
  void take_out_of(Image<std::uint8_t>& moving) {
    for (const int begin : begins_) {
      if (together(begin) >= kTogether) follow(begin);
    }
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (still_(x, y) != 0) blank_about(x, y, moving);
      }
    }
  }

 private:
  template <typename Use>
  void for_each_beside(int at, const Use& use) const {
    const int x = at % width_, y = at / width_;
    for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) use(v * width_ + u);
    }
  }
  int together(int at) const {
    int count = 0;
    for_each_beside(at, [&](int other) {
      const Stack::Edge& edge = edges_[static_cast<std::size_t>(other)];
      count += edge.would_change && edge.stays;
    });
    return count;
  }
  // On along the edge, where the ball would hardly move it too.
  void follow(int begin) {
    std::vector<int> open = {begin};
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      if (std::uint8_t& seen = still_.data()[at]; seen != 0) continue;
      else seen = 1;
      const Vector2d along = edges_[static_cast<std::size_t>(at)].slope.normalized();
      for_each_beside(at, [&](int next) {
        const Stack::Edge& edge = edges_[static_cast<std::size_t>(next)];
        if (edge.stays && still_.data()[next] == 0 &&
            edge.slope.normalized().dot(along) > kStraight) {
          open.push_back(next);
        }
      });
    }
  }
  void blank_about(int x, int y, Image<std::uint8_t>& moving) const {
    for (int v = std::max(0, y - kBlur_px); v <= std::min(height_ - 1, y + kBlur_px); ++v) {
      for (int u = std::max(0, x - kBlur_px); u <= std::min(width_ - 1, x + kBlur_px); ++u) {
        moving(u, v) = 0;
      }
    }
  }

  int width_, height_;
  std::vector<Stack::Edge> edges_;
  std::vector<int> begins_;  // that the ball would carry on
  int change_ = 0;           // edges that it would
  Image<std::uint8_t> still_;
};

}  // namespace

std::shared_ptr<const Image<std::uint8_t>> still_edges(std::span<const MovedBall> balls,
                                                       double noise, const FarFrames& frames) {
  std::shared_ptr<Image<std::uint8_t>> moving;
  for (const MovedBall& ball : balls) {
    const std::vector<View> views = views_about(ball, frames);
    if (views.empty()) continue;
    const Stack stack(views);
    StillEdges edges(stack, noise);
    if (std::getenv("STILL_DEBUG")) std::fprintf(stderr, "told %d\n", int(edges.are_told()));
    if (!edges.are_told()) continue;
    if (!moving) {
      moving = std::make_shared<Image<std::uint8_t>>(stack.width(), stack.height(), 255);
    }
    edges.take_out_of(*moving);
    if (std::getenv("STILL_DEBUG")) { FILE* f = std::fopen("/tmp/still.pgm", "wb"); std::fprintf(f, "P5 %d %d 255\n", stack.width(), stack.height()); for (int y = 0; y < stack.height(); ++y) for (int x = 0; x < stack.width(); ++x) std::fputc((*moving)(x,y)?(int)std::max(0.f, stack.mean(x,y)):255, f); std::fclose(f);}
  }
  return moving;
}

}  // namespace impactdic::advice
