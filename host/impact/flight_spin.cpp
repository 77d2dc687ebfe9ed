#include "host/impact/flight_spin.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/impact/alike_in_a_row.h"
#include "host/impact/flight/flight_data.h"

namespace impactdic::impact {

namespace {

// What one deviation of the camera's distance makes of a flight's turns in the picture's plane, on
// the mean.
double roll_to_nearness(const SphereSteps& steps, const FlightRange& range) {
  if (!(steps.nearness_sd() > 0)) return 0;
  double sum = 0;
  int count = 0;
  for (std::size_t i = range.first; i < range.last; ++i) {
    const SphereStep step = steps[i];
    if (step.ok) sum += step.roll_to_nearness, ++count;
  }
  return count > 0 ? sum / count * steps.nearness_sd() : 0.0;
}

// A line through a flight's angles; where the keyframe changes they may jump.
class SpinOfPoses {
 public:
  // `usual`: rad a frame, near enough to tell whole turns apart.
  SpinOfPoses(const ImpactSeries& series, const FlightRange& range, double usual) : usual_(usual) {
    for (std::size_t i = range.first; i <= range.last; ++i) {
      const BodyPose pose = series.pose(i);
      if (!pose.ok || !(pose.angle_sd_rad > 0)) continue;
      Group& group = groups_[{pose.origin, pose.keyframe}];
      const auto frame = static_cast<double>(i - range.first);
      const double off = pose.angle_rad - usual * frame;
      if (group.angles.empty()) group.first = off;
      const double off_rad = std::remainder(off - group.first, 2 * kPi);
      group.angles.push_back({frame, off_rad, pose.angle_sd_rad});
      ++placed_;
    }
    frames_ = static_cast<double>(range.last - range.first + 1);
  }

  // nullopt where too few frames lean on keyframes.
  std::optional<FlightSpin> spin() {
    if (static_cast<double>(placed_) < kFewestLinked * frames_ || !fit()) return std::nullopt;
    const double limit = kOutlier * kSdOfMad * upper_median(finite(residuals())) + 1e-9;
    for (auto& [key, group] : groups_) {
      std::erase_if(group.angles, [&group = group, limit, this](const Angle& angle) {
        return std::abs(residual(group, angle)) > limit;
      });
    }
    if (!fit()) return std::nullopt;
    const double noise_sd = std::max(scatter_, 1.0) * std::sqrt(alike() / spread_);
    return FlightSpin{usual_ + slope_, noise_sd, kLinkDrift * usual_sd_ / std::sqrt(spans_)};
  }

 private:
  static constexpr double kOutlier = 5;  // deviations
  struct Angle {
    double frame, off_rad, sd_rad;
  };
  struct Group {  // that leans on one keyframe
    double first = 0;
    std::vector<Angle> angles;
    double frame = 0, off_rad = 0;  // means
  };

  double residual(const Group& group, const Angle& angle) const {
    return angle.off_rad - group.off_rad - slope_ * (angle.frame - group.frame);
  }
  std::vector<double> residuals() const {
    std::vector<double> all;
    for (const auto& [key, group] : groups_) {
      for (const Angle& angle : group.angles) all.push_back(std::abs(residual(group, angle)));
    }
    return all;
  }

  // Dust that passes before the ball misleads the frames that it takes alike.
  double alike() const {
    std::vector<std::vector<double>> runs;
    std::size_t count = 0;
    for (const auto& [key, group] : groups_) {
      std::vector<double>& run = runs.emplace_back();
      for (const Angle& angle : group.angles) run.push_back(residual(group, angle) / angle.sd_rad);
      count += run.size();
    }
    return alike_in_a_row(runs, beyond_chance(static_cast<double>(count)));
  }

  static double weight(const Angle& angle) { return 1 / (angle.sd_rad * angle.sd_rad); }
  static void centre(Group& group) {
    double weights = 0;
    group.frame = group.off_rad = 0;
    for (const Angle& angle : group.angles) {
      weights += weight(angle);
      group.frame += weight(angle) * angle.frame;
      group.off_rad += weight(angle) * angle.off_rad;
    }
    group.frame /= weights;
    group.off_rad /= weights;
  }

  bool fit() {
    std::erase_if(groups_, [](const auto& one) { return one.second.angles.size() < 2; });
    std::vector<double> sds;
    double sum = 0, squares = 0;
    spread_ = spans_ = 0;
    for (auto& [key, group] : groups_) {
      centre(group);
      for (const Angle& angle : group.angles) {
        const double x = angle.frame - group.frame;
        spread_ += weight(angle) * x * x;
        sum += weight(angle) * x * (angle.off_rad - group.off_rad);
        sds.push_back(angle.sd_rad);
      }
      spans_ += std::pow(group.angles.back().frame - group.angles.front().frame, 2);
    }
    if (sds.size() < groups_.size() + 4) return false;
    slope_ = sum / spread_;
    for (const auto& [key, group] : groups_) {
      for (const Angle& angle : group.angles) {
        squares += weight(angle) * std::pow(residual(group, angle), 2);
      }
    }
    scatter_ = std::sqrt(squares / static_cast<double>(sds.size() - groups_.size() - 1));
    usual_sd_ = upper_median(std::move(sds));
    return true;
  }

  double usual_, frames_ = 0;
  std::size_t placed_ = 0;
  std::map<std::pair<std::int64_t, std::int64_t>, Group> groups_;  // by origin and keyframe
  double slope_ = 0, scatter_ = 0;                                 // scatter: over what is stated
  double spread_ = 0, spans_ = 0, usual_sd_ = 0;
};

FlightSpin spin_of_turns(const ImpactSeries& series, const FlightRange& range) {
  std::vector<double> turns, sds;
  for (std::size_t i = range.first; i < range.last; ++i) {
    if (std::isfinite(series.turn(i))) {
      turns.push_back(series.turn(i));
      sds.push_back(series.turn_sd(i));
    }
  }
  if (turns.size() < 3) return {};
  const double usual = upper_median(finite(sds)), centre = upper_median(finite(turns));
  std::vector<double> off;
  for (double turn : turns) off.push_back(std::abs(turn - centre));
  const double limit = 5 * kSdOfMad * upper_median(finite(off)) + 1e-12;
  double weights = 0, sum = 0, squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (std::abs(turns[i] - centre) > limit) continue;
    const double sd = sds[i] > 0 ? sds[i] : usual > 0 ? usual : 1.0;
    weights += 1 / (sd * sd), sum += (turns[i] - centre) / (sd * sd), ++count;
  }
  if (count < 3) return {};
  const double mean = centre + sum / weights;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (std::abs(turns[i] - centre) > limit) continue;
    const double sd = sds[i] > 0 ? sds[i] : usual > 0 ? usual : 1.0;
    squares += (turns[i] - mean) * (turns[i] - mean) / (sd * sd);
  }
  const double scatter_sq = squares / static_cast<double>(count - 1);
  const double share = common_share(std::sqrt(scatter_sq), count);
  const double common = usual > 0 ? share * usual * usual : 0.0;
  const double by_nearness = series.sphere ? roll_to_nearness(*series.sphere, range) : 0.0;
  // Student's distribution of a mean whose scatter is known from few turns is wider (JCGM 101:2008,
  // section 6.4.9).
  const double freedom = std::max(static_cast<double>(count - 1), 3.0);
  const double wider = std::sqrt(freedom / (freedom - 2));
  return {mean, wider * std::sqrt(scatter_sq / weights),
          std::hypot(std::sqrt(common), by_nearness)};
}

}  // namespace

FlightSpin flight_spin(const ImpactSeries& series, const FlightRange& range) {
  const FlightSpin turns = spin_of_turns(series, range);
  if (series.sphere || !std::isfinite(turns.value)) return turns;
  return SpinOfPoses(series, range, turns.value).spin().value_or(turns);
}

}  // namespace impactdic::impact
