// Calibrations of rendered pictures with a known camera: how often the truth lies within two stated
// deviations.
//
// camera_coverage TARGET CALIBRATIONS [FIRST [MODE]]: TARGET is checkerboard, charuco or dots; MODE
// points takes exact projections with noise in place of pictures.
#include <impactdic/error.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/camera/rendered_calibration.h"

namespace {

using namespace impactdic;

constexpr double kPointNoise_px = 0.05;

// Of the points that the calibration used, along one axis: from the nearest of the target's points
// as the true camera shows them.
double rms_error(const CalibrateResult& found, const std::vector<Camera>& views,
                 const CalibrateRequest& request) {
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto exact = testing::project_target(views[v], camera::board_points(request));
    for (const CalibrationPoint& point : found.points) {
      if (point.picture != v || !point.used) continue;
      double nearest = 1e9;
      for (const Eigen::Vector2d& at : exact) {
        nearest = std::min(nearest, (at - Eigen::Vector2d(point.x_px, point.y_px)).squaredNorm());
      }
      sum += nearest, count += 2;
    }
  }
  return std::sqrt(sum / count);
}

// How often the truth lies within two stated deviations, by parameter.
class Tally {
 public:
  // Returns the parameters that lie outside.
  std::string add(const Camera& found, const Camera& truth) {
    std::string outside;
    for (std::size_t p = 0; p < kCameraParameters; ++p) {
      const auto parameter = static_cast<CameraParameter>(p);
      const double sd = std::sqrt(found.variance(parameter));
      if (sd == 0) continue;
      const double z = (found[parameter] - truth[parameter]) / sd;
      ++stated_[p];
      squares_[p] += z * z;
      if (std::abs(z) <= 2) {
        ++within_[p];
      } else {
        outside += std::string(" ") + to_string(parameter) + "(" + std::to_string(z) + ")";
      }
    }
    return outside;
  }

  void print() const {
    int all = 0, all_within = 0;
    for (std::size_t p = 0; p < kCameraParameters; ++p) {
      if (stated_[p] == 0) continue;
      std::printf("%-16s %d of %d within two deviations, rms %.2f deviations\n",
                  to_string(static_cast<CameraParameter>(p)), within_[p], stated_[p],
                  std::sqrt(squares_[p] / stated_[p]));
      all += stated_[p], all_within += within_[p];
    }
    std::printf("all parameters: %.1f %%\n", 100.0 * all_within / std::max(all, 1));
  }

 private:
  std::array<int, kCameraParameters> within_{}, stated_{};
  std::array<double, kCameraParameters> squares_{};
};

void calibrate_one(const CalibrateRequest& request, unsigned seed, bool points, Tally& tally) {
  const int pictures = 5 + static_cast<int>(seed * 7 % 26);
  const std::vector<Camera> views = testing::random_calibration(request, pictures, seed).views;
  try {
    CalibrateResult found;
    if (points) {
      found = camera::calibrate_points(
          request, testing::noisy_views(request, views, kPointNoise_px, seed * 100), views[0].width,
          views[0].height);
    } else {
      found = testing::calibrate_rendered(request,
                                          testing::rendered_pictures(request, views, seed * 100));
    }
    std::size_t used = 0;
    for (const CalibrationPicture& picture : found.pictures) used += picture.used;
    const std::string outside = tally.add(found.camera, views[0]);
    std::printf(
        "%u: %zu of %d pictures, scatter %.4f px, off the truth by %.4f, terms %s; outside:%s\n",
        seed, used, pictures, found.point_sd_px, rms_error(found, views, request),
        found.terms.c_str(), outside.c_str());
  } catch (const Error& error) {
    std::printf("%u: %s\n", seed, error.line().c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const CalibrateRequest request =
      testing::rendered_target(parse_calibration_target(argc > 1 ? argv[1] : "checkerboard"));
  const int calibrations = argc > 2 ? std::atoi(argv[2]) : 20;
  const unsigned first = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1;
  const bool points = argc > 4 && std::string(argv[4]) == "points";
  Tally tally;
  for (unsigned seed = first; seed < first + static_cast<unsigned>(calibrations); ++seed) {
    calibrate_one(request, seed, points, tally);
  }
  tally.print();
}
