// The ball anywhere in a frame: Hough transform on prepared pictures, candidates proved by their
// rim.
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host/circle/circle.h"

namespace impactdic::circle {
namespace {

constexpr int kHoughSize = 320;         // the picture is reduced to this for the transform
constexpr double kProved = 0.5;         // share of the rim that leaves no doubt
constexpr int kCandidates = 8;          // tried per prepared picture
constexpr double kCandidateSd = 0.025;  // scatter of a Hough centre, of the radius, at least 2 px

// A circle that the transform proposes, in pixels of the frame.
using Candidates = std::vector<Circle>;

// 8-bit picture of the whole frame, its grey levels stretched over 0 … 255, reduced by `shrink`.
cv::Mat prepare(const Frame& frame, int shrink) {
  const int depth = frame.type == PixelType::u8 ? CV_8U : CV_16U;
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
cv::Mat blob(const cv::Mat& grey, bool bright, int size) {
  cv::Mat smooth, binary;
  cv::GaussianBlur(grey, smooth, {}, 1.0);
  cv::threshold(smooth, binary, 0, 255,
                (bright ? cv::THRESH_BINARY : cv::THRESH_BINARY_INV) | cv::THRESH_OTSU);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * size + 1, 2 * size + 1});
  cv::morphologyEx(binary, binary, cv::MORPH_CLOSE, disc);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(binary, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(binary, outlines, -1, 255, cv::FILLED);
  cv::morphologyEx(binary, binary, cv::MORPH_OPEN, disc);
  return binary;
}

void propose(const cv::Mat& picture, int shrink, double low, double high, Candidates& out) {
  cv::Mat smooth;
  cv::GaussianBlur(picture, smooth, {}, 1.2);
  std::vector<cv::Vec3f> circles;
  cv::HoughCircles(smooth, circles, cv::HOUGH_GRADIENT, 1, std::max(4.0, low / shrink / 2), 80, 12,
                   static_cast<int>(low / shrink), static_cast<int>(std::ceil(high / shrink)));
  const double half = 0.5 * (shrink - 1);  // centre of the first reduced pixel
  for (std::size_t i = 0; i < std::min<std::size_t>(circles.size(), kCandidates); ++i) {
    out.push_back({circles[i][0] * shrink + half, circles[i][1] * shrink + half,
                   static_cast<double>(circles[i][2]) * shrink});
  }
}

struct Proof {
  double score = 0, rim_fraction = 0;
  Circle circle;
};

// Measures around the candidate. The score is the length of rim that carried the fit, so that of
// two concentric circles the larger wins.
Proof prove(const Frame& frame, const Circle& candidate, CircleOptions options) {
  options.rays = 360;
  CirclePrior prior;
  prior.predicted = candidate;
  prior.centre_sd_px = std::max(2.0, kCandidateSd * candidate.r_px);
  prior.rim_sd_px = prior.centre_sd_px;
  prior.learn = false;
  const CircleFit fit = measure_circle(frame, prior, options);
  if (fit.status != CircleStatus::ok) return {};
  return {fit.rim_fraction * fit.circle.r_px, fit.rim_fraction, fit.circle};
}

bool seen(const std::vector<Circle>& tried, const Circle& circle) {
  return std::any_of(tried.begin(), tried.end(), [&](const Circle& other) {
    const double near = std::max(1.0, 0.015 * circle.r_px);
    return std::hypot(other.cx_px - circle.cx_px, other.cy_px - circle.cy_px) < near &&
           std::abs(other.r_px - circle.r_px) < near;
  });
}

}  // namespace

std::optional<Circle> find_ball(const Frame& frame, const CircleOptions& options) {
  options.validate();
  const int shorter = std::min(frame.width(), frame.height());
  if (shorter < 16) return std::nullopt;
  const double low =
      options.radius_range_px ? options.radius_range_px->first : std::max(6.0, 0.03 * shorter);
  const double high = options.radius_range_px ? options.radius_range_px->second : 0.6 * shorter;
  const int shrink = std::clamp(
      static_cast<int>(std::min(
          std::ceil(std::max(frame.width(), frame.height()) / double(kHoughSize)), low / 5)),
      1, 16);
  const cv::Mat grey = prepare(frame, shrink);

  // The blobs first: on them the transform sees the ball's outline and nothing else.
  Proof best;
  std::vector<Circle> tried;
  const int sizes[] = {2, 5};
  for (int stage = 0; stage < 5 && best.rim_fraction < kProved; ++stage) {
    cv::Mat picture;
    if (stage < 4) {
      picture = blob(grey, stage % 2 == 0, sizes[stage / 2]);
    } else {
      cv::medianBlur(grey, picture, 5);
    }
    Candidates candidates;
    propose(picture, shrink, low, high, candidates);
    for (const Circle& candidate : candidates) {
      if (candidate.r_px < 3 || seen(tried, candidate)) continue;
      tried.push_back(candidate);
      const Proof proof = prove(frame, candidate, options);
      if (proof.score > best.score) best = proof;
    }
  }
  if (best.score <= 0) return std::nullopt;
  return best.circle;
}

}  // namespace impactdic::circle
