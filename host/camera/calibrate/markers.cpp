#include "host/camera/calibrate/markers.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)
#include <opencv2/objdetect/aruco_detector.hpp>
#define IMPACTDIC_ARUCO_IN_OBJDETECT
#else
#include <opencv2/aruco.hpp>
#endif

namespace impactdic::camera {
namespace {

int dictionary_number(const std::string& name) {
  static const std::map<std::string, int> kNumbers = {
      {"4x4_50", 0},    {"4x4_100", 1},   {"4x4_250", 2},  {"4x4_1000", 3}, {"5x5_50", 4},
      {"5x5_100", 5},   {"5x5_250", 6},   {"5x5_1000", 7}, {"6x6_50", 8},   {"6x6_100", 9},
      {"6x6_250", 10},  {"6x6_1000", 11}, {"7x7_50", 12},  {"7x7_100", 13}, {"7x7_250", 14},
      {"7x7_1000", 15}, {"original", 16}};
  const auto found = kNumbers.find(name);
  if (found == kNumbers.end()) {
    throw InvalidArgument("there is no dictionary '" + name + "'", "--dictionary",
                          "4x4_50, 5x5_100, … 7x7_1000, original");
  }
  return found->second;
}

using MarkerCorners = std::vector<std::vector<cv::Point2f>>;

void detect(const cv::Mat& picture, const std::string& dictionary, MarkerCorners& corners,
            std::vector<int>& ids) {
#ifdef IMPACTDIC_ARUCO_IN_OBJDETECT
  const cv::aruco::ArucoDetector detector(
      cv::aruco::getPredefinedDictionary(dictionary_number(dictionary)));
  detector.detectMarkers(picture, corners, ids);
#else
  const auto known = cv::aruco::getPredefinedDictionary(dictionary_number(dictionary));
  cv::aruco::detectMarkers(picture, known, corners, ids);
#endif
}

// Where the corners of a marker lie on the board, in squares; clockwise from its top left.
std::vector<cv::Point2f> marker_on_board(int column, int row, double share) {
  const auto low = static_cast<float>((1 - share) / 2), high = static_cast<float>((1 + share) / 2);
  const auto x = static_cast<float>(column), y = static_cast<float>(row);
  return {{x + low, y + low}, {x + high, y + low}, {x + high, y + high}, {x + low, y + high}};
}

}  // namespace

double marker_share(const CalibrateRequest& request) {
  constexpr double kUsual = 0.75;
  return request.marker_mm > 0 ? request.marker_mm / request.pitch_mm : kUsual;
}

cv::Mat draw_marker(const std::string& dictionary, int id, int side_px) {
  cv::Mat marker;
#ifdef IMPACTDIC_ARUCO_IN_OBJDETECT
  const cv::aruco::Dictionary known =
      cv::aruco::getPredefinedDictionary(dictionary_number(dictionary));
  cv::aruco::generateImageMarker(known, id, side_px, marker);
#else
  const auto known = cv::aruco::getPredefinedDictionary(dictionary_number(dictionary));
  cv::aruco::drawMarker(known, id, side_px, marker);
#endif
  return marker;
}

std::vector<Sighting> find_charuco(const cv::Mat& picture, const CalibrateRequest& request) {
  MarkerCorners corners;
  std::vector<int> ids;
  detect(picture, request.dictionary, corners, ids);
  const double share = marker_share(request);
  std::map<int, std::size_t> found;  // marker -> index
  for (std::size_t i = 0; i < ids.size(); ++i) found[ids[i]] = i;
  // Each corner from the markers beside it alone: over one square the lens bends nothing.
  std::map<std::size_t, std::vector<cv::Point2f>> guesses;
  int id = 0;
  for (int row = 0; row < request.rows; ++row) {
    for (int column = 0; column < request.columns; ++column) {
      if ((row + column) % 2 == 0) continue;  // black
      const auto seen = found.find(id++);
      if (seen == found.end()) continue;
      const cv::Mat map =
          cv::getPerspectiveTransform(marker_on_board(column, row, share), corners[seen->second]);
      for (const auto& [x, y] :
           {std::pair{column, row}, {column + 1, row}, {column, row + 1}, {column + 1, row + 1}}) {
        if (x < 1 || y < 1 || x >= request.columns || y >= request.rows) continue;
        std::vector<cv::Point2f> at = {{static_cast<float>(x), static_cast<float>(y)}};
        cv::perspectiveTransform(at, at, map);
        guesses[static_cast<std::size_t>((y - 1) * (request.columns - 1) + x - 1)].push_back(at[0]);
      }
    }
  }
  std::vector<Sighting> seen;
  for (const auto& [point, places] : guesses) {
    Eigen::Vector2d mean(0, 0);
    for (const cv::Point2f& place : places) mean += Eigen::Vector2d(place.x, place.y);
    mean /= static_cast<double>(places.size());
    seen.push_back({point, mean});
  }
  return seen;
}

}  // namespace impactdic::camera
