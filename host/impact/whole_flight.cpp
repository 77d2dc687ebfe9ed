#include "host/impact/whole_flight.h"

#include <algorithm>
#include <cmath>

#include "host/clip/track_row.h"
#include "host/impact/flight_spin.h"
#include "host/impact/free_radius.h"

namespace impactdic::impact {
namespace {

constexpr std::size_t kFewestFlightRows = 12, kMostRows = 2000;
// A path that is no free flight leaves its fit by more than centres and motions are wrong by.
constexpr double kMostScatter = 3;      // over what the track states
constexpr double kMostRejected = 0.05;  // of the data
// What a turn out of the picture's plane makes of that in it, in proportion (80 flights, four
// patterns of R 115 px).
constexpr double kTiltedModel = 1e-4;

bool describes(const FlightFit& fit) {
  if (!fit.ok || fit.position_scale > kMostScatter || fit.step_scale > kMostScatter) return false;
  return fit.rejected <= kMostRejected * (fit.used + fit.rejected);
}

// `first`: the component about t.
void put_spins(const FlightFit& fit, SphereSpin first, FlightMotion& motion) {
  const auto spin = [&](int i) {
    return Measured{fit.spin[i], std::sqrt(fit.spin_covariance(i, i))};
  };
  if (!std::isfinite(fit.spin[first])) return;
  motion.spin_t = spin(first);
  motion.spin_n = spin(first + 1);
}

}  // namespace

SphereKnown known_of_sphere(const ImpactOptions& options) {
  SphereKnown known;
  if (options.radius_px) known.radius_sd_px = options.radius_px->sd;
  known.nearness_sd = options.nearness_sd;
  known.axis_px = options.axis_px;
  return known;
}

double tilted_spin_sd(const FlightFit& fit, SphereSpin first) {
  if (!std::isfinite(fit.spin[first])) return 0;
  return kTiltedModel * fit.spin.segment<2>(first).norm();
}

Measured towards_camera(const TrackRows& rows, const FlightRange& range,
                        const ImpactOptions& options, double radius_px) {
  if (!options.distance_px) return {};
  const Measured growth = radius_growth(rows, range);
  const Measured& distance = *options.distance_px;
  const double slant = 1 - std::pow(radius_px / distance.value, 2);
  return {growth.value * distance.value * slant,
          std::hypot(growth.sd * distance.value, growth.value * distance.sd) * slant};
}

void put_out_of_plane(const FlightFit& fit, const TrackRows& rows, const ImpactOptions& options,
                      ImpactAnalysis& result) {
  put_spins(fit, kSpinT0, result.before);
  put_spins(fit, kSpinT1, result.after);
  for (FlightMotion* flight : {&result.before, &result.after}) {
    const FlightRange range = {flight->first, flight->last, 0};
    flight->vb = towards_camera(rows, range, options, result.radius_px.value);
  }
}

FlightMotion whole_flight(const TrackRows& rows, const ImpactOptions& options) {
  FlightMotion motion;
  if (rows.size() < kFewestFlightRows || rows.size() > kMostRows) return motion;
  const double angle = options.surface_angle_rad;
  const ImpactSeries series(rows, angle, known_of_sphere(options));
  const FlightRange range = {0, rows.size() - 1, static_cast<double>(rows.size() - 1) / 2};
  const GravityDirection direction = {std::cos(options.gravity_angle_rad - angle),
                                      std::sin(options.gravity_angle_rad - angle)};
  const FlightFit fit = fit_flight(series, range, direction, options.gravity);
  if (!describes(fit)) return motion;
  motion.first = range.first;
  motion.last = range.last;
  const double c = std::cos(angle), s = std::sin(angle);
  const auto& covariance = fit.covariance;
  // A sum of both velocities with these weights.
  const auto velocity = [&](double of_t, double of_n) {
    const double variance = of_t * of_t * covariance(kVt0, kVt0) +
                            of_n * of_n * covariance(kVn0, kVn0) +
                            2 * of_t * of_n * covariance(kVt0, kVn0);
    return Measured{of_t * fit.state[kVt0] + of_n * fit.state[kVn0], std::sqrt(variance)};
  };
  motion.vt = velocity(1, 0);
  motion.vn = velocity(0, 1);
  motion.vx = velocity(c, -s);
  motion.vy = velocity(s, c);
  const FlightSpin spin = flight_spin(series, range);
  motion.spin = {spin.value,
                 std::hypot(spin.noise_sd, spin.common_sd, tilted_spin_sd(fit, kSpinT0))};
  if (std::isfinite(fit.roll[0].value)) motion.spin = fit.roll[0];
  put_spins(fit, kSpinT0, motion);
  motion.vb = towards_camera(rows, range, options, median_radius_px(rows).value_or(0));
  return motion;
}

}  // namespace impactdic::impact
