#include "host/impact/free_radius.h"

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"

namespace impactdic::impact {
namespace {

constexpr double kOutlier = 5;      // times the scatter
constexpr double kRounding = 1e-9;  // px

struct Radius {
  double px, sd;
  bool second;  // flight
};

void add(const std::vector<TrackRow>& rows, const FlightRange& range, bool second,
         std::vector<Radius>& radii) {
  for (std::size_t i = range.first; i <= range.last && i < rows.size(); ++i) {
    if (rows[i].circle_ok) radii.push_back({rows[i].r_px, rows[i].r_sd_px, second});
  }
}

void drop_outliers(std::vector<Radius>& radii) {
  std::vector<double> values, off;
  for (const Radius& r : radii) values.push_back(r.px);
  const double centre = upper_median(std::move(values));
  for (const Radius& r : radii) off.push_back(std::abs(r.px - centre));
  const double limit = kOutlier * kSdOfMad * upper_median(std::move(off)) + kRounding;
  std::erase_if(radii, [&](const Radius& r) { return std::abs(r.px - centre) > limit; });
}

struct Mean {
  double weight = 0, sum = 0;
  void add(double value, double w) { weight += w, sum += w * value; }
  double value() const { return sum / weight; }
};

FreeRadius mean_of(std::vector<Radius> radii) {
  FreeRadius result;
  if (radii.empty()) return result;
  drop_outliers(radii);
  std::vector<double> stated;
  for (const Radius& r : radii) stated.push_back(r.sd);
  // Frames without a deviation count as usual ones; none counts more than four usual ones.
  const double usual = upper_median(finite(std::move(stated)));
  const auto weight = [&](const Radius& r) {
    if (!(usual > 0)) return 1.0;
    const double sd = r.sd > 0 ? std::max(r.sd, usual / 2) : usual;
    return 1 / (sd * sd);
  };
  Mean all, flight[2], square;
  for (const Radius& r : radii) {
    all.add(r.px, weight(r));
    flight[r.second].add(r.px, weight(r));
  }
  for (const Radius& r : radii) {
    const double off = r.px - flight[r.second].value();
    square.add(off * off, weight(r));
  }
  const auto count = static_cast<double>(radii.size());
  const double scatter = count > 2 ? square.value() * count / (count - 2) : 0.0;
  const double shared = usual > 0 ? std::max(0.0, usual * usual - scatter) : 0.0;
  result.frames = radii.size();
  double apart = 0;
  if (flight[0].weight > 0 && flight[1].weight > 0) {
    result.drift = flight[1].value() - flight[0].value();
    apart = result.drift / 2;
  }
  result.px = {all.value(), std::sqrt(shared + std::max(scatter / count, apart * apart))};
  return result;
}

}  // namespace

FreeRadius free_radius(const std::vector<TrackRow>& rows, const FlightRange& before,
                       const FlightRange& after) {
  std::vector<Radius> radii;
  add(rows, before, false, radii);
  add(rows, after, true, radii);
  return mean_of(std::move(radii));
}

FreeRadius free_radius(const std::vector<TrackRow>& rows) {
  if (rows.empty()) return {};
  const std::size_t half = rows.size() / 2;
  std::vector<Radius> radii;
  if (half > 0) add(rows, {0, half - 1, 0}, false, radii);
  add(rows, {half, rows.size() - 1, 0}, true, radii);
  return mean_of(std::move(radii));
}

}  // namespace impactdic::impact
