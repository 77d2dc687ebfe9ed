// Flights of uniform velocity through a lens with 1 % of distortion, corrected by a camera that is
// known only by a calibration of rendered pictures: how constant the speed becomes, and how
// straight the path; and what the calibrations' covariances expect of that.
//   calibrated_flight TARGET PICTURES CALIBRATIONS [FIRST]
#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "host/camera/correct_rows.h"
#include "host/camera/spread.h"
#include "host/dic/rim_margin.h"
#include "tests/support/camera/rendered_calibration.h"
#include "tests/support/camera/through_lens.h"

namespace {

using namespace impactdic;

// Views of 400 x 300 px through a lens that moves the corners by 1 %.
std::vector<Camera> views_of(const CalibrateRequest& request, int pictures, unsigned seed) {
  using P = CameraParameter;
  std::vector<Camera> views = testing::random_calibration(request, pictures, seed).views;
  for (Camera& view : views) {
    const double corner = std::pow(250 / view[P::kFx], 2);
    view[P::kK1] = (seed % 2 == 0 ? 0.01 : -0.01) / corner;
    view[P::kK2] = view[P::kP1] = view[P::kP2] = 0;
  }
  return views;
}

// A ball of 90 px that crosses the picture in 40 frames.
std::vector<TrackRow> flight() {
  std::vector<TrackRow> rows;
  for (int i = 0; i < 40; ++i) {
    TrackRow row;
    row.frame = i;
    row.circle_ok = row.motion_ok = true;
    row.cx_px = 60 + 7 * i, row.cy_px = 60 + 4.5 * i, row.r_px = 45;
    row.cx_sd_px = row.cy_sd_px = row.r_sd_px = row.dx_sd_px = row.dy_sd_px = 0.01;
    row.rot_sd_deg = 0.001;
    row.dx_px = 7, row.dy_px = 4.5, row.rot_deg = 2;
    rows.push_back(row);
  }
  return rows;
}

struct Errors {
  double speed_spread_px = 0;  // largest less least speed on the way, a frame
  double centre_px = 0;        // rms, from the straight uniform path that is nearest
  double scale = 0;            // of the speed's mean, relative
};

// Each coordinate against the straight line of least squares over the frames.
double off_line(const std::vector<TrackRow>& rows, double TrackRow::*coordinate) {
  const auto n = static_cast<double>(rows.size());
  double t = 0, x = 0, tt = 0, tx = 0, off = 0;
  for (const TrackRow& row : rows) t += row.frame / n, x += row.*coordinate / n;
  for (const TrackRow& row : rows) {
    tt += (row.frame - t) * (row.frame - t), tx += (row.frame - t) * (row.*coordinate - x);
  }
  for (const TrackRow& row : rows) {
    off += std::pow(row.*coordinate - x - tx / tt * (row.frame - t), 2);
  }
  return off / n;
}

Errors errors_of(const Camera& truth, const Camera& found) {
  const double scale = camera::PlaneView(truth).metre_per_px();
  const std::vector<TrackRow> rows = testing::through_lens(truth, flight(), scale);
  const auto back = camera::RowCorrection(found, false, scale, dic::kRimMarginPx).correct(rows);
  double least = 1e9, most = 0, sum = 0;
  for (const TrackRow& row : back) {
    const double speed = std::hypot(row.dx_px, row.dy_px);
    least = std::min(least, speed), most = std::max(most, speed);
    sum += speed / static_cast<double>(back.size());
  }
  return {most - least,
          std::sqrt(off_line(back, &TrackRow::cx_px) + off_line(back, &TrackRow::cy_px)),
          sum / std::hypot(7, 4.5) - 1};
}

constexpr double kSpeedLimit_px = 0.0005, kPathLimit_px = 0.012;  // that must hold

// A camera drawn by the covariance of another.
Camera drawn(const Camera& mean, const std::vector<camera::CameraStep>& steps,
             std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  Camera one = mean;
  for (const camera::CameraStep& step : steps) {
    const double by = normal(random) / (2 * step.deviations);
    for (std::size_t p = 0; p < kCameraParameters; ++p) {
      one.values[p] += by * (step.plus.values[p] - step.minus.values[p]);
    }
  }
  return one;
}

// Speed spreads of such cameras, were the camera that was found the true one; ascending.
std::vector<double> expected_spreads(const Camera& found) {
  constexpr int kCameras = 200;
  std::mt19937 random(1);
  const std::vector<camera::CameraStep> steps = camera::principal_steps(found);
  std::vector<double> spreads;
  for (int i = 0; i < kCameras; ++i) {
    spreads.push_back(errors_of(found, drawn(found, steps, random)).speed_spread_px);
  }
  std::sort(spreads.begin(), spreads.end());
  return spreads;
}

std::ptrdiff_t within(const std::vector<double>& sorted, double limit) {
  return std::upper_bound(sorted.begin(), sorted.end(), limit) - sorted.begin();
}

}  // namespace

int main(int argc, char** argv) {
  const CalibrateRequest request =
      testing::rendered_target(parse_calibration_target(argc > 1 ? argv[1] : "charuco"));
  const int pictures = argc > 2 ? std::atoi(argv[2]) : 15;
  const int calibrations = argc > 3 ? std::atoi(argv[3]) : 5;
  const unsigned first = argc > 4 ? static_cast<unsigned>(std::atoi(argv[4])) : 1;
  std::vector<double> spreads, centres, all_expected;
  for (unsigned seed = first; seed < first + static_cast<unsigned>(calibrations); ++seed) {
    try {
      const std::vector<Camera> views = views_of(request, pictures, seed);
      const auto pictures = testing::rendered_pictures(request, views, seed * 100);
      const CalibrateResult found = testing::calibrate_rendered(request, pictures);
      const Errors errors = errors_of(views[0], found.camera);
      const std::vector<double> expected = expected_spreads(found.camera);
      std::printf(
          "%u: speed constant to %.5f px a frame (expected: median %.5f, %.0f %% within %g), path "
          "straight to %.4f px, scale %+.1e; points scatter by %.4f px, terms %s\n",
          seed, errors.speed_spread_px, expected[expected.size() / 2],
          100.0 * static_cast<double>(within(expected, kSpeedLimit_px)) /
              static_cast<double>(expected.size()),
          kSpeedLimit_px, errors.centre_px, errors.scale, found.point_sd_px, found.terms.c_str());
      std::fflush(stdout);
      all_expected.insert(all_expected.end(), expected.begin(), expected.end());
      spreads.push_back(errors.speed_spread_px), centres.push_back(errors.centre_px);
    } catch (const Error& error) {
      std::printf("%u: %s\n", seed, error.line().c_str());
    }
  }
  if (spreads.empty()) return 1;
  std::sort(spreads.begin(), spreads.end()), std::sort(centres.begin(), centres.end());
  std::sort(all_expected.begin(), all_expected.end());
  const auto count = static_cast<double>(all_expected.size());
  std::printf(
      "of %zu: speed median %.5f, worst %.5f, %td within %g; path median %.4f, worst %.4f, %td "
      "within %g px\n"
      "expected: speed median %.5f, %.1f %% within %g\n",
      spreads.size(), spreads[spreads.size() / 2], spreads.back(), within(spreads, kSpeedLimit_px),
      kSpeedLimit_px, centres[centres.size() / 2], centres.back(), within(centres, kPathLimit_px),
      kPathLimit_px, all_expected[all_expected.size() / 2],
      100 * static_cast<double>(within(all_expected, kSpeedLimit_px)) / count, kSpeedLimit_px);
}
