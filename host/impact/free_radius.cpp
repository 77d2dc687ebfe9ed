#include "host/impact/free_radius.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host/base/statistics.h"
#include "host/impact/alike_in_a_row.h"

namespace impactdic::impact {
namespace {

constexpr double kRadiusOutlier = 5;  // times the scatter
constexpr double kRounding = 1e-9;    // px
// By how much a radius drifts in a flight as the texture turns under the rim: it errs alike in many
// frames, which their scatter about a line does not show (seven rendered clips of 40 frames).
constexpr double kDrift_px = 0.03;

struct Radius {
  double px, sd;
};

// Of two flights.
struct Radii {
  std::array<std::vector<Radius>, 2> flights;

  void add(const TrackRows& rows, const FlightRange& range, std::size_t flight) {
    const std::size_t end = std::min(range.last + 1, rows.size());
    if (end > range.first) flights[flight].reserve(end - range.first);
    for (std::size_t i = range.first; i < end; ++i) {
      const TrackRow row = rows[i];
      if (row.circle_ok) flights[flight].push_back({row.r_px, row.r_sd_px});
    }
  }
  std::size_t size() const { return flights[0].size() + flights[1].size(); }

  // In order.
  template <typename Use>
  void each(const Use& use) const {
    for (const std::vector<Radius>& flight : flights) {
      for (const Radius& r : flight) use(r);
    }
  }
};

void drop_outliers(Radii& radii) {
  const auto median_of = [&](const auto& value) {
    std::vector<double> values;
    values.reserve(radii.size());
    radii.each([&](const Radius& r) { values.push_back(value(r)); });
    return upper_median(std::move(values));
  };
  const double centre = median_of([](const Radius& r) { return r.px; });
  const auto off = [&](const Radius& r) { return std::abs(r.px - centre); };
  const double limit = kRadiusOutlier * kSdOfMad * median_of(off) + kRounding;
  for (std::vector<Radius>& flight : radii.flights) {
    std::erase_if(flight, [&](const Radius& r) { return off(r) > limit; });
  }
}

struct Mean {
  double weight = 0, sum = 0;
  void add(double value, double w) { weight += w, sum += w * value; }
  double value() const { return sum / weight; }
};

// Of the deviations that were stated.
double usual_sd(const Radii& radii) {
  std::vector<double> stated;
  stated.reserve(radii.size());
  radii.each([&](const Radius& r) { stated.push_back(r.sd); });
  return upper_median(finite(std::move(stated)));
}

FreeRadius mean_of(Radii radii) {
  FreeRadius result;
  if (radii.size() == 0) return result;
  drop_outliers(radii);
  // Frames without a deviation count as usual ones; none counts more than four usual ones.
  const double usual = usual_sd(radii);
  const auto weight = [&](const Radius& r) {
    if (!(usual > 0)) return 1.0;
    const double sd = r.sd > 0 ? std::max(r.sd, usual / 2) : usual;
    return 1 / (sd * sd);
  };
  Mean all, flight[2], square;
  radii.each([&](const Radius& r) { all.add(r.px, weight(r)); });
  for (std::size_t k : {0u, 1u}) {
    for (const Radius& r : radii.flights[k]) flight[k].add(r.px, weight(r));
    for (const Radius& r : radii.flights[k]) {
      const double off = r.px - flight[k].value();
      square.add(off * off, weight(r));
    }
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

// A line of least squares through radii.
class Line {
 public:
  void add(double at, double value) { at_.push_back(at), values_.push_back(value); }
  std::size_t size() const { return at_.size(); }

  void fit() {
    double at = 0, value = 0, moment = 0;
    for (std::size_t i = 0; i < size(); ++i) at += at_[i], value += values_[i];
    middle_ = at / static_cast<double>(size()), mean_ = value / static_cast<double>(size());
    spread_ = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      spread_ += (at_[i] - middle_) * (at_[i] - middle_);
      moment += (at_[i] - middle_) * (values_[i] - mean_);
    }
    slope_ = moment / spread_;
  }
  // Whether any value was left out.
  bool drop_outliers() {
    std::vector<double> off;
    for (const double r : residuals()) off.push_back(std::abs(r));
    const double limit = kRadiusOutlier * kSdOfMad * upper_median(off) + kRounding;
    Line kept;
    for (std::size_t i = 0; i < size(); ++i) {
      if (off[i] <= limit) kept.add(at_[i], values_[i]);
    }
    const bool dropped = kept.size() < size();
    at_ = std::move(kept.at_), values_ = std::move(kept.values_);
    return dropped;
  }

  double mean() const { return mean_; }
  Measured slope() const {
    const std::vector<double> r = residuals();
    double squares = 0;
    for (const double x : r) squares += x * x;
    const double variance =
        squares * alike_in_a_row(std::span(&r, 1), 0.05) / static_cast<double>(r.size() - 2);
    return {slope_, std::sqrt(variance / spread_)};
  }

 private:
  std::vector<double> residuals() const {
    std::vector<double> r;
    for (std::size_t i = 0; i < size(); ++i) {
      r.push_back(values_[i] - mean_ - slope_ * (at_[i] - middle_));
    }
    return r;
  }
  std::vector<double> at_, values_;
  double middle_ = 0, mean_ = 0, spread_ = 0, slope_ = 0;
};

}  // namespace

Measured radius_growth(const TrackRows& rows, const FlightRange& range) {
  constexpr std::size_t kFewest = 12;
  Line line;
  for (std::size_t i = range.first; i <= range.last && i < rows.size(); ++i) {
    const TrackRow row = rows[i];
    if (row.circle_ok) line.add(static_cast<double>(i), row.r_px);
  }
  do {
    if (line.size() < kFewest) return {};
    line.fit();
  } while (line.drop_outliers());
  const Measured slope = line.slope();
  const double drift = kDrift_px / static_cast<double>(range.last - range.first);
  return {slope.value / line.mean(), std::hypot(slope.sd, drift) / line.mean()};
}

FreeRadius free_radius(const TrackRows& rows, const FlightRange& before, const FlightRange& after) {
  Radii radii;
  radii.add(rows, before, 0);
  radii.add(rows, after, 1);
  return mean_of(std::move(radii));
}

FreeRadius free_radius(const TrackRows& rows) {
  if (rows.empty()) return {};
  const std::size_t half = rows.size() / 2;
  Radii radii;
  if (half > 0) radii.add(rows, {0, half - 1, 0}, 0);
  radii.add(rows, {half, rows.size() - 1, 0}, 1);
  return mean_of(std::move(radii));
}

}  // namespace impactdic::impact
