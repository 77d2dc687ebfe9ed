#include "host/camera/calibrate/refine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "host/base/statistics.h"

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;

constexpr int kMostRefinements = 60;
constexpr double kConverged_px = 1e-4;

std::map<std::size_t, Vector2d> by_point(const std::vector<Sighting>& seen) {
  std::map<std::size_t, Vector2d> places;
  for (const Sighting& sighting : seen) places[sighting.point] = sighting.at_px;
  return places;
}

double nearest(const std::map<std::size_t, Vector2d>& places, const Sighting& sighting,
               int columns) {
  const auto point = static_cast<std::ptrdiff_t>(sighting.point);
  const std::ptrdiff_t column = point % columns;
  double least = 0;
  for (const std::ptrdiff_t step : {-1, 1, -columns, columns}) {
    if ((step == -1 && column == 0) || (step == 1 && column == columns - 1)) continue;
    if (point + step < 0) continue;
    const auto found = places.find(static_cast<std::size_t>(point + step));
    if (found == places.end()) continue;
    const double distance = (found->second - sighting.at_px).norm();
    if (least == 0 || distance < least) least = distance;
  }
  return least;
}

bool is_inside(const cv::Mat& picture, const Vector2d& at, double margin) {
  return at.x() >= margin && at.y() >= margin && at.x() <= picture.cols - 1 - margin &&
         at.y() <= picture.rows - 1 - margin;
}

// The grey level at the dot's centre and in the ring halfway to its neighbours.
std::pair<double, double> levels(const cv::Mat& picture, const Vector2d& centre, double reach) {
  std::vector<uchar> ink, ground;
  for (int y = static_cast<int>(centre.y() - reach); y <= centre.y() + reach; ++y) {
    for (int x = static_cast<int>(centre.x() - reach); x <= centre.x() + reach; ++x) {
      const double r = std::hypot(x - centre.x(), y - centre.y());
      if (r < std::max(0.15 * reach, 1.0)) ink.push_back(picture.at<uchar>(y, x));
      if (r < reach && r > 0.85 * reach) ground.push_back(picture.at<uchar>(y, x));
    }
  }
  if (ink.empty() || ground.empty()) return {0, 0};
  return {upper_median(std::move(ink)), upper_median(std::move(ground))};
}

// Where noise of the ground begins to count as ink.
constexpr double kLeastInk = 0.1;

bool refine_dot(const cv::Mat& picture, double reach, Vector2d& centre) {
  for (int step = 0; step < kMostRefinements; ++step) {
    if (!is_inside(picture, centre, reach + 1)) return false;
    const auto [ink, ground] = levels(picture, centre, reach);
    if (std::abs(ink - ground) < 10) return false;
    double sum = 0;
    Vector2d moment(0, 0);
    for (int y = static_cast<int>(centre.y() - reach); y <= centre.y() + reach; ++y) {
      for (int x = static_cast<int>(centre.x() - reach); x <= centre.x() + reach; ++x) {
        const Vector2d off(x - centre.x(), y - centre.y());
        if (off.norm() > reach) continue;
        const double share = (picture.at<uchar>(y, x) - ground) / (ink - ground);
        const double weight = std::clamp(share - kLeastInk, 0.0, 1.0);
        sum += weight;
        moment += weight * off;
      }
    }
    if (!(sum > 4)) return false;
    centre += moment / sum;
    if ((moment / sum).norm() < kConverged_px) return true;
  }
  return true;
}

}  // namespace

double nearest_neighbour_px(const std::vector<Sighting>& seen, std::size_t index, int columns) {
  return nearest(by_point(seen), seen[index], columns);
}

void refine_corners(const cv::Mat& picture, int columns, double clear,
                    std::vector<Sighting>& seen) {
  const std::map<std::size_t, Vector2d> places = by_point(seen);
  std::vector<Sighting> kept;
  for (Sighting sighting : seen) {
    constexpr double kLeast = 2, kMost = 15;
    const double reach =
        std::clamp(std::floor(clear * nearest(places, sighting, columns)), kLeast, kMost);
    if (!is_inside(picture, sighting.at_px, reach + 2)) continue;
    std::vector<cv::Point2f> at = {
        {static_cast<float>(sighting.at_px.x()), static_cast<float>(sighting.at_px.y())}};
    const int half = static_cast<int>(reach);
    cv::cornerSubPix(
        picture, at, {half, half}, {-1, -1},
        {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMostRefinements, kConverged_px});
    const Vector2d refined(at[0].x, at[0].y);
    if ((refined - sighting.at_px).norm() > reach) continue;
    sighting.at_px = refined;
    kept.push_back(sighting);
  }
  seen = std::move(kept);
}

void refine_dots(const cv::Mat& picture, int columns, std::vector<Sighting>& seen) {
  const std::map<std::size_t, Vector2d> places = by_point(seen);
  std::vector<Sighting> kept;
  for (Sighting sighting : seen) {
    const double reach = nearest(places, sighting, columns) / 2;
    if (reach < 3 || !refine_dot(picture, reach, sighting.at_px)) continue;
    kept.push_back(sighting);
  }
  seen = std::move(kept);
}

}  // namespace impactdic::camera
