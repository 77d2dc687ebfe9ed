#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "host/study/density_study.h"

namespace impactdic::study {
namespace {

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

}  // namespace

DensityFindings find_density(std::span<const DensityRow> rows, int window_px) {
  const auto literal = of_method(rows, "literal"), ours = of_method(rows, "published"),
             plain = of_method(rows, "icgn");
  const auto quickest = [](const DensityRow* a, const DensityRow* b) {
    return a->us_per_window < b->us_per_window;
  };
  const auto [least, most] = std::minmax_element(plain.begin(), plain.end(), quickest);
  double same = 1, smallest = literal.front()->rms_px;
  for (const DensityRow* row : ours) same = std::min(same, row->same_lag_share);
  for (const DensityRow* row : literal) smallest = std::min(smallest, row->rms_px);
  DensityFindings findings;
  findings.same_lag_share = same;
  findings.default_spread = (*most)->us_per_window / (*least)->us_per_window;
  findings.literal_slowdown = literal.back()->us_per_window / literal.front()->us_per_window;
  findings.published_slowdown = ours.back()->us_per_window / ours.front()->us_per_window;
  if (literal.size() > 2) findings.literal_growth = growth(literal, window_px);
  char text[400];
  std::snprintf(text, sizeof text,
                "Spline points do not help the published method below %.3f px, its bias: at %d of "
                "them literal upsampling takes %.1f times as long as without; the default method "
                "errs by %.4f px a window and has no such number.",
                smallest, literal.back()->points,
                literal.back()->us_per_window / literal.front()->us_per_window,
                plain.front()->rms_px);
  findings.finding = text;
  return findings;
}

}  // namespace impactdic::study
