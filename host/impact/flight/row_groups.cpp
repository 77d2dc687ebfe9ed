#include "host/impact/flight/row_groups.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/impact/alike_in_a_row.h"

namespace impactdic::impact {
namespace {

// Of residuals over deviations.
struct Part {
  double n = 0, sum = 0, squares = 0;
  double about_mean() const { return squares - sum * sum / n; }
};

// By flight and axis.
std::array<Part, 4> parts_of(const std::vector<Datum>& data, const std::vector<double>& residuals,
                             DatumKind kind) {
  std::array<Part, 4> parts;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (!data[i].used || data[i].kind != kind) continue;
    Part& part = parts[static_cast<std::size_t>(2 * data[i].flight + (data[i].normal ? 1 : 0))];
    part.n += 1, part.sum += residuals[i], part.squares += residuals[i] * residuals[i];
  }
  return parts;
}

// Less the line through them, in order.
void remove_line(std::vector<double>& values) {
  const double middle = (static_cast<double>(values.size()) - 1) / 2;
  double sum = 0, moment = 0, spread = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    sum += values[i], moment += x * values[i], spread += x * x;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    values[i] -= sum / static_cast<double>(values.size()) + (spread > 0 ? moment / spread * x : 0);
  }
}

}  // namespace

void lean(std::vector<Datum>& data, DatumKind kind, double px, double scale) {
  for (Datum& d : data) {
    if (d.kind != kind) continue;
    d.group = 2 * d.flight + (d.normal ? 1 : 0);
    d.loose = px / (d.sd * scale);
  }
}

std::vector<double> own_residuals(const std::vector<Datum>& data,
                                  const std::vector<double>& residuals) {
  struct Sums {
    Eigen::Vector2d residual = Eigen::Vector2d::Zero();
    Eigen::Matrix2d square = Eigen::Matrix2d::Identity();
  };
  std::map<int, Sums> groups;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (data[i].group < 0 || !data[i].used) continue;
    const Eigen::Vector2d u = alike(data[i]);
    groups[data[i].group].residual += residuals[i] * u;
    groups[data[i].group].square += u * u.transpose();
  }
  std::map<int, Eigen::Vector2d> shared;
  for (const auto& [group, sums] : groups) shared[group] = sums.square.inverse() * sums.residual;
  std::vector<double> own = residuals;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto found = shared.find(data[i].group);
    if (found != shared.end()) own[i] -= alike(data[i]).dot(found->second);
  }
  return own;
}

double scatter_about_means(const std::vector<Datum>& data, const std::vector<double>& residuals,
                           DatumKind kind) {
  double n = 0, squares = 0;
  for (const Part& part : parts_of(data, residuals, kind)) {
    if (part.n > 0) n += part.n, squares += part.about_mean();
  }
  return n > 0 ? std::sqrt(squares / n) : 0;
}

double farthest_mean(const std::vector<Datum>& data, const std::vector<double>& residuals,
                     DatumKind kind, double deviations) {
  double farthest = 0;
  for (const Part& part : parts_of(data, residuals, kind)) {
    if (part.n < 2) continue;
    const double mean = std::abs(part.sum) / part.n;
    const double sd = std::sqrt(part.about_mean() / (part.n * (part.n - 1)));
    if (mean > deviations * sd) farthest = std::max(farthest, mean);
  }
  return farthest;
}

double alike_in_a_row(const std::vector<Datum>& data, const std::vector<double>& residuals,
                      DatumKind kind, bool sphere) {
  std::array<std::vector<double>, 4> rows;  // by flight and axis, in order
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Datum& d = data[i];
    if (!d.used || d.kind != kind) continue;
    rows[static_cast<std::size_t>(2 * d.flight + (d.normal ? 0 : 1))].push_back(residuals[i]);
  }
  double count = 0;
  for (auto& r : rows) {
    if (!sphere) remove_line(r);
    count += static_cast<double>(r.size());
  }
  return alike_in_a_row(rows, sphere ? 0.05 : beyond_chance(count));
}

}  // namespace impactdic::impact
