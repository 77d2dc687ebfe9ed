#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "host/study/density_study.h"

namespace impactdic::study {
namespace {

std::string cell(double value) { return std::isfinite(value) ? shortest(value) : ""; }

std::vector<const DensityRow*> of_method(std::span<const DensityRow> rows,
                                         const std::string& method) {
  std::vector<const DensityRow*> found;
  for (const DensityRow& row : rows) {
    if (row.method == method) found.push_back(&row);
  }
  return found;
}

// Slope of the least-squares line through (x, y).
double slope_of(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
  }
  const auto n = static_cast<double>(x.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double growth(const std::vector<const DensityRow*>& rows, int window_px) {
  std::vector<double> x, y;
  for (const DensityRow* row : rows) {
    const double samples = (window_px - 1) * (row->points + 1) + 1;
    x.push_back(std::log(samples * samples * std::log(samples)));
    y.push_back(std::log(row->us_per_window));
  }
  return slope_of(x, y);
}

std::ofstream open(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw FileError("cannot write the file", path.string());
  return file;
}

void close(std::ofstream& file, const std::filesystem::path& path) {
  file.flush();
  if (!file) throw FileError("cannot write the file", path.string(), "is the disk full?");
}

}  // namespace

void write_density_csv(const std::filesystem::path& path, std::span<const DensityRow> rows) {
  std::ofstream file = open(path);
  file << "points,method,us_per_window,rms_px,bias_x_px,bias_y_px,same_lag_share\n";
  for (const DensityRow& row : rows) {
    file << row.points << ',' << row.method << ',' << cell(row.us_per_window) << ','
         << cell(row.rms_px) << ',' << cell(row.bias_x_px) << ',' << cell(row.bias_y_px) << ','
         << cell(row.same_lag_share) << '\n';
  }
  close(file, path);
}

void write_window_csv(const std::filesystem::path& path, const Image<double>& picture,
                      double step_px) {
  std::ofstream file = open(path);
  file << "x_px,y_px,grey\n";
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      file << shortest(x * step_px) << ',' << shortest(y * step_px) << ','
           << shortest(picture(x, y)) << '\n';
    }
  }
  close(file, path);
}

nlohmann::json describe_density(std::span<const DensityRow> rows, int window_px) {
  const auto literal = of_method(rows, "literal"), ours = of_method(rows, "published"),
             plain = of_method(rows, "icgn");
  const auto quickest = [](const DensityRow* a, const DensityRow* b) {
    return a->us_per_window < b->us_per_window;
  };
  const auto [least, most] = std::minmax_element(plain.begin(), plain.end(), quickest);
  double same = 1, smallest = literal.front()->rms_px;
  for (const DensityRow* row : ours) same = std::min(same, row->same_lag_share);
  for (const DensityRow* row : literal) smallest = std::min(smallest, row->rms_px);
  nlohmann::json summary = {
      {"same_lag_share", same},
      {"default_spread", (*most)->us_per_window / (*least)->us_per_window},
      {"literal_slowdown", literal.back()->us_per_window / literal.front()->us_per_window},
      {"published_slowdown", ours.back()->us_per_window / ours.front()->us_per_window}};
  if (literal.size() > 2) summary["literal_growth"] = growth(literal, window_px);
  char text[400];
  std::snprintf(text, sizeof text,
                "Spline points do not help the published method below %.3f px, its bias: at %d of "
                "them literal upsampling takes %.1f times as long as without; the default method "
                "errs by %.4f px a window and has no such number.",
                smallest, literal.back()->points,
                literal.back()->us_per_window / literal.front()->us_per_window,
                plain.front()->rms_px);
  summary["finding"] = text;
  return summary;
}

}  // namespace impactdic::study
