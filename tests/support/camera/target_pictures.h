// Pictures of flat targets as a camera with distortion sees them, rendered from formulas: every
// pixel is the mean of points within it, the lens blurs, the sensor is noisy.
#pragma once

#include <impactdic/camera/calibrate.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "host/camera/calibrate/board.h"
#include "host/camera/calibrate/markers.h"
#include "host/camera/lens.h"

namespace impactdic::testing {

// A target's grey level at a point of its plane, m; 1 is white.
class TargetPattern {
 public:
  explicit TargetPattern(const CalibrateRequest& request) : request_(request) {
    if (request.target != CalibrationTarget::kCharuco) return;
    const int markers = request.columns * request.rows / 2;
    for (int id = 0; id < markers; ++id) {
      markers_.push_back(camera::draw_marker(request.dictionary, id, kMarkerSide));
    }
  }

  double at(double x_m, double y_m) const {
    const double pitch = request_.pitch_mm * 1e-3;
    if (request_.target == CalibrationTarget::kDots) {
      const double u = x_m / pitch, v = y_m / pitch;
      const double i = std::round(u), j = std::round(v);
      if (i < 0 || j < 0 || i >= request_.columns || j >= request_.rows) return 1;
      return std::hypot(u - i, v - j) * request_.pitch_mm < request_.dot_mm / 2 ? 0 : 1;
    }
    // The first inner corner is the origin.
    const double u = x_m / pitch + 1, v = y_m / pitch + 1;
    if (u < 0 || v < 0 || u >= request_.columns || v >= request_.rows) return 1;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    if ((column + row) % 2 == 0) return 0;
    if (markers_.empty()) return 1;
    const double share = camera::marker_share(request_);
    const double a = (u - column - (1 - share) / 2) / share,
                 b = (v - row - (1 - share) / 2) / share;
    if (a < 0 || b < 0 || a >= 1 || b >= 1) return 1;
    const int white_before = request_.columns / 2;
    const int odd = request_.columns % 2;
    // White squares of the rows above, and of this row to the left.
    const int above = row * white_before + odd * (row / 2);
    const int id = above + column / 2;
    const cv::Mat& marker = markers_[static_cast<std::size_t>(id)];
    return marker.at<uchar>(static_cast<int>(b * kMarkerSide), static_cast<int>(a * kMarkerSide)) /
           255.0;
  }

 private:
  static constexpr int kMarkerSide = 48;
  CalibrateRequest request_;
  std::vector<cv::Mat> markers_;
};

struct TargetScene {
  double black = 40, white = 200, noise = 2, blur_px = 0.6;
  // What the light falls by from the picture's left to its right, and from its top to its bottom,
  // as a share of that at the top left.
  double falls_along_x = 0, falls_along_y = 0;

  double light(double x_share, double y_share) const {
    return 1 - falls_along_x * x_share - falls_along_y * y_share;
  }
};

// The plane of motion: its axes are the turn's columns.
struct PlanePose {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position;
};

inline PlanePose plane_of(const Camera& camera) {
  using P = CameraParameter;
  const Eigen::Vector3d vector(camera[P::kRotationX], camera[P::kRotationY], camera[P::kRotationZ]);
  PlanePose pose;
  if (vector.norm() > 0) {
    pose.turn = Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
  }
  pose.position = {camera[P::kPositionX], camera[P::kPositionY], camera[P::kPositionZ]};
  return pose;
}

// Cells along a side of a pixel: the lens blurs what is then integrated over pixels.
inline constexpr int kCells = 3;

// The mean of `level` over each of a pixel's cells, by offsets from the pixel's middle. Offsets of
// Hammersley sets: along either axis all are different, so that an edge along the pixels is no
// worse than another one.
template <typename Level>
std::array<double, kCells * kCells> means_over_cells(const Level& level) {
  std::array<double, kCells * kCells> means;
  means.fill(level(Eigen::Vector2d(0, 0)));
  bool uniform = true;
  for (const double y : {-0.5, 0.0, 0.5}) {
    for (const double x : {-0.5, 0.0, 0.5}) {
      uniform = uniform && level(Eigen::Vector2d(x, y)) == means[0];
    }
  }
  if (uniform) return means;
  constexpr unsigned kPoints = 64, kBits = 6;
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const Eigen::Vector2d corner(cell % kCells, cell / kCells);
    double sum = 0;
    for (unsigned i = 0; i < kPoints; ++i) {
      unsigned turned = 0;
      for (unsigned bit = 0; bit < kBits; ++bit) turned |= (i >> bit & 1U) << (kBits - 1 - bit);
      const Eigen::Vector2d within((i + 0.5) / kPoints, (turned + 0.5) / kPoints);
      sum += level((corner + within) / kCells - Eigen::Vector2d(0.5, 0.5));
    }
    means[static_cast<std::size_t>(cell)] = sum / kPoints;
  }
  return means;
}

// `camera`: its plane is where the target lies.
inline cv::Mat render_levels(const Camera& camera, const TargetPattern& pattern,
                             const TargetScene& scene) {
  const camera::Lens lens(camera);
  const auto [turn, position] = plane_of(camera);
  // A line of sight (a, b, 1) meets the plane at (u, v): a homography.
  Eigen::Matrix3d to_sight;
  to_sight << turn.col(0), turn.col(1), position;
  const Eigen::Matrix3d to_target = to_sight.inverse();
  cv::Mat fine(camera.height * kCells, camera.width * kCells, CV_32F);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      Eigen::Matrix2d slope;
      const Eigen::Vector2d middle = lens.direction(Eigen::Vector2d(x, y), &slope);
      const auto shares = means_over_cells([&](const Eigen::Vector2d& off) {
        const Eigen::Vector2d direction = middle + slope * off;
        const Eigen::Vector3d at = to_target * Eigen::Vector3d(direction.x(), direction.y(), 1);
        return pattern.at(at.x() / at.z(), at.y() / at.z());
      });
      const double light = scene.light(double(x) / camera.width, double(y) / camera.height);
      for (int cell = 0; cell < kCells * kCells; ++cell) {
        const double share = shares[static_cast<std::size_t>(cell)];
        fine.at<float>(y * kCells + cell / kCells, x * kCells + cell % kCells) =
            static_cast<float>(light * (scene.black + (scene.white - scene.black) * share));
      }
    }
  }
  if (scene.blur_px > 0) cv::GaussianBlur(fine, fine, {0, 0}, scene.blur_px * kCells);
  cv::Mat picture;
  cv::resize(fine, picture, {camera.width, camera.height}, 0, 0, cv::INTER_AREA);
  return picture;
}

inline Frame render_target(const Camera& camera, const TargetPattern& pattern,
                           const TargetScene& scene, unsigned seed) {
  const cv::Mat picture = render_levels(camera, pattern, scene);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, scene.noise);
  Frame frame;
  frame.reset(camera.width, camera.height, 8);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double level = picture.at<float>(y, x) + (scene.noise > 0 ? noise(random) : 0.0);
      frame.u8(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0l, 255l));
    }
  }
  return frame;
}

// A camera and the poses in which it films the target: spread over the picture and tilted.
struct RandomCalibration {
  std::vector<Camera> views;  // the first has the plane of motion
};

inline RandomCalibration random_calibration(const CalibrateRequest& request, int pictures,
                                            unsigned seed) {
  using P = CameraParameter;
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Camera camera;
  camera.width = 400;
  camera.height = 300;
  const double focal = uniform(600, 1600);
  camera[P::kFx] = camera[P::kFy] = focal;
  camera[P::kCx] = 199.5 + uniform(-10, 10);
  camera[P::kCy] = 149.5 + uniform(-10, 10);
  // Up to 3 % at the corner, 250 px from the middle, and a little of the higher terms.
  const double corner = std::pow(250 / focal, 2);
  camera[P::kK1] = uniform(-0.03, 0.03) / corner;
  camera[P::kK2] = uniform(-0.005, 0.005) / (corner * corner);
  camera[P::kP1] = uniform(-0.002, 0.002) / std::sqrt(corner);
  camera[P::kP2] = uniform(-0.002, 0.002) / std::sqrt(corner);
  const double pitch = request.pitch_mm * 1e-3;
  const int inner = request.target == CalibrationTarget::kDots ? 1 : 2;
  const Eigen::Vector2d middle((request.columns - inner) * pitch / 2,
                               (request.rows - inner) * pitch / 2);
  const double wide = (request.columns + 0.5) * pitch;
  RandomCalibration made;
  for (int i = 0; i < pictures; ++i) {
    Camera view = camera;
    const double tilt = i == 0 ? uniform(0, 0.1) : uniform(0.1, 0.7), about = uniform(0, 2 * kPi);
    const Eigen::AngleAxisd leaning(tilt, Eigen::Vector3d(std::cos(about), std::sin(about), 0));
    const Eigen::AngleAxisd turned(uniform(-0.3, 0.3), Eigen::Vector3d::UnitZ());
    const Eigen::AngleAxisd turn(leaning * turned);
    const Eigen::Vector3d vector = turn.angle() * turn.axis();
    const double share = i == 0 ? 0.85 : uniform(0.45, 0.8);  // of the picture's width
    const double depth = focal * wide / (share * camera.width);
    const double free_x = (1 - share) / 2, free_y = std::max(0.0, 0.5 - 0.37 * share * 400 / 300);
    // One after the other: in which order arguments are drawn is the compiler's choice.
    const double down = uniform(-free_y, free_y), aside = uniform(-free_x, free_x);
    const Eigen::Vector3d centre(depth * aside * camera.width / focal,
                                 depth * down * camera.height / focal, depth);
    const Eigen::Vector3d position =
        centre - turn.toRotationMatrix() * Eigen::Vector3d(middle.x(), middle.y(), 0);
    for (int k = 0; k < 3; ++k) {
      view.values[9 + static_cast<std::size_t>(k)] = vector[k];
      view.values[12 + static_cast<std::size_t>(k)] = position[k];
    }
    made.views.push_back(view);
  }
  return made;
}

// Where the camera shows the target's points.
inline std::vector<Eigen::Vector2d> project_target(const Camera& camera,
                                                   const camera::BoardPoints& board) {
  const camera::Lens lens(camera);
  const auto [turn, position] = plane_of(camera);
  std::vector<Eigen::Vector2d> seen;
  for (const Eigen::Vector2d& point : board) {
    const Eigen::Vector3d at = turn.leftCols<2>() * point + position;
    seen.push_back(lens.project(at.head<2>() / at.z()));
  }
  return seen;
}

// A checkerboard or a grid of dots may be found upside down, and a part of a grid of dots some rows
// aside, which is as good: its points named as the camera's own pose names them, all turned and
// shifted alike. Points that do not follow are left as they are.
inline void turn_back(const Camera& camera, const camera::BoardPoints& board, int columns,
                      std::vector<camera::Sighting>& seen) {
  if (seen.empty()) return;
  const std::vector<Eigen::Vector2d> exact = project_target(camera, board);
  const int rows = static_cast<int>(board.size()) / columns;
  const auto cell = [&](std::size_t point) {
    return Eigen::Vector2i(static_cast<int>(point) % columns, static_cast<int>(point) / columns);
  };
  const auto nearest = [&](const Eigen::Vector2d& at) {
    const auto off = [&](const Eigen::Vector2d& one) { return (one - at).squaredNorm(); };
    return static_cast<std::size_t>(
        std::min_element(exact.begin(), exact.end(),
                         [&](const auto& a, const auto& b) { return off(a) < off(b); }) -
        exact.begin());
  };
  // Which quarter turn most steps from the first point follow.
  const Eigen::Vector2i first = cell(seen.front().point), real = cell(nearest(seen.front().at_px));
  Eigen::Matrix2i turn = Eigen::Matrix2i::Identity(), best = turn;
  Eigen::Matrix2i quarter;
  quarter << 0, -1, 1, 0;
  std::ptrdiff_t most = -1;
  for (int k = 0; k < 4; ++k, turn = quarter * turn) {
    const auto follow = std::count_if(seen.begin(), seen.end(), [&](const auto& one) {
      return cell(nearest(one.at_px)) == real + turn * (cell(one.point) - first);
    });
    if (follow > most) most = follow, best = turn;
  }
  for (camera::Sighting& one : seen) {
    const Eigen::Vector2i at = real + best * (cell(one.point) - first);
    if (at.x() < 0 || at.y() < 0 || at.x() >= columns || at.y() >= rows) continue;
    one.point = static_cast<std::size_t>(at.y() * columns + at.x());
  }
}

}  // namespace impactdic::testing
