#include "host/camera/calibrate/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host/camera/plane_view.h"
#include "host/camera/spread.h"

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kEnoughPictures = 5;
constexpr double kEnoughTilt_deg = 10;
constexpr double kMuchScatter_px = 0.3, kMuchPlace_px = 0.5;
constexpr int kMorePictures = 3;

template <typename... Values>
std::string worded(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// The parts of the picture without a point: corners of a 4 x 4 grid, or more of it.
std::string not_covered(const CalibrateResult& result) {
  constexpr int kSide = 4;
  std::array<std::array<int, kSide>, kSide> points{};
  for (const CalibrationPoint& point : result.points) {
    if (!point.used) continue;
    const auto cell = [](double at, int size) {
      return std::clamp(static_cast<int>(kSide * at / size), 0, kSide - 1);
    };
    ++points[cell(point.y_px, result.camera.height)][cell(point.x_px, result.camera.width)];
  }
  struct Corner {
    int row, column;
    const char* name;
  };
  std::string names;
  for (const Corner& corner : {Corner{0, 0, "top left"},
                               {0, kSide - 1, "top right"},
                               {kSide - 1, 0, "bottom left"},
                               {kSide - 1, kSide - 1, "bottom right"}}) {
    if (points[corner.row][corner.column] > 0) continue;
    names += (names.empty() ? "" : ", ") + std::string(corner.name);
  }
  return names;
}

double tilt_range_deg(const CalibrateResult& result) {
  double least = 90, most = 0;
  for (const CalibrationPicture& picture : result.pictures) {
    if (!picture.used) continue;
    least = std::min(least, picture.tilt_deg), most = std::max(most, picture.tilt_deg);
  }
  return most - least;
}

// Points of the picture's border against its middle, in px of the middle.
double worst_place_px(const Camera& camera) {
  const double w = camera.width - 1, h = camera.height - 1;
  const std::array<Vector2d, 8> places = {Vector2d(0, 0), {w / 2, 0}, {w, 0}, {w, h / 2},
                                          {w, h},         {w / 2, h}, {0, h}, {0, h / 2}};
  const Vector2d middle(w / 2, h / 2);
  double worst = 0;
  for (const Vector2d& place : places) {
    const std::vector<double> sd = spread(camera, [&](const Camera& one) {
      const PlaneView view(one);
      // A common scale is stated by itself.
      const Vector2d aside = view.to_plane(place) - view.to_plane(middle);
      const double unit = view.metre_per_px();
      return std::vector<double>{aside.x() / unit, aside.y() / unit};
    });
    worst = std::max(worst, std::hypot(sd[0], sd[1]) / std::sqrt(2.0));
  }
  return worst;
}

void judge_pictures(const CalibrateResult& result, std::vector<std::string>& missing) {
  std::size_t used = 0;
  for (const CalibrationPicture& picture : result.pictures) used += picture.used;
  if (used < kEnoughPictures) {
    missing.push_back(worded("%zu picture%s: %zu or more let errors of single ones be seen", used,
                             used == 1 ? "" : "s", kEnoughPictures));
  }
  const std::string corners = not_covered(result);
  if (!corners.empty()) {
    missing.push_back("the picture is not covered (" + corners + "): " +
                      std::to_string(kMorePictures) + " more pictures with the target there");
  }
  if (!result.camera.focal_length_known) {
    const std::string why = tilt_range_deg(result) < kEnoughTilt_deg
                                ? "all pictures are parallel"
                                : "the pictures tell too little of it";
    missing.push_back(why + ": the focal length is not determined; " +
                      std::to_string(kMorePictures) +
                      " more pictures with the target tilted by 20 to 40 degrees");
  }
  if (result.point_sd_px > kMuchScatter_px) {
    missing.push_back(
        worded("the points scatter by %.2f px: is the target flat, and are the pictures "
               "sharp?",
               result.point_sd_px));
  }
  if (result.worst_place_sd_px > kMuchPlace_px) {
    missing.push_back(
        worded("places near the border are known to %.1f px only", result.worst_place_sd_px));
  }
}

}  // namespace

void judge(const CalibrateRequest& request, CalibrateResult& result) {
  const Camera& camera = result.camera;
  result.metre_per_px = scale_at_middle(camera);
  const PlaneView view(camera);
  // The angle has no slope where it is zero; the line of sight's parts along the plane do.
  const std::vector<double> tilt_sd = spread(camera, [](const Camera& one) {
    const PlaneView seen(one);
    return std::vector<double>{seen.sight().x(), seen.sight().y()};
  });
  if (camera.focal_length_known) {
    result.tilt_deg = {view.tilt_rad() * kDegPerRad, std::max(tilt_sd[0], tilt_sd[1]) * kDegPerRad};
  }
  result.distortion_px = largest_distortion_px(camera);
  result.worst_place_sd_px = worst_place_px(camera);
  std::vector<std::string> missing;
  if (request.target == CalibrationTarget::kRuler) {
    missing.push_back("a ruler tells the scale alone: neither distortion nor tilt is corrected");
  } else {
    judge_pictures(result, missing);
  }
  result.good = missing.empty();
  if (result.good) missing.push_back("nothing is missing");
  result.verdict = std::move(missing);
}

}  // namespace impactdic::camera
