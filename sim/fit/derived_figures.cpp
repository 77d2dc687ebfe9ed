#include "sim/fit/derived_figures.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/contact/impact.h"

namespace impactdic::sim::fit {
namespace {

constexpr std::size_t kFigures = 5;
constexpr std::array<const char*, kFigures> kKeys{"restitution", "contact_s", "t_max_compression_s",
                                                  "max_deflection_m", "series_stiffness_n_per_m"};

// Of a shell and a surface that are linear springs.
bool has_series_stiffness(const ImpactJob& job) {
  return job.shell && job.normal == NormalModel::kLinearSpringDamper;
}

std::array<double, kFigures> figures(const ShotModel& model, const std::vector<double>& values) {
  const ImpactJob job = model.impact_of(values.data());
  const ImpactResult impact = contact::simulate_impact(job);
  const double series = has_series_stiffness(job)
                            ? 1 / (1 / job.contact.stiffness + 1 / job.shell->stiffness_n_per_m)
                            : 0;
  return {impact.restitution, impact.contact_s, impact.t_max_compression_s, impact.max_deflection_m,
          series};
}

}  // namespace

std::vector<DerivedFigure> derived_figures(const ShotModel& model,
                                           const std::vector<double>& values,
                                           const Eigen::MatrixXd& covariance) {
  const auto size = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd slope(static_cast<Eigen::Index>(kFigures), size);
  std::vector<double> moved = values;
  for (Eigen::Index u = 0; u < size; ++u) {
    const auto at = static_cast<std::size_t>(u);
    const Unknown& unknown = model.unknowns()[at];
    const double up = std::min(values[at] + unknown.step, unknown.upper);
    const double down = std::max(values[at] - unknown.step, unknown.lower);
    moved[at] = up;
    const auto high = figures(model, moved);
    moved[at] = down;
    const auto low = figures(model, moved);
    moved[at] = values[at];
    for (std::size_t f = 0; f < kFigures; ++f) {
      slope(static_cast<Eigen::Index>(f), u) = (high[f] - low[f]) / (up - down);
    }
  }
  const auto best = figures(model, values);
  std::vector<DerivedFigure> derived;
  const bool in_series = has_series_stiffness(model.impact_of(values.data()));
  for (std::size_t f = 0; f < (in_series ? kFigures : kFigures - 1); ++f) {
    const Eigen::RowVectorXd row = slope.row(static_cast<Eigen::Index>(f));
    double variance = 0;
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < size; ++j) {
        // An unknown that moves nothing may be as undetermined as it likes.
        if (row[i] != 0 && row[j] != 0) variance += row[i] * row[j] * covariance(i, j);
      }
    }
    derived.push_back(
        {kKeys[f], best[f],
         std::isfinite(variance) && variance >= 0 ? std::sqrt(variance) : kNotMeasured});
  }
  return derived;
}

}  // namespace impactdic::sim::fit
