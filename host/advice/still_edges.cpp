#include "host/advice/still_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "host/advice/frames/frame_floats.h"
#include "host/base/parallel/parallel_for.h"
#include "host/dic/sphere/rotation.h"

namespace impactdic::advice {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

// Chosen on a dozen clips of discs behind bars, drawn at random (docs/accuracy/light.md).

// Frames about a ball's, fewest of which must show the ball at a pixel; way of the rim between the
// first and the last, px: what is wanted, and the least that tells.
constexpr int kViews = 12, kFewestViews = 5;
constexpr double kWay_px = 6, kLeastWay_px = 1.5;
// The rim's own edge does not count, nor does what circles are off by.
constexpr double kRim_px = 5;
// An edge carried on changes a pixel by so many deviations of the noise, rms, and as if by so many
// px, rms, at most: then another part of the texture follows.
constexpr double kChanges = 2.2, kMostWay_px = 0.7;
// One that stands still leaves the noise, by this many of its variance's deviations more at most.
constexpr double kChance = 2;
// Of 3 x 3 pixels, those that must stand still; how far an edge's blur reaches.
constexpr int kTogether = 3, kBlur_px = 3;
// The cosine of the angle by which an edge turns from pixel to pixel at most.
constexpr float kStraight = 0.97F;
// Longest gap in a straight edge over which it is believed to go on.
constexpr int kMostGap_px = 32;
// Pixels, and of all that would change, the share above which it is the ball that stands still.
constexpr std::size_t kLeastPixels = 20;
constexpr double kMostShare = 0.6;

// Share of a ball that edges have to leave.
constexpr double kLeastLeft = 0.35;

// What is left of the noise of a picture that was smoothed by a Gaussian of 1 px, so that edges
// show that hardly pass the noise.
constexpr double kSmoothedNoise = 0.28;

// The ball in one frame if it has moved as it does from frame to frame: where its centre is, and
// how its material has turned and moved since the one that is looked about.
struct TexturedView {
  cv::Mat levels;  // of the frames' common part, smoothed
  Eigen::Matrix3d turn;
  Vector2d centre;
};

// About a ball's frame.
class ViewsAbout {
 public:
  ViewsAbout(const MovedBall& ball, const FarFrames& frames)
      : first_(ball.ball),
        turn_(ball.step.rot_x_rad, ball.step.rot_y_rad, ball.step.rot_rad),
        shift_(ball.step.dx_px, ball.step.dy_px) {
    const double by_step_px = shift_.norm() + turn_.norm() * first_.r_px;
    if (!(by_step_px > 0)) return;
    const std::int64_t most = std::max<std::int64_t>((frames.count - 1) / (kViews - 1), 1);
    const double wanted = std::ceil(kWay_px / (by_step_px * (kViews - 1)));
    const auto apart =
        static_cast<std::int64_t>(std::clamp(wanted, 1.0, static_cast<double>(most)));
    const std::int64_t way = std::min(apart * (kViews - 1), frames.count - 1);
    if (static_cast<double>(way) * by_step_px < kLeastWay_px) return;
    const std::int64_t start =
        std::clamp<std::int64_t>(ball.index - way / 2, 0, frames.count - 1 - way);
    set_part({frames.width, frames.height}, start - ball.index, start + way - ball.index);
    for (std::int64_t index = start; index <= start + way && part_.area() > 0; index += apart) {
      add(index - ball.index, frames.picture(index));
    }
  }
  bool are_enough() const { return static_cast<int>(all_.size()) >= kFewestViews; }
  const std::vector<TexturedView>& all() const { return all_; }
  const cv::Rect& part() const { return part_; }  // of the pictures, in which the ball shows
  double radius_px() const { return first_.r_px - kRim_px; }
  // By how much the material that is at a place in the first frame has moved.
  Vector2d moved(const TexturedView& view, const Vector2d& at) const {
    const Vector2d off = at - Vector2d(first_.cx_px, first_.cy_px);
    const double depth = std::sqrt(std::max(first_.r_px * first_.r_px - off.squaredNorm(), 0.0));
    const Vector3d to = view.turn * Vector3d(off.x(), -off.y(), depth);  // y up
    return view.centre + Vector2d(to.x(), -to.y()) - at;
  }

 private:
  Vector2d centre_after(std::int64_t steps) const {
    return Vector2d(first_.cx_px, first_.cy_px) + static_cast<double>(steps) * shift_;
  }
  // What holds the ball from some steps to others.
  void set_part(const cv::Size& picture, std::int64_t from, std::int64_t to) {
    const Vector2d a = centre_after(from), b = centre_after(to), r(first_.r_px, first_.r_px);
    const Vector2d low = a.cwiseMin(b) - r, high = a.cwiseMax(b) + r;
    const cv::Point corner(static_cast<int>(low.x()), static_cast<int>(low.y()));
    const cv::Point end(static_cast<int>(high.x()) + 1, static_cast<int>(high.y()) + 1);
    part_ = cv::Rect(corner, end) & cv::Rect({}, picture);
  }
  void add(std::int64_t steps, const std::optional<Frame>& frame) {
    if (!frame) return;
    TexturedView view;
    cv::GaussianBlur(as_floats(*frame, part_), view.levels, {7, 7}, 1.0);
    view.turn = dic::quaternion_of(static_cast<double>(steps) * turn_).toRotationMatrix();
    view.centre = centre_after(steps);
    all_.push_back(std::move(view));
  }

  Circle first_;
  Vector3d turn_;
  Vector2d shift_;
  cv::Rect part_;
  std::vector<TexturedView> all_;
};

// Mean and variance from frame to frame of the pixels that show the ball in frames enough.
class Stack {
 public:
  explicit Stack(const ViewsAbout& views)
      : views_(views),
        about_(views.all().front().levels),
        sum_(cv::Mat::zeros(views.part().size(), CV_32F)),
        squares_(sum_.clone()),
        count_(sum_.clone()) {
    for (const TexturedView& view : views.all()) add(view);
    cv::divide(sum_, count_, mean_);
    mean_ += about_;
  }
  int width() const { return sum_.cols; }
  int height() const { return sum_.rows; }

  // What a pixel shows of an edge.
  struct Edge {
    Eigen::Vector2f slope{0, 0};  // of the mean picture; 0 where it is hardly one
    bool stays = false;
    bool is_still = false;  // it stays, though the ball would have carried it on
  };
  Edge edge(int x, int y, double noise) const {
    Edge edge;
    if (x < 1 || y < 1 || x + 1 >= width() || y + 1 >= height()) return edge;
    for (const auto& [u, v] : {std::pair{x, y}, {x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
      if (at(count_, u, v) < kFewestViews) return edge;
    }
    const Vector2d slope(0.5 * (at(mean_, x + 1, y) - at(mean_, x - 1, y)),
                         0.5 * (at(mean_, x, y + 1) - at(mean_, x, y - 1)));
    const double least = kChanges * noise, most = kMostWay_px * slope.norm();
    if (most < least) return edge;
    edge.slope = slope.cast<float>();
    const double count = at(count_, x, y), sum = at(sum_, x, y);
    const double variance = (at(squares_, x, y) - sum * sum / count) / (count - 1);
    edge.stays = variance < noise * noise * (1 + kChance * std::sqrt(2 / (count - 1)));
    edge.is_still = edge.stays && carried(x, y, slope) > least * least;
    return edge;
  }

 private:
  static float at(const cv::Mat& image, int x, int y) { return image.at<float>(y, x); }

  void add(const TexturedView& view) {
    const Vector2d centre = view.centre - Vector2d(views_.part().x, views_.part().y);
    const double r2 = views_.radius_px() * views_.radius_px();
    for (int y = 0; y < height(); ++y) {
      const double half2 = r2 - (y - centre.y()) * (y - centre.y());
      if (half2 <= 0) continue;
      const double half = std::sqrt(half2);
      const int first = std::max(0, static_cast<int>(std::ceil(centre.x() - half)));
      const int last = std::min(width() - 1, static_cast<int>(std::floor(centre.x() + half)));
      const float *levels = view.levels.ptr<float>(y), *about = about_.ptr<float>(y);
      float *sum = sum_.ptr<float>(y), *squares = squares_.ptr<float>(y);
      float* count = count_.ptr<float>(y);
      for (int x = first; x <= last; ++x) {
        const float off = levels[x] - about[x];
        sum[x] += off;
        squares[x] += off * off;
        ++count[x];
      }
    }
  }
  // Variance that an edge here would have if the ball carried it on.
  double carried(int x, int y, const Vector2d& slope) const {
    const Vector2d place(x + views_.part().x, y + views_.part().y);
    double sum = 0, squares = 0, count = 0;
    for (const TexturedView& view : views_.all()) {
      if ((place - view.centre).norm() > views_.radius_px()) continue;
      const double by = slope.dot(views_.moved(view, place));
      sum += by;
      squares += by * by;
      ++count;
    }
    const double most = kMostWay_px * slope.norm();
    return std::min((squares - sum * sum / count) / (count - 1), most * most);
  }

  const ViewsAbout& views_;
  cv::Mat about_, sum_, squares_, count_;  // sums are of levels about those of the first view
  cv::Mat mean_;
};

// Those of whole pictures.
class EdgeMap {
 public:
  EdgeMap(int width, int height) : across_(height, width, cv::Vec2f(0, 0)) {}

  // `across`: a unit vector.
  void add(int x, int y, const Eigen::Vector2f& across) {
    cv::Vec2f& here = across_(y, x);
    if (here == cv::Vec2f(0, 0)) found_.emplace_back(x, y);
    here = cv::Vec2f(across.x(), across.y());
  }
  bool is_empty() const { return found_.empty(); }
  // Whether an edge through a place would be part of a straight one that is there already.
  bool continue_to(int x, int y, const Eigen::Vector2f& across) const {
    const cv::Vec2f here(across.x(), across.y());
    const cv::Vec2f along(-here[1], here[0]);
    for (int d = -kMostGap_px; d <= kMostGap_px; ++d) {
      if (goes_on(cv::Point(x, y) + step(along, d), here)) return true;
    }
    return false;
  }

  // 0 on the edges and beside them, 255 elsewhere. Where the ball's speckles pass along an edge it
  // changes, and is one all the same: between two pieces of a straight one it goes on.
  std::shared_ptr<const Image<std::uint8_t>> mask() const {
    auto moving = std::make_shared<Image<std::uint8_t>>(across_.cols, across_.rows, 255);
    for (const cv::Point& at : found_) {
      blank_about(at, *moving);
      const cv::Vec2f across = across_(at);
      const cv::Vec2f along(-across[1], across[0]);
      for (int d = kMostGap_px; d > 2; --d) {
        if (!goes_on(at + step(along, d), across)) continue;
        for (int k = 1; k < d; ++k) blank_about(at + step(along, k), *moving);
        break;
      }
    }
    return moving;
  }

 private:
  static cv::Point step(const cv::Vec2f& along, int d) {
    return {cvRound(along[0] * static_cast<float>(d)), cvRound(along[1] * static_cast<float>(d))};
  }
  bool goes_on(const cv::Point& at, const cv::Vec2f& across) const {
    if (!cv::Rect({}, across_.size()).contains(at)) return false;
    return across_(at).dot(across) > kStraight;
  }
  static void blank_about(const cv::Point& at, Image<std::uint8_t>& moving) {
    const int right = std::min(moving.width() - 1, at.x + kBlur_px);
    const int bottom = std::min(moving.height() - 1, at.y + kBlur_px);
    for (int v = std::max(0, at.y - kBlur_px); v <= bottom; ++v) {
      for (int u = std::max(0, at.x - kBlur_px); u <= right; ++u) moving(u, v) = 0;
    }
  }

  cv::Mat_<cv::Vec2f> across_;    // 0 where there is none
  std::vector<cv::Point> found_;  // where there is one
};

// The edges about one ball that stand still.
class EdgesAbout {
 public:
  // `corner`: of the stack's part in the pictures.
  EdgesAbout(const Stack& stack, const cv::Point& corner, double noise)
      : corner_(corner),
        width_(stack.width()),
        height_(stack.height()),
        still_(width_, height_, 0) {
    edges_.reserve(still_.size());
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const Stack::Edge& edge = edges_.emplace_back(stack.edge(x, y, noise));
        moving_ += edge.slope.squaredNorm() > 0 && !edge.stays;
        if (edge.is_still) begins_.push_back(y * width_ + x);
      }
    }
  }
  // Otherwise it is the ball that stands still.
  bool may_be() const {
    const auto count = static_cast<double>(begins_.size());
    return count < kMostShare * (count + moving_);
  }
  bool are_told() const { return may_be() && begins_.size() >= kLeastPixels; }
  void add_to(EdgeMap& all) {
    for (const int begin : begins_) {
      if (together(begin) >= kTogether) follow(begin, all);
    }
  }
  // Adds those that continue edges which are there already; returns whether there are any.
  bool continue_in(EdgeMap& all) {
    const std::size_t before = begins_.size();
    std::erase_if(begins_, [&](int begin) {
      const Eigen::Vector2f across = edge_at(begin).slope.normalized();
      const bool continues =
          together(begin) >= kTogether &&
          all.continue_to(begin % width_ + corner_.x, begin / width_ + corner_.y, across);
      if (continues) follow(begin, all);
      return continues;
    });
    return begins_.size() < before;
  }

 private:
  const Stack::Edge& edge_at(int at) const { return edges_[static_cast<std::size_t>(at)]; }
  template <typename Use>
  void for_each_beside(int at, const Use& use) const {
    const int x = at % width_, y = at / width_;
    for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) use(v * width_ + u);
    }
  }
  int together(int at) const {
    int count = 0;
    for_each_beside(at, [&](int other) { count += edge_at(other).is_still; });
    return count;
  }
  // On along the edge, where the ball would hardly move it too; adds it to `all`.
  void follow(int begin, EdgeMap& all) {
    std::vector<int> open = {begin};
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      std::uint8_t& seen = still_.data()[at];
      if (seen != 0) continue;
      seen = 1;
      const Eigen::Vector2f across = edge_at(at).slope.normalized();
      all.add(at % width_ + corner_.x, at / width_ + corner_.y, across);
      for_each_beside(at, [&](int next) {
        const Stack::Edge& edge = edge_at(next);
        if (edge.stays && still_.data()[next] == 0 &&
            edge.slope.normalized().dot(across) > kStraight) {
          open.push_back(next);
        }
      });
    }
  }

  cv::Point corner_;
  int width_, height_;
  std::vector<Stack::Edge> edges_;
  std::vector<int> begins_;  // that the ball would carry on
  int moving_ = 0;           // edges that do not stay
  Image<std::uint8_t> still_;
};

// Share of a ball's pixels that are left.
double left_of(const Circle& ball, const Image<std::uint8_t>& moving) {
  const cv::Mat left(moving.height(), moving.width(), CV_8U,
                     const_cast<std::uint8_t*>(moving.data()));  // cv::Mat knows no const
  cv::Mat disc = cv::Mat::zeros(left.size(), CV_8U);
  const cv::Point centre(cvRound(ball.cx_px), cvRound(ball.cy_px));
  cv::circle(disc, centre, cvRound(ball.r_px), 255, cv::FILLED);
  const int seen = cv::countNonZero(disc);
  return seen > 0 ? static_cast<double>(cv::countNonZero(disc & left)) / seen : 1;
}

}  // namespace

StillEdges still_edges(std::span<const MovedBall> balls, double noise, const FarFrames& frames) {
  std::vector<std::optional<EdgesAbout>> found(balls.size());
  parallel_for(balls.size(), [&](std::size_t k) {
    const ViewsAbout views(balls[k], frames);
    if (!views.are_enough()) return;
    EdgesAbout edges(Stack(views), views.part().tl(), kSmoothedNoise * noise);
    if (edges.may_be()) found[k] = std::move(edges);
  });
  EdgeMap all(frames.width, frames.height);
  for (std::optional<EdgesAbout>& edges : found) {
    if (edges && edges->are_told()) edges->add_to(all);
  }
  for (bool more = !all.is_empty(); more;) {
    more = false;
    for (std::optional<EdgesAbout>& edges : found) more |= edges && edges->continue_in(all);
  }
  if (all.is_empty()) return {};
  const auto moving = all.mask();
  const bool cover_ball = std::any_of(balls.begin(), balls.end(), [&](const MovedBall& ball) {
    return left_of(ball.ball, *moving) < kLeastLeft;
  });
  return {moving, cover_ball};
}

}  // namespace impactdic::advice
