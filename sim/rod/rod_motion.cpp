#include "sim/rod/rod_motion.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "sim/rod/free_flight.h"

namespace impactdic::sim::rod {
namespace {

constexpr std::size_t kSeed = 4;  // frames that start a fit
// A release leaves the parabola slowly: so many frames pass before one can be seen to be off it.
constexpr std::size_t kGuard = 6;
// Below these a camera's noise is rounding; they keep noise-free tables from ending at once.
constexpr double kLeastPositionNoise_m = 1e-7;
constexpr double kLeastAngleNoise_rad = 1e-6;

double square(double x) { return x * x; }

// The table's motion in the axes n, t, b.
class Analysis {
 public:
  Analysis(const MarkerTable& markers, const RodMeasureOptions& options)
      : markers_(markers), options_(options), time_(markers.time_s) {}

  RodMeasurement run();

 private:
  void choose_axes();
  void project();
  void find_blow();
  void grow(RodSide& side, bool forward) const;
  void differentiate();
  void locate_blow();
  void measure_side(RodSide& side, bool before);
  void measure_gravity(RodSide& side) const;

  // The normal position with the fall taken out is straight in free flight.
  std::vector<double> unfallen() const;

  const MarkerTable& markers_;
  const RodMeasureOptions& options_;
  const std::vector<double>& time_;
  Eigen::Vector3d n_, t_, b_;
  std::vector<double> qt_, qn_, qb_, angle_, flat_;
  std::size_t split_ = 0;
  RodMeasurement result_;
};

Eigen::Vector3d vector(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

void Analysis::choose_axes() {
  n_ = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(options_.vertical_axis));
  if (options_.vertical_down) n_ = -n_;
  // The rod's direction over the first quarter of the table, when it has not been struck yet.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < std::max<std::size_t>(4, time_.size() / 4); ++i) {
    const Eigen::Vector3d rod = vector(markers_.markers[2][i]) - vector(markers_.markers[0][i]);
    if (rod.allFinite()) sum += rod.normalized();
  }
  const Eigen::Vector3d flat = sum - n_ * n_.dot(sum);
  if (!(flat.norm() > 0.02 * sum.norm()) || sum.norm() == 0) {
    throw FormatError(markers_.file, -1, "the plane of the rod's motion is not defined",
                      "markers 1 and 3 must be seen at the start, the rod not upright");
  }
  if (n_.dot(sum) < 0) {
    result_.warnings.push_back(
        "marker 1 starts above marker 3: is the vertical axis right, and marker 1 at the lower "
        "end?");
  }
  t_ = flat.normalized();
  b_ = t_.cross(n_);
}

void Analysis::project() {
  constexpr std::array<std::array<std::size_t, 2>, 3> pairs{{{0, 1}, {0, 2}, {1, 2}}};
  double spread = 0;
  std::size_t spread_count = 0;
  for (std::size_t i = 0; i < time_.size(); ++i) {
    RodFrame frame;
    frame.time_s = time_[i];
    frame.status = "ok";
    for (std::size_t m = 0; m < 3; ++m) {
      if (std::isnan(markers_.markers[m][i][0])) {
        frame.status = "marker_" + std::to_string(m + 1) + "_hidden";
      }
    }
    double sum = 0;
    int count = 0;
    for (std::size_t p = 0; p < 3; ++p) {
      const Eigen::Vector3d rod =
          vector(markers_.markers[pairs[p][1]][i]) - vector(markers_.markers[pairs[p][0]][i]);
      double angle = std::atan2(rod.dot(n_), rod.dot(t_));
      // Continued from the frame before, so that a rod that turns over keeps counting.
      const double last = angle_.empty() || std::isnan(angle_.back()) ? angle : angle_.back();
      angle += 2 * kPi * std::round((last - angle) / (2 * kPi));
      frame.pair_angle_rad[p] = angle;
      if (!std::isnan(angle)) sum += angle, ++count;
    }
    frame.angle_rad = count > 0 ? sum / count : kNotMeasured;
    if (count == 3) {
      for (double angle : frame.pair_angle_rad) spread += square(angle - frame.angle_rad);
      spread_count += 3;
    }
    const Eigen::Vector3d axis = std::cos(frame.angle_rad) * t_ + std::sin(frame.angle_rad) * n_;
    Eigen::Vector3d centre = vector(markers_.markers[1][i]);
    if (options_.centre_offset_m != 0) centre += options_.centre_offset_m * axis;
    frame.qt_m = centre.dot(t_), frame.qn_m = centre.dot(n_);
    frame.out_of_plane_m = centre.dot(b_);
    qt_.push_back(frame.qt_m), qn_.push_back(frame.qn_m), qb_.push_back(frame.out_of_plane_m);
    angle_.push_back(frame.angle_rad);
    result_.frames.push_back(frame);
  }
  flat_ = unfallen();
  result_.pair_spread_rad = spread_count > 0 ? std::sqrt(spread / spread_count) : kNotMeasured;
  result_.position_noise_m =
      std::max(frame_noise(qt_, kLeastPositionNoise_m), frame_noise(qn_, kLeastPositionNoise_m));
  result_.angle_noise_rad = frame_noise(angle_, kLeastAngleNoise_rad);
}

std::vector<double> Analysis::unfallen() const {
  std::vector<double> flat(qn_);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    flat[i] += options_.gravity_m_s2 / 2 * square(time_[i] - time_[0]);
  }
  return flat;
}

// The first pair of neighbouring frames over which the velocity jumps as much as at a blow.
void Analysis::find_blow() {
  const double arm = options_.body.length_m / 2;
  std::vector<double> jump(time_.size(), 0);
  double largest = 0;
  for (std::size_t k = kSeed; k + kSeed + 1 < time_.size(); ++k) {
    const auto slope = [&](const std::vector<double>& v, std::size_t from) {
      const PolynomialFit line = fit_polynomial(time_, v, from, from + kSeed - 1, 1, time_[k]);
      return line.count >= 3 ? line.coefficients[1] : kNotMeasured;
    };
    const auto change = [&](const std::vector<double>& v) {
      return square(slope(v, k + 1) - slope(v, k + 1 - kSeed));
    };
    const double sum = change(qt_) + change(flat_) + arm * arm * change(angle_);
    if (std::isnan(sum)) continue;
    jump[k] = sum;
    largest = std::max(largest, sum);
  }
  const double slope_noise = result_.position_noise_m / markers_.interval_s / std::sqrt(5.0);
  // A release from rest changes the slope of neighbouring fits by g times their distance.
  const double release = options_.gravity_m_s2 * kSeed * markers_.interval_s;
  if (!(largest > square(10 * slope_noise)) || !(largest > square(2 * release))) {
    throw FormatError(markers_.file, -1, "the table shows no impact",
                      "no frame where the rod's velocity jumps");
  }
  std::size_t k = 0;
  while (jump[k] < 0.25 * largest) ++k;
  // The jump spreads over the frames of the short fits: take its peak.
  std::size_t peak = k;
  for (std::size_t i = k; i < std::min(k + 2 * kSeed, jump.size()); ++i) {
    if (jump[i] > jump[peak]) peak = i;
  }
  split_ = peak;
}

// From a few frames a little off the blow, first towards it, then away from it.
void Analysis::grow(RodSide& side, bool forward) const {
  const FreeFlight flight(time_, {{qt_, result_.position_noise_m},
                                  {flat_, result_.position_noise_m},
                                  {angle_, result_.angle_noise_rad}});
  const std::size_t last_frame = time_.size() - 1;
  if (forward) {
    flight.widen_down(side.first, side.last, result_.before.last + 1);
    flight.widen_up(side.first, side.last, last_frame);
    if (side.last < last_frame) side.last = std::max(side.last - kGuard, side.first + kSeed - 1);
  } else {
    flight.widen_up(side.first, side.last, split_ + 1);
    flight.widen_down(side.first, side.last, 0);
    if (side.first > 0) side.first = std::min(side.first + kGuard, side.last + 1 - kSeed);
  }
}

void Analysis::differentiate() {
  const auto derive = [&](const std::vector<double>& v, std::size_t i) {
    // Neighbours on the same side of the blow.
    const bool after = i >= result_.after.first;
    const bool between = !after && i > result_.before.last;
    if (between) return kNotMeasured;
    const std::size_t low = after ? result_.after.first : 0;
    const std::size_t high = after ? v.size() - 1 : result_.before.last;
    const std::size_t a = i > low ? i - 1 : i, b = i < high ? i + 1 : i;
    return b > a ? (v[b] - v[a]) / (time_[b] - time_[a]) : kNotMeasured;
  };
  for (std::size_t i = 0; i < time_.size(); ++i) {
    RodFrame& frame = result_.frames[i];
    frame.vt_m_s = derive(qt_, i);
    frame.vn_m_s = derive(qn_, i);
    frame.omega_rad_s = derive(angle_, i);
  }
}

// Position and angle are continuous over the blow: the instant where both flights meet.
void Analysis::locate_blow() {
  const double arm = options_.body.length_m / 2;
  double numerator = 0, denominator = 0, variance = 0;
  const auto add = [&](const std::vector<double>& v, double scale, double sigma) {
    const double reference = time_[split_];
    const auto& before = result_.before;
    const auto& after = result_.after;
    const PolynomialFit a = fit_polynomial(time_, v, before.first, before.last, 1, reference);
    const PolynomialFit b = fit_polynomial(time_, v, after.first, after.last, 1, reference);
    const double offset = scale * (b.coefficients[0] - a.coefficients[0]);
    const double slope = scale * (b.coefficients[1] - a.coefficients[1]);
    numerator -= offset * slope;
    denominator += slope * slope;
    variance += square(scale * sigma * slope) * (a.leverage(reference) + b.leverage(reference));
  };
  add(qt_, 1, result_.position_noise_m);
  add(flat_, 1, result_.position_noise_m);
  add(angle_, arm, result_.angle_noise_rad);
  result_.impact_s = {time_[split_] + numerator / denominator, std::sqrt(variance) / denominator};
}

void Analysis::measure_side(RodSide& side, bool before) {
  const double instant = result_.impact_s.value;
  const auto line = [&](const std::vector<double>& v) {
    return fit_polynomial(time_, v, side.first, side.last, 1, instant);
  };
  const auto slope = [](const PolynomialFit& p, double least) {
    return Measured{p.coefficients[1], std::max(p.rms, least) * std::sqrt(p.cofactor_at(1, 1))};
  };
  const PolynomialFit t = line(qt_), n = line(flat_), a = line(angle_);
  if (std::min({t.count, n.count, a.count}) < kSeed) {
    throw FormatError(markers_.file, -1,
                      std::string("fewer than 4 frames of free flight ") +
                          (before ? "before" : "after") + " the impact");
  }
  side.vt_m_s = slope(t, 0);
  side.vn_m_s = slope(n, 0);
  side.vn_m_s.value -= options_.gravity_m_s2 * (instant - time_[0]);
  side.vn_m_s.sd = std::hypot(side.vn_m_s.sd, options_.gravity_m_s2 * result_.impact_s.sd);
  side.omega_rad_s = slope(a, 0);
  side.angle_rad = {a.coefficients[0], a.rms * std::sqrt(a.cofactor_at(0, 0))};
  const RodFrame& next = result_.frames[before ? side.last : side.first];
  side.difference_vt_m_s = next.vt_m_s;
  side.difference_vn_m_s = next.vn_m_s;
  side.difference_omega_rad_s = next.omega_rad_s;
  measure_gravity(side);
}

void Analysis::measure_gravity(RodSide& side) const {
  side.gravity_m_s2 = {kNotMeasured, kNotMeasured};
  side.gravity_slope_m_s2 = side.gravity_tilt_deg = kNotMeasured;
  if (side.last - side.first + 1 < 6) return;
  const double middle = time_[(side.first + side.last) / 2];
  const auto parabola = [&](const std::vector<double>& v) {
    return fit_polynomial(time_, v, side.first, side.last, 2, middle);
  };
  const PolynomialFit n = parabola(qn_), t = parabola(qt_), b = parabola(qb_);
  if (n.count < 6) return;
  const double fall = -2 * n.coefficients[2];
  side.gravity_m_s2 = {fall, 2 * n.rms * std::sqrt(n.cofactor_at(2, 2))};
  side.gravity_tilt_deg =
      std::atan2(2 * std::hypot(t.coefficients[2], b.coefficients[2]), fall) * kDegPerRad;
  std::vector<double> velocity;
  for (const RodFrame& frame : result_.frames) velocity.push_back(frame.vn_m_s);
  side.gravity_slope_m_s2 =
      -fit_polynomial(time_, velocity, side.first, side.last, 1, middle).coefficients[1];
}

RodMeasurement Analysis::run() {
  choose_axes();
  project();
  find_blow();
  result_.before.last = split_ - 1;
  result_.before.first = split_ - kSeed;
  grow(result_.before, false);
  result_.after.first = split_ + 2;
  result_.after.last = std::min(split_ + 1 + kSeed, time_.size() - 1);
  grow(result_.after, true);
  result_.last_before = result_.before.last;
  result_.first_after = result_.after.first;
  differentiate();
  locate_blow();
  measure_side(result_.before, true);
  measure_side(result_.after, false);

  const double arm = options_.body.length_m / 2;
  const double angle = (result_.before.angle_rad.value + result_.after.angle_rad.value) / 2;
  const double lever = arm * std::cos(angle);
  const auto tip = [&](const RodSide& side) {
    return Measured{side.vn_m_s.value - side.omega_rad_s.value * lever,
                    std::hypot(side.vn_m_s.sd, side.omega_rad_s.sd * lever)};
  };
  result_.tip_vn_before_m_s = tip(result_.before);
  result_.tip_vn_after_m_s = tip(result_.after);
  const double in = result_.tip_vn_before_m_s.value, out = result_.tip_vn_after_m_s.value;
  if (!(in < 0)) {
    throw FormatError(markers_.file, -1, "the struck end does not move towards the flat",
                      "is marker 1 at the lower end, and the vertical axis right?");
  }
  result_.restitution = {-out / in, std::hypot(result_.tip_vn_after_m_s.sd / in,
                                               out / in / in * result_.tip_vn_before_m_s.sd)};
  result_.closure =
      close_impulses(options_.body, options_.friction_kinetic, result_.before, result_.after);
  return std::move(result_);
}

}  // namespace

RodMeasurement measure_rod(const MarkerTable& markers, const RodMeasureOptions& options) {
  return Analysis(markers, options).run();
}

RodClosure close_impulses(const RodBody& body, double friction_kinetic, const RodSide& before,
                          const RodSide& after) {
  RodClosure closure;
  const double angle = (before.angle_rad.value + after.angle_rad.value) / 2;
  const double rx = -body.length_m / 2 * std::cos(angle);
  const double ry = -body.length_m / 2 * std::sin(angle) - body.radius_m;
  const double factor = body.mass_kg / body.inertia_kg_m2();
  const double dvn = after.vn_m_s.value - before.vn_m_s.value;
  const double dvt = after.vt_m_s.value - before.vt_m_s.value;
  const double dvn_sd = std::hypot(after.vn_m_s.sd, before.vn_m_s.sd);
  const double dvt_sd = std::hypot(after.vt_m_s.sd, before.vt_m_s.sd);
  closure.normal_impulse_n_s = body.mass_kg * dvn;
  closure.tangential_impulse_n_s = body.mass_kg * dvt;
  const auto omega = [&](double sign) {
    return Measured{before.omega_rad_s.value + factor * (rx * dvn - ry * sign * dvt),
                    std::hypot(before.omega_rad_s.sd, factor * rx * dvn_sd, factor * ry * dvt_sd)};
  };
  closure.omega_as_measured_rad_s = omega(1);
  closure.omega_axis_flipped_rad_s = omega(-1);
  const auto misfit = [&](const Measured& m) {
    const double sd = std::hypot(m.sd, after.omega_rad_s.sd);
    return std::abs(m.value - after.omega_rad_s.value) / std::max(sd, 1e-12);
  };
  const double straight = misfit(closure.omega_as_measured_rad_s);
  const double flipped = misfit(closure.omega_axis_flipped_rad_s);
  closure.misfit_sd = std::min(straight, flipped);
  // Four standard deviations apart, or nobody can tell which of the two it is.
  if (std::abs(straight - flipped) > 4) closure.tangential_sign = straight < flipped ? 1 : -1;
  closure.impulse_ratio = {std::abs(dvt / dvn), std::hypot(dvt_sd / dvn, dvt / dvn / dvn * dvn_sd)};
  closure.inside_friction_cone =
      closure.impulse_ratio.value <= friction_kinetic + 2 * closure.impulse_ratio.sd;
  return closure;
}

}  // namespace impactdic::sim::rod
