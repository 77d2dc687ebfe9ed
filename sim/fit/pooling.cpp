#include "sim/fit/pooling.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdio>

#include "host/base/statistics.h"

namespace impactdic::sim::fit {
namespace {

constexpr std::size_t kFewestForTrend = 5;
// Speeds, or angles, closer together than this part of their range of interest show no trend.
constexpr double kLeastSpread = 0.1, kLeastSpread_deg = 3;
constexpr double kTrendIsReal = 1e-3;  // chance finds one of a thousand

struct Weighted {
  double mean = 0, weights = 0, chi_square = 0;
};

Weighted weigh(const std::vector<double>& values, const std::vector<double>& sds, double between) {
  Weighted w;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double weight = 1 / (sds[i] * sds[i] + between * between);
    w.weights += weight, w.mean += weight * values[i];
  }
  w.mean /= w.weights;
  for (std::size_t i = 0; i < values.size(); ++i) {
    w.chi_square += std::pow(values[i] - w.mean, 2) / (sds[i] * sds[i] + between * between);
  }
  return w;
}

// Twice the negative restricted log-likelihood, but for constants.
double restricted(const std::vector<double>& values, const std::vector<double>& sds,
                  double between) {
  const Weighted w = weigh(values, sds, between);
  double sum = w.chi_square + std::log(w.weights);
  for (const double sd : sds) sum += std::log(sd * sd + between * between);
  return sum;
}

// Where the chi square about the weighted mean falls to `wanted` as the scatter grows.
double scatter_of_chi_square(const std::vector<double>& values, const std::vector<double>& sds,
                             double wanted) {
  const auto excess = [&](double between) {
    return weigh(values, sds, between).chi_square - wanted;
  };
  if (excess(0) <= 0) return 0;
  double high = *std::max_element(sds.begin(), sds.end());
  while (excess(high) > 0) high *= 2;
  std::uintmax_t most = 200;
  const auto [a, b] = boost::math::tools::toms748_solve(
      excess, 0.0, high, boost::math::tools::eps_tolerance<double>(40), most);
  return (a + b) / 2;
}

// Of the shots that determine the parameter.
struct Column {
  std::vector<double> values, sds, scale_parts, rate_parts, speeds, incidences_deg;
};

Column column_of(const std::vector<ShotFit>& shots, std::size_t index) {
  constexpr double kDegPerRad = 57.29577951308232;
  Column c;
  for (const ShotFit& shot : shots) {
    const ParameterEstimate& p = shot.parameters[index];
    if (!(p.determined && p.sd > 0)) continue;
    // What all shots have in common does not tell them apart.
    const double common = p.scale_part * p.scale_part + p.rate_part * p.rate_part;
    c.values.push_back(p.value);
    c.sds.push_back(std::sqrt(std::max(p.sd * p.sd - common, 1e-6 * p.sd * p.sd)));
    c.scale_parts.push_back(p.scale_part), c.rate_parts.push_back(p.rate_part);
    const double vt = shot.shot.before.vt_m_s.value, vn = shot.shot.before.vn_m_s.value;
    c.speeds.push_back(std::hypot(vt, vn));
    c.incidences_deg.push_back(std::atan2(std::abs(vt), std::abs(vn)) * kDegPerRad);
  }
  return c;
}

double mean_of(const std::vector<double>& parts, const Column& c, double between, double weights) {
  double sum = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    sum += parts[i] / (c.sds[i] * c.sds[i] + between * between) / weights;
  }
  return sum;
}

ParameterTrend trend(const Column& c, const std::vector<double>& over, const char* name) {
  double weights = 0, x = 0, y = 0;
  for (std::size_t i = 0; i < over.size(); ++i) {
    const double w = 1 / (c.sds[i] * c.sds[i]);
    weights += w, x += w * over[i], y += w * c.values[i];
  }
  x /= weights, y /= weights;
  double xx = 0, xy = 0, chi_square = 0;
  for (std::size_t i = 0; i < over.size(); ++i) {
    const double w = 1 / (c.sds[i] * c.sds[i]);
    xx += w * (over[i] - x) * (over[i] - x), xy += w * (over[i] - x) * (c.values[i] - y);
  }
  ParameterTrend t{name, xy / xx, 0, 1};
  for (std::size_t i = 0; i < over.size(); ++i) {
    const double off = c.values[i] - y - t.slope * (over[i] - x);
    chi_square += off * off / (c.sds[i] * c.sds[i]);
  }
  const double freedom = static_cast<double>(over.size()) - 2;
  t.sd = std::sqrt(std::max(1.0, chi_square / freedom) / xx);
  const boost::math::students_t student(freedom);
  t.p_value = 2 * boost::math::cdf(boost::math::complement(student, std::abs(t.slope) / t.sd));
  return t;
}

void add_trends(PooledEstimate& pooled, const Column& c) {
  if (c.values.size() < kFewestForTrend) return;
  const auto spread = [](const std::vector<double>& v) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    return *high - *low;
  };
  const double fastest = *std::max_element(c.speeds.begin(), c.speeds.end());
  if (spread(c.speeds) > kLeastSpread * fastest) {
    pooled.trends.push_back(trend(c, c.speeds, "speed_m_s"));
  }
  if (spread(c.incidences_deg) > kLeastSpread_deg) {
    pooled.trends.push_back(trend(c, c.incidences_deg, "incidence_deg"));
  }
  for (const ParameterTrend& t : pooled.trends) {
    if (t.p_value > kTrendIsReal) continue;
    char text[200];
    std::snprintf(text, sizeof text,
                  "%s changes with %s: %.3g +- %.2g per unit (p %.1e); one value does not hold for "
                  "all shots",
                  pooled.key.c_str(), t.over.c_str(), t.slope, t.sd, t.p_value);
    pooled.warnings.emplace_back(text);
  }
}

void add_weighted(PooledEstimate& pooled, const Column& c) {
  pooled.value = pooled.sd = pooled.ci95_low = pooled.ci95_high = kNotMeasured;
  pooled.between_sd = pooled.between_ci95_low = pooled.between_ci95_high = kNotMeasured;
  const std::size_t count = c.values.size();
  if (count == 0) return;
  double between = 0, widening = 1, quantile = kNormal95;
  if (count > 1) {
    const Between found = scatter_between(c.values, c.sds);
    pooled.between_sd = between = found.sd;
    pooled.between_ci95_low = found.ci95_low, pooled.between_ci95_high = found.ci95_high;
    const double freedom = static_cast<double>(count - 1);
    pooled.chi_square = weigh(c.values, c.sds, 0).chi_square;
    // Hartung and Knapp: the deviation of the mean is known from so few shots only.
    widening = std::sqrt(std::max(1.0, weigh(c.values, c.sds, between).chi_square / freedom));
    quantile = boost::math::quantile(boost::math::students_t(freedom), 0.975);
    // Shots that agree as their deviations say need not tell the deviation anew.
    if (between == 0) quantile = kNormal95;
  }
  const Weighted w = weigh(c.values, c.sds, between);
  const double own = widening / std::sqrt(w.weights);
  const double common = std::hypot(mean_of(c.scale_parts, c, between, w.weights),
                                   mean_of(c.rate_parts, c, between, w.weights));
  pooled.value = w.mean;
  pooled.sd = std::hypot(own, common);
  const double half = std::hypot(quantile * own, kNormal95 * common);
  pooled.ci95_low = w.mean - half, pooled.ci95_high = w.mean + half;
}

void add_outliers(PooledEstimate& pooled, const std::vector<ShotFit>& shots, std::size_t index,
                  double outlier_sd) {
  std::vector<double> values, off;
  for (const ShotFit& shot : shots) values.push_back(shot.parameters[index].value);
  const double middle = median(values);
  for (const double v : values) off.push_back(std::abs(v - middle));
  const double spread = kSdOfMad * median(off);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double own = shots[i].parameters[index].sd;
    const double allowed = std::hypot(spread, std::isnan(own) ? 0 : own);
    if (values.size() >= 4 && off[i] > outlier_sd * allowed) {
      pooled.outliers.push_back(shots[i].shot.file);
    }
  }
}

}  // namespace

Between scatter_between(const std::vector<double>& values, const std::vector<double>& sds) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double most = std::max(*high - *low, *std::max_element(sds.begin(), sds.end()));
  const auto [at, least] = boost::math::tools::brent_find_minima(
      [&](double between) { return restricted(values, sds, between); }, 0.0, most, 40);
  Between found;
  if (least < restricted(values, sds, 0) - 1e-9) found.sd = at;
  const boost::math::chi_squared chi(static_cast<double>(values.size() - 1));
  found.ci95_low = scatter_of_chi_square(values, sds, boost::math::quantile(chi, 0.975));
  found.ci95_high = scatter_of_chi_square(values, sds, boost::math::quantile(chi, 0.025));
  return found;
}

PooledEstimate pool(const std::vector<ShotFit>& shots, std::size_t index, double outlier_sd) {
  PooledEstimate pooled;
  pooled.key = shots[0].parameters[index].key;
  const auto count = static_cast<double>(shots.size());
  for (const ShotFit& shot : shots) pooled.mean += shot.parameters[index].value / count;
  for (const ShotFit& shot : shots) {
    pooled.scatter_sd += std::pow(shot.parameters[index].value - pooled.mean, 2);
  }
  pooled.scatter_sd = count > 1 ? std::sqrt(pooled.scatter_sd / (count - 1)) : kNotMeasured;
  const Column c = column_of(shots, index);
  add_weighted(pooled, c);
  add_trends(pooled, c);
  pooled.determined =
      !c.values.empty() || std::all_of(shots.begin(), shots.end(), [&](const ShotFit& shot) {
        return shot.parameters[index].determined;
      });
  add_outliers(pooled, shots, index, outlier_sd);
  return pooled;
}

}  // namespace impactdic::sim::fit
