// The ball anywhere in a frame: Hough transform on prepared pictures, of the frame itself and of
// what moved in it; candidates proved by their rim.
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/scene/ball_choice.h"
#include "host/circle/scene/cast_shadow.h"
#include "host/circle/scene/still_scene.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

// A circle that the transform proposes, in pixels of the frame.
using Candidates = std::vector<Circle>;

// 8-bit picture of the whole frame, its grey levels stretched over 0 … 255, reduced by `shrink`.
cv::Mat prepare(const Frame& frame, int shrink) {
  const int depth = frame.type == PixelType::kU8 ? CV_8U : CV_16U;
  const cv::Mat whole(frame.height(), frame.width(), depth, const_cast<void*>(frame.bytes()));
  cv::Mat reduced, grey;
  const cv::Size size(std::max(8, frame.width() / shrink), std::max(8, frame.height() / shrink));
  cv::resize(whole, reduced, size, 0, 0, cv::INTER_AREA);
  double low = 0, high = 0;
  cv::minMaxLoc(reduced, &low, &high);
  const double gain = 255 / std::max(high - low, 1.0);
  reduced.convertTo(grey, CV_8U, gain, -low * gain);
  return grey;
}

// Threshold and boundary of section 3.2.1: black and white, then specks and holes smaller than
// `size` closed or opened away, so that a speckled or glinting ball becomes one blob.
cv::Mat blob(const cv::Mat& grey, int threshold, int size) {
  cv::Mat smooth, binary;
  cv::GaussianBlur(grey, smooth, {}, kBallSearch.blur_blob_px);
  cv::threshold(smooth, binary, 0, 255, threshold | cv::THRESH_OTSU);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * size + 1, 2 * size + 1});
  cv::morphologyEx(binary, binary, cv::MORPH_CLOSE, disc);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(binary, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(binary, outlines, -1, 255, cv::FILLED);
  cv::morphologyEx(binary, binary, cv::MORPH_OPEN, disc);
  return binary;
}

template <typename Test>
void propose(const cv::Mat& picture, int shrink, double low, double high, const Test& may_be,
             Candidates& out) {
  cv::Mat smooth;
  cv::GaussianBlur(picture, smooth, {}, kBallSearch.blur_hough_px);
  std::vector<cv::Vec3f> circles;
  const double apart =
      std::max(kBallSearch.least_apart_px, kBallSearch.apart_of_r * (low / shrink));
  cv::HoughCircles(smooth, circles, cv::HOUGH_GRADIENT, 1, apart, kBallSearch.canny,
                   kBallSearch.votes, static_cast<int>(low / shrink),
                   static_cast<int>(std::ceil(high / shrink)));
  const double half = 0.5 * (shrink - 1);  // centre of the first reduced pixel
  for (const cv::Vec3f& found : circles) {
    const Circle circle{found[0] * shrink + half, found[1] * shrink + half,
                        static_cast<double>(found[2]) * shrink};
    if (may_be(circle)) out.push_back(circle);
    if (out.size() == static_cast<std::size_t>(kBallSearch.candidates)) break;
  }
}

// Measures around the candidate. The score is the length of rim that carried the fit, so that of
// two concentric circles the larger wins.
FoundBall prove(const Frame& frame, const Circle& candidate, double sd_px, CircleOptions options) {
  options.rays = kBallSearch.rays;
  CirclePrior prior;
  prior.predicted = candidate;
  prior.centre_sd_px = sd_px;
  prior.rim_sd_px = prior.centre_sd_px;
  prior.learn = false;
  const CircleFit fit = measure_circle(frame, prior, options);
  if (fit.status != CircleStatus::kOk) return {};
  return {fit.circle, fit.rim_fraction, fit.rim_fraction * fit.circle.r_px, fit.bright,
          fit.residual_px};
}

bool seen(const std::vector<Circle>& tried, const Circle& circle) {
  return std::any_of(tried.begin(), tried.end(), [&](const Circle& other) {
    const double near = std::max(kBallSearch.same_px, kBallSearch.same_of_r * circle.r_px);
    return std::hypot(other.cx_px - circle.cx_px, other.cy_px - circle.cy_px) < near &&
           std::abs(other.r_px - circle.r_px) < near;
  });
}

// Where one of two circles lies largely in the other, that with less of a rim is part of it.
bool same_place(const Circle& a, const Circle& b) {
  return std::hypot(a.cx_px - b.cx_px, a.cy_px - b.cy_px) <
         kBallSearch.overlap * std::max(a.r_px, b.r_px);
}

// Whether a circle lies so near another, in place and radius, that it is the same.
bool same_circle(const Circle& a, const Circle& known) {
  const double near = kBallSearch.known_of_r * known.r_px;
  return std::abs(a.r_px - known.r_px) < near &&
         std::hypot(a.cx_px - known.cx_px, a.cy_px - known.cy_px) < near;
}

// The search in one frame.
class Search {
 public:
  Search(const Frame& frame, const CircleOptions& options, const StillScene* scene)
      : frame_(frame), options_(options), scene_(scene) {
    const int shorter = std::min(frame.width(), frame.height());
    const auto& range = options.radius_range_px;
    low_ = range ? range->first
                 : std::max(kBallSearch.least_r_px, kBallSearch.least_r_of_side * shorter);
    high_ = range ? range->second : kBallSearch.most_r_of_side * shorter;
    if (scene != nullptr) moved_ = scene->moved(frame);
  }

  void by_shape() {
    const double longer = std::max(frame_.width(), frame_.height());
    const int shrink =
        std::clamp(static_cast<int>(std::min(std::ceil(longer / double(kBallSearch.hough_side_px)),
                                             low_ / kBallSearch.least_hough_r_px)),
                   1, kBallSearch.most_shrink);
    const cv::Mat grey = prepare(frame_, shrink);
    // The blobs first: on them the transform sees the ball's outline and nothing else.
    for (int stage = 0; stage < 5 && !is_proved(); ++stage) {
      cv::Mat picture;
      if (stage < 4) {
        picture = blob(grey, stage % 2 == 0 ? cv::THRESH_BINARY : cv::THRESH_BINARY_INV,
                       kBallSearch.disc_px[stage / 2]);
      } else {
        cv::medianBlur(grey, picture, kBallSearch.median_px);
      }
      try_circles(picture, shrink);
    }
  }

  // Where it differs from what stands still.
  void by_motion() {
    for (const int size : kBallSearch.moved_disc_px) {
      try_circles(blob(moved_, cv::THRESH_BINARY, size), scene_->shrink());
    }
  }

  // Puts what lies before a shadow in the shadow's place: another circle that was found, or one by
  // the shadow's own edge.
  void by_shadows() {
    for (FoundBall& dark : found_) {
      const auto beside = std::ranges::find_if(found_, [&](const FoundBall& ball) {
        return is_plain_before(ball) && may_cast(ball.circle, dark.circle) &&
               is_flat_dark(frame_, dark.circle, &ball.circle);
      });
      if (beside != found_.end()) {
        replace(dark.circle, *beside);
        continue;
      }
      const auto before = what_casts(frame_, dark.circle);
      if (!before) continue;
      for (const double sd : kCastShadow.found_sd) {
        const FoundBall ball = prove(frame_, *before, sd * before->r_px, options_);
        if (!casts(ball, dark)) continue;
        replace(dark.circle, ball);
        break;
      }
    }
  }

  int proofs() const { return static_cast<int>(tried_.size()); }
  bool is_proved() const { return best_ >= kBallSearch.proved; }
  // Whether more has moved than the balls that were found: `share` of the largest one's disc, or
  // of the least ball's.
  bool more_moved() const {
    if (scene_ == nullptr) return false;
    cv::Mat rest = moved_.clone();
    double least = low_;
    const double half = 0.5 * (scene_->shrink() - 1);
    for (const FoundBall& ball : found_) {
      const double scale = 1.0 / scene_->shrink();
      const cv::Point centre(cvRound((ball.circle.cx_px - half) * scale),
                             cvRound((ball.circle.cy_px - half) * scale));
      cv::circle(rest, centre, cvCeil(kBallSearch.explained_of_r * ball.circle.r_px * scale), 0,
                 cv::FILLED);
      least = std::max(least, kBallSearch.other_of_r * ball.circle.r_px);
    }
    const double px = cv::countNonZero(rest) * double(scene_->shrink()) * scene_->shrink();
    return px > least * least;
  }

  std::vector<FoundBall> take() {
    std::vector<FoundBall> balls;
    std::stable_sort(found_.begin(), found_.end(),
                     [](const FoundBall& a, const FoundBall& b) { return a.score > b.score; });
    for (const FoundBall& ball : found_) {
      const bool known = std::any_of(balls.begin(), balls.end(), [&](const FoundBall& other) {
        return same_place(ball.circle, other.circle);
      });
      if (!known) balls.push_back(ball);
    }
    return balls;
  }

 private:
  bool is_still(const Circle& circle, double rim_fraction) const {
    return scene_ != nullptr && scene_->is_still(moved_, circle, rim_fraction);
  }

  // Whether the candidate would only lead to a ball that is proved already: it is that ball, or it
  // touches that ball's rim from one side, so that an arc of that rim proposed it.
  bool is_known(const Circle& candidate) const {
    return std::any_of(found_.begin(), found_.end(), [&](const FoundBall& ball) {
      if (ball.rim_fraction < kBallSearch.proved) return false;
      const Circle& circle = ball.circle;
      const double by = std::abs(circle.r_px - candidate.r_px);
      const double off = std::hypot(circle.cx_px - candidate.cx_px, circle.cy_px - candidate.cy_px);
      const bool touches = std::abs(off - by) < kBallSearch.touches_of_r * circle.r_px;
      return same_circle(candidate, circle) ||
             (touches && off < kBallSearch.touching_of_r * circle.r_px);
    });
  }

  void replace(const Circle shadow, const FoundBall ball) {
    for (FoundBall& other : found_) {
      if (same_circle(other.circle, shadow)) other = ball;
    }
  }

  // Whether so much of its rim is so plain that it may lie before a shadow.
  static bool is_plain_before(const FoundBall& ball) {
    return ball.rim_fraction > kCastShadow.much_rim ||
           (ball.rim_fraction > kCastShadow.half_rim && ball.residual_px < kCastShadow.fair_px) ||
           (ball.rim_fraction > kCastShadow.least_rim && ball.residual_px < kCastShadow.clean_px);
  }

  void try_circles(const cv::Mat& picture, int shrink) {
    Candidates candidates;
    const auto may_be = [&](const Circle& circle) { return !is_still(circle, 1); };
    propose(picture, shrink, low_, high_, may_be, candidates);
    for (const Circle& candidate : candidates) {
      if (candidate.r_px < kBallSearch.least_candidate_r_px || seen(tried_, candidate) ||
          is_known(candidate)) {
        continue;
      }
      tried_.push_back(candidate);
      const double sd_px = std::max(kBallSearch.least_candidate_sd_px,
                                    kBallSearch.candidate_sd_of_r * candidate.r_px);
      const FoundBall ball = prove(frame_, candidate, sd_px, options_);
      if (ball.score <= 0 || is_still(ball.circle, ball.rim_fraction)) continue;
      const bool best = std::none_of(found_.begin(), found_.end(), [&](const FoundBall& other) {
        return other.score >= ball.score;
      });
      // A shadow leaves the doubt whether what casts it is still to be found.
      if (best) best_ = is_flat_dark(frame_, ball.circle, nullptr) ? 0 : ball.rim_fraction;
      found_.push_back(ball);
    }
  }

  // Whether a circle that was proved before another one, which looks like its shadow, shows as much
  // of a rim. A circle about both of them lies off the rims of either.
  bool casts(const FoundBall& ball, const FoundBall& dark) const {
    if (!is_plain_before(ball) || !may_cast(ball.circle, dark.circle) ||
        is_still(ball.circle, ball.rim_fraction)) {
      return false;
    }
    const bool about_both = dark.residual_px > kCastShadow.ragged_px &&
                            ball.residual_px < kCastShadow.of_ragged * dark.residual_px;
    return about_both || ball.rim_fraction > dark.rim_fraction - kCastShadow.rim ||
           shows_beside(frame_, ball.circle, dark.circle);
  }

  const Frame& frame_;
  const CircleOptions& options_;
  const StillScene* scene_;
  cv::Mat moved_;
  double low_ = 0, high_ = 0;
  double best_ = 0;  // share of the rim of the best one found
  std::vector<FoundBall> found_;
  std::vector<Circle> tried_;
};

}  // namespace

std::vector<FoundBall> find_balls(const Frame& frame, const CircleOptions& options,
                                  const StillScene* scene, bool all, int* proofs) {
  options.validate();
  if (std::min(frame.width(), frame.height()) < kBallSearch.least_side_px) return {};
  Search search(frame, options, scene);
  search.by_shape();
  if (scene != nullptr && (!search.is_proved() || (all && search.more_moved()))) search.by_motion();
  search.by_shadows();
  if (proofs != nullptr) *proofs = search.proofs();
  return search.take();
}

std::optional<Circle> find_ball(const Frame& frame, const CircleOptions& options,
                                const StillScene* scene) {
  const std::vector<FoundBall> balls = find_balls(frame, options, scene, false);
  if (balls.empty()) return std::nullopt;
  return balls.front().circle;
}

std::optional<Circle> find_chosen_ball(const Frame& frame, std::int64_t index,
                                       const CircleOptions& options, const StillScene* scene,
                                       const BallChoice* choice) {
  if (choice == nullptr) return find_ball(frame, options, scene);
  for (const FoundBall& ball : find_balls(frame, options, scene, true)) {
    if (!choice->is_another(index, ball.circle)) return ball.circle;
  }
  return std::nullopt;
}

bool is_another_ball(const BallChoice* choice, std::int64_t index, const Circle& circle) {
  return choice != nullptr && choice->is_another(index, circle);
}

}  // namespace impactdic::circle
