// The ball anywhere in a frame: Hough transform on prepared pictures, candidates proved by their
// rim.
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host/circle/circle.h"
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

void propose(const cv::Mat& picture, int shrink, double low, double high, Candidates& out) {
  cv::Mat smooth;
  cv::GaussianBlur(picture, smooth, {}, kBallSearch.blur_hough_px);
  std::vector<cv::Vec3f> circles;
  const double apart =
      std::max(kBallSearch.least_apart_px, kBallSearch.apart_of_r * (low / shrink));
  cv::HoughCircles(smooth, circles, cv::HOUGH_GRADIENT, 1, apart, kBallSearch.canny,
                   kBallSearch.votes, static_cast<int>(low / shrink),
                   static_cast<int>(std::ceil(high / shrink)));
  const double half = 0.5 * (shrink - 1);  // centre of the first reduced pixel
  for (std::size_t i = 0; i < std::min<std::size_t>(circles.size(), kBallSearch.candidates); ++i) {
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
  options.rays = kBallSearch.rays;
  CirclePrior prior;
  prior.predicted = candidate;
  prior.centre_sd_px =
      std::max(kBallSearch.least_candidate_sd_px, kBallSearch.candidate_sd_of_r * candidate.r_px);
  prior.rim_sd_px = prior.centre_sd_px;
  prior.learn = false;
  const CircleFit fit = measure_circle(frame, prior, options);
  if (fit.status != CircleStatus::kOk) return {};
  return {fit.rim_fraction * fit.circle.r_px, fit.rim_fraction, fit.circle};
}

bool seen(const std::vector<Circle>& tried, const Circle& circle) {
  return std::any_of(tried.begin(), tried.end(), [&](const Circle& other) {
    const double near = std::max(kBallSearch.same_px, kBallSearch.same_of_r * circle.r_px);
    return std::hypot(other.cx_px - circle.cx_px, other.cy_px - circle.cy_px) < near &&
           std::abs(other.r_px - circle.r_px) < near;
  });
}

}  // namespace

std::optional<Circle> find_ball(const Frame& frame, const CircleOptions& options) {
  options.validate();
  const int shorter = std::min(frame.width(), frame.height());
  if (shorter < kBallSearch.least_side_px) return std::nullopt;
  const double low = options.radius_range_px
                         ? options.radius_range_px->first
                         : std::max(kBallSearch.least_r_px, kBallSearch.least_r_of_side * shorter);
  const double high = options.radius_range_px ? options.radius_range_px->second
                                              : kBallSearch.most_r_of_side * shorter;
  const int shrink = std::clamp(
      static_cast<int>(std::min(
          std::ceil(std::max(frame.width(), frame.height()) / double(kBallSearch.hough_side_px)),
          low / kBallSearch.least_hough_r_px)),
      1, kBallSearch.most_shrink);
  const cv::Mat grey = prepare(frame, shrink);

  // The blobs first: on them the transform sees the ball's outline and nothing else.
  Proof best;
  std::vector<Circle> tried;
  for (int stage = 0; stage < 5 && best.rim_fraction < kBallSearch.proved; ++stage) {
    cv::Mat picture;
    if (stage < 4) {
      picture = blob(grey, stage % 2 == 0 ? cv::THRESH_BINARY : cv::THRESH_BINARY_INV,
                     kBallSearch.disc_px[stage / 2]);
    } else {
      cv::medianBlur(grey, picture, kBallSearch.median_px);
    }
    Candidates candidates;
    propose(picture, shrink, low, high, candidates);
    for (const Circle& candidate : candidates) {
      if (candidate.r_px < kBallSearch.least_candidate_r_px || seen(tried, candidate)) continue;
      tried.push_back(candidate);
      const Proof proof = prove(frame, candidate, options);
      if (proof.score > best.score) best = proof;
    }
  }
  if (best.score <= 0) return std::nullopt;
  return best.circle;
}

}  // namespace impactdic::circle
