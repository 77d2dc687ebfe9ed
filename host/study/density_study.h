// Figures 2.1 and 2.2 of the source: time and error against the number of spline points between
// pixels, for the published method as it is described, for the same by our route, and for the
// default method, which has no such number.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "host/base/progress.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::study {

struct DensityStudyOptions {
  std::string pattern = "e1";
  double dx_px = 0.37, dy_px = -0.61;  // on no grid of 1/(N + 1) px
  double noise = 2;                    // grey levels of 255
  double radius_px = 115;
  std::uint64_t seed = 1;
  int windows = 48;     // measured one by one by the literal method
  int repeats = 3;      // the shortest time counts
  int most_points = 9;  // N = 0 … this
  int window_px = 15;
  void validate() const;  // throws InvalidArgument
};

// One method at one N.
struct DensityRow {
  int points = 0;
  std::string method;        // literal, published, icgn
  double us_per_window = 0;  // on the host's one core (literal), on the device (the others)
  double rms_px = 0, bias_x_px = 0, bias_y_px = 0;
  double same_lag_share = 0;  // windows that give the literal method's answer; NaN for icgn
};

struct DensityStudy {
  std::vector<DensityRow> rows;
  // A window of the first frame, as in Fig. 2.1: (window, window), and the same with 5 points
  // between pixels.
  Image<double> window, interpolated;
};

DensityStudy run_density_study(opencl::Engine& engine, const DensityStudyOptions& options,
                               const ProgressFn& progress);

// Throw FileError.
void write_density_csv(const std::filesystem::path& file, std::span<const DensityRow> rows);
// x_px,y_px,grey: the picture's samples every `step_px`, row by row.
void write_window_csv(const std::filesystem::path& file, const Image<double>& picture,
                      double step_px);

// growth: slope of ln(time) against ln(M² ln M), M = samples a side, 1 where the literal method
// costs what its transforms cost; spread: largest over smallest time of the default method;
// finding.
nlohmann::json describe_density(std::span<const DensityRow> rows, int window_px);

}  // namespace impactdic::study
