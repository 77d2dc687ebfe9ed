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

#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/find_target.h"
#include "tests/support/target_pictures.h"

namespace {

using namespace impactdic;

CalibrateRequest request_of(const std::string& target) {
  CalibrateRequest request;
  request.pictures = {"rendered"};
  request.target = parse_calibration_target(target);
  request.columns = 9;
  request.rows = 7;
  request.pitch_mm = 10;
  request.dot_mm = 4.5;
  return request;
}

camera::View noisy_points(const Camera& view, const CalibrateRequest& request, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.05);
  camera::View seen;
  for (const Eigen::Vector2d& at : testing::project_target(view, camera::board_points(request))) {
    seen.seen.push_back({seen.seen.size(), at + Eigen::Vector2d(noise(random), noise(random))});
  }
  return seen;
}

// Of the points that were found, along one axis.
double rms_error(const camera::View& seen, const Camera& view, const CalibrateRequest& request) {
  const auto exact = testing::project_target(view, camera::board_points(request));
  double sum = 0;
  for (const camera::Sighting& sighting : seen.seen) {
    sum += (sighting.at_px - exact[sighting.point]).squaredNorm();
  }
  return std::sqrt(sum / 2 / static_cast<double>(seen.seen.size()));
}

}  // namespace

int main(int argc, char** argv) {
  const CalibrateRequest request = request_of(argc > 1 ? argv[1] : "checkerboard");
  const int calibrations = argc > 2 ? std::atoi(argv[2]) : 20;
  const unsigned first = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1;
  const bool points = argc > 4 && std::string(argv[4]) == "points";
  const testing::TargetPattern pattern(request);
  std::array<int, kCameraParameters> within{}, stated{};
  std::array<double, kCameraParameters> squares{};
  for (unsigned seed = first; seed < first + static_cast<unsigned>(calibrations); ++seed) {
    const int pictures = 5 + static_cast<int>(seed * 7 % 26);
    const testing::RandomCalibration made = testing::random_calibration(request, pictures, seed);
    std::vector<camera::View> views;
    double off = 0;
    for (std::size_t i = 0; i < made.views.size(); ++i) {
      const unsigned noise = seed * 100 + static_cast<unsigned>(i);
      camera::View view;
      if (points) {
        view = noisy_points(made.views[i], request, noise + 1);
      } else {
        const Frame frame = testing::render_target(made.views[i], pattern, {}, noise);
        view.seen = camera::find_target(camera::to_grey(frame), request);
        if (request.target != CalibrationTarget::kCharuco) {
          testing::turn_back(made.views[i], camera::board_points(request), view.seen);
        }
        if (!view.seen.empty()) off = std::max(off, rms_error(view, made.views[i], request));
      }
      view.picture = std::to_string(i);
      views.push_back(std::move(view));
    }
    try {
      const CalibrateResult found =
          camera::calibrate_points(request, views, made.views[0].width, made.views[0].height);
      const Camera& truth = made.views[0];
      std::string outside;
      std::size_t used = 0;
      for (const CalibrationPicture& picture : found.pictures) used += picture.used;
      for (std::size_t p = 0; p < kCameraParameters; ++p) {
        const auto parameter = static_cast<CameraParameter>(p);
        const double sd = std::sqrt(found.camera.variance(parameter));
        if (sd == 0) continue;
        const double z = (found.camera[parameter] - truth[parameter]) / sd;
        ++stated[p];
        squares[p] += z * z;
        if (std::abs(z) <= 2)
          ++within[p];
        else
          outside += std::string(" ") + to_string(parameter) + "(" + std::to_string(z) + ")";
      }
      std::printf("%u: %zu of %d pictures, scatter %.4f px, worst %.3f, terms %s; outside:%s\n",
                  seed, used, pictures, found.point_sd_px, off, found.terms.c_str(),
                  outside.c_str());
    } catch (const Error& error) {
      std::printf("%u: %s\n", seed, error.line().c_str());
    }
  }
  int all = 0, all_within = 0;
  for (std::size_t p = 0; p < kCameraParameters; ++p) {
    if (stated[p] == 0) continue;
    std::printf("%-16s %d of %d within two deviations, rms %.2f deviations\n",
                to_string(static_cast<CameraParameter>(p)), within[p], stated[p],
                std::sqrt(squares[p] / stated[p]));
    all += stated[p], all_within += within[p];
  }
  std::printf("all parameters: %.1f %%\n", 100.0 * all_within / std::max(all, 1));
}
