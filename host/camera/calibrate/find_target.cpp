#include "host/camera/calibrate/find_target.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <span>

#include "host/base/statistics.h"
#include "host/camera/calibrate/dot_lattice.h"
#include "host/camera/calibrate/markers.h"
#include "host/camera/calibrate/refine.h"

namespace impactdic::camera {
namespace {

// Of a square: to halfway to the next corner, less what blur and perspective need.
constexpr double kClearOfSquares = 0.4;

// Points of a grid in OpenCV's order as sightings.
std::vector<Sighting> in_order(const std::vector<cv::Point2f>& points) {
  std::vector<Sighting> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    seen.push_back({i, {points[i].x, points[i].y}});
  }
  return seen;
}

std::vector<Sighting> find_checkerboard(const cv::Mat& picture, const CalibrateRequest& request) {
  const cv::Size inner(request.columns - 1, request.rows - 1);
  std::vector<cv::Point2f> corners;
  // Duda and Frese 2018: a localised Radon transform; sure of itself also where it is blurred.
  const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;
  if (!cv::findChessboardCornersSB(picture, inner, corners, flags)) {
    const int older = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
    if (!cv::findChessboardCorners(picture, inner, corners, older)) return {};
  }
  return in_order(corners);
}

std::vector<Sighting> find_dots(const cv::Mat& picture, const CalibrateRequest& request) {
  const cv::Size size(request.columns, request.rows);
  cv::SimpleBlobDetector::Params params;
  params.minArea = 12;
  params.maxArea = static_cast<float>(picture.total()) / 16;
  params.minDistBetweenBlobs = 4;
  params.filterByConvexity = false;  // small dots have steps for an outline
  params.minInertiaRatio = 0.2F;     // leaning dots are ellipses
  std::vector<cv::Point2f> centres;
  std::vector<Sighting> most;  // where not all of the target is seen
  for (const bool bright : {false, true}) {
    params.blobColor = bright ? 255 : 0;
    const auto detector = cv::SimpleBlobDetector::create(params);
    for (const int extra : {0, static_cast<int>(cv::CALIB_CB_CLUSTERING)}) {
      if (cv::findCirclesGrid(picture, size, centres, cv::CALIB_CB_SYMMETRIC_GRID | extra,
                              detector)) {
        return in_order(centres);
      }
    }
    std::vector<cv::KeyPoint> blobs;
    detector->detect(picture, blobs);
    std::vector<Eigen::Vector2d> places;
    for (const cv::KeyPoint& blob : blobs) places.emplace_back(blob.pt.x, blob.pt.y);
    std::vector<Sighting> part = number_dots(places, request.columns, request.rows);
    if (part.size() > most.size()) most = std::move(part);
  }
  // Fewer are no evidence of a grid.
  constexpr std::size_t kFewestDots = 12;
  return most.size() < kFewestDots ? std::vector<Sighting>{} : most;
}

std::vector<Sighting> sight(const cv::Mat& picture, const CalibrateRequest& request) {
  std::vector<Sighting> seen;
  switch (request.target) {
    case CalibrationTarget::kCheckerboard:
      seen = find_checkerboard(picture, request);
      refine_corners(picture, request.columns - 1, kClearOfSquares, seen);
      break;
    case CalibrationTarget::kCharuco:
      seen = find_charuco(picture, request);
      refine_corners(picture, request.columns - 1, (1 - marker_share(request)) / 2, seen);
      break;
    case CalibrationTarget::kDots:
      seen = find_dots(picture, request);
      refine_dots(picture, request.columns, seen);
      break;
    case CalibrationTarget::kRuler:
      break;
  }
  return seen;
}

}  // namespace

BoardPoints board_points(const CalibrateRequest& request) {
  const int inner = request.target == CalibrationTarget::kDots ? 0 : 1;
  const double pitch_m = request.pitch_mm * 1e-3;
  BoardPoints points;
  for (int row = 0; row < request.rows - inner; ++row) {
    for (int column = 0; column < request.columns - inner; ++column) {
      points.emplace_back(column * pitch_m, row * pitch_m);
    }
  }
  return points;
}

double dot_diameter_mm(const CalibrateRequest& request) {
  return request.dot_mm > 0 ? request.dot_mm : request.pitch_mm / 3;
}

cv::Mat to_grey(const Frame& frame) {
  const Image<float> levels = frame.to_float();
  const std::span<const float> all(levels.data(), levels.size());
  const double last = static_cast<double>(all.size()) - 1;
  const float dark = order_statistic(all, static_cast<std::size_t>(0.002 * last));
  const float bright =
      std::max(order_statistic(all, static_cast<std::size_t>(0.998 * last)), dark + 1);
  // Room above and below, so that no edge is cut off.
  constexpr double kLow = 16, kHigh = 239;
  const cv::Mat view(levels.height(), levels.width(), CV_32F, const_cast<float*>(levels.data()));
  cv::Mat grey;
  const double gain = (kHigh - kLow) / (bright - dark);
  view.convertTo(grey, CV_8U, gain, kLow - gain * dark);
  return grey;
}

std::vector<Sighting> find_target(const cv::Mat& picture, const CalibrateRequest& request) {
  try {
    return sight(picture, request);
  } catch (const cv::Exception&) {
    return {};  // a picture that its finders do not take shows none
  }
}

}  // namespace impactdic::camera
