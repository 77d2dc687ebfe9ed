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
#include "tests/support/camera/target_pictures.h"

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

// What the finder sees of a rendered picture of the target.
camera::View seen_in_picture(const Camera& truth, const testing::TargetPattern& pattern,
                             const CalibrateRequest& request, unsigned noise, double& worst_px) {
  camera::View view;
  const Frame frame = testing::render_target(truth, pattern, {}, noise);
  view.seen = camera::find_target(camera::to_grey(frame), request);
  if (request.target != CalibrationTarget::kCharuco) {
    testing::turn_back(truth, camera::board_points(request), view.seen);
  }
  if (!view.seen.empty()) worst_px = std::max(worst_px, rms_error(view, truth, request));
  return view;
}

void calibrate_one(const CalibrateRequest& request, const testing::TargetPattern& pattern,
                   unsigned seed, bool points, Tally& tally) {
  const int pictures = 5 + static_cast<int>(seed * 7 % 26);
  const testing::RandomCalibration made = testing::random_calibration(request, pictures, seed);
  std::vector<camera::View> views;
  double worst_px = 0;
  for (std::size_t i = 0; i < made.views.size(); ++i) {
    const unsigned noise = seed * 100 + static_cast<unsigned>(i);
    views.push_back(points ? noisy_points(made.views[i], request, noise + 1)
                           : seen_in_picture(made.views[i], pattern, request, noise, worst_px));
    views.back().picture = std::to_string(i);
  }
  try {
    const CalibrateResult found =
        camera::calibrate_points(request, views, made.views[0].width, made.views[0].height);
    std::size_t used = 0;
    for (const CalibrationPicture& picture : found.pictures) used += picture.used;
    const std::string outside = tally.add(found.camera, made.views[0]);
    std::printf("%u: %zu of %d pictures, scatter %.4f px, worst %.3f, terms %s; outside:%s\n", seed,
                used, pictures, found.point_sd_px, worst_px, found.terms.c_str(), outside.c_str());
  } catch (const Error& error) {
    std::printf("%u: %s\n", seed, error.line().c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const CalibrateRequest request = request_of(argc > 1 ? argv[1] : "checkerboard");
  const int calibrations = argc > 2 ? std::atoi(argv[2]) : 20;
  const unsigned first = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1;
  const bool points = argc > 4 && std::string(argv[4]) == "points";
  const testing::TargetPattern pattern(request);
  Tally tally;
  for (unsigned seed = first; seed < first + static_cast<unsigned>(calibrations); ++seed) {
    calibrate_one(request, pattern, seed, points, tally);
  }
  tally.print();
}
