#include "sim/shot/shot.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/contact/impact.h"
#include "sim/rod/free_flight.h"

namespace impactdic::sim::shot {
namespace {

constexpr std::size_t kSeed = 6;    // frames that start a flight
constexpr std::size_t kGuard = 12;  // the touch bends the path slowly: so many frames are given up
constexpr std::size_t kFewestContactFrames = 5;
constexpr double kLeastNoise_m = 1e-9;

double square(double x) { return x * x; }

// The track turned into the surface's axes.
class ShotAnalysis {
 public:
  ShotAnalysis(const Track& track, const ShotOptions& options)
      : track_(track), options_(options), time_(track.time_s) {}

  Shot run();

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& hint = "") const {
    throw FormatError(track_.file, -1, what, hint);
  }
  void rotate();
  std::size_t lowest_frame() const;
  void find_flights();
  void limit_flights();
  void extend_flights();
  void fit_flights();
  void find_touch();
  struct Onset {
    double cost, end_s;
  };
  Onset onset(double start_s) const;
  void fill_flight(Flight& flight, const rod::PolynomialFit& t, const rod::PolynomialFit& n,
                   double instant);
  Estimate spin(const Flight& flight) const;
  double normal_at(const rod::PolynomialFit& flat, double time) const {
    return flat.at(time) - gn_ / 2 * square(time - time_[0]);
  }
  double normal_velocity(const rod::PolynomialFit& flat, double time) const {
    return flat.slope_at(time) - gn_ * (time - time_[0]);
  }

  const Track& track_;
  const ShotOptions& options_;
  const std::vector<double>& time_;
  std::vector<double> qt_, qn_;          // positions in local axes
  std::vector<double> flat_t_, flat_n_;  // gravity taken off: straight in flight
  double gt_ = 0, gn_ = 0;               // gravity pulls along -t and -n by these
  rod::PolynomialFit before_t_, before_n_, after_t_, after_n_;
  std::size_t lowest_ = 0;
  Shot shot_;
};

void ShotAnalysis::rotate() {
  const double angle = options_.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  gt_ = options_.gravity_m_s2 * s;
  gn_ = options_.gravity_m_s2 * c;
  for (std::size_t i = 0; i < time_.size(); ++i) {
    const double fall = square(time_[i] - time_[0]) / 2;
    qt_.push_back(c * track_.x_m[i] + s * track_.y_m[i]);
    qn_.push_back(-s * track_.x_m[i] + c * track_.y_m[i]);
    flat_t_.push_back(qt_[i] + gt_ * fall);
    flat_n_.push_back(qn_[i] + gn_ * fall);
  }
  shot_.noise_m =
      std::max(rod::frame_noise(qt_, kLeastNoise_m), rod::frame_noise(qn_, kLeastNoise_m));
}

// Where the ball is nearest to the surface; it must come and go.
std::size_t ShotAnalysis::lowest_frame() const {
  std::size_t lowest = qn_.size();
  for (std::size_t i = 0; i < qn_.size(); ++i) {
    if (!std::isnan(qn_[i]) && (lowest == qn_.size() || qn_[i] < qn_[lowest])) lowest = i;
  }
  const auto rise = [&](std::size_t end) { return qn_[end] - qn_[lowest]; };
  std::size_t first = 0, last = qn_.size() - 1;
  while (std::isnan(qn_[first])) ++first;
  while (std::isnan(qn_[last])) --last;
  if (lowest < first + kSeed || lowest + kSeed > last || rise(first) < 10 * shot_.noise_m ||
      rise(last) < 10 * shot_.noise_m) {
    fail("the track shows no contact: the ball does not come to the surface and leave it again",
         "is the surface angle right?");
  }
  return lowest;
}

void ShotAnalysis::find_flights() {
  const rod::FreeFlight flight(time_, {{flat_t_, shot_.noise_m}, {flat_n_, shot_.noise_m}});
  std::size_t start = 0, end = time_.size() - 1;
  while (std::isnan(qn_[start])) ++start;
  while (std::isnan(qn_[end])) --end;
  Flight& before = shot_.before;
  before.first = start;
  before.last = start + kSeed - 1;
  flight.widen_up(before.first, before.last, lowest_ - 1);
  before.last = std::max(before.last - std::min(before.last, kGuard), start + kSeed - 1);
  // The way back takes about as long as the way in: from there outwards, then inwards.
  Flight& after = shot_.after;
  after.first = std::min(lowest_ + (lowest_ - before.last) * 3 / 2 + kSeed, end + 1 - kSeed);
  after.last = after.first + kSeed - 1;
  if (after.first <= lowest_ + 1) fail("too few frames after the impact");
  flight.widen_up(after.first, after.last, end);
  flight.widen_down(after.first, after.last, lowest_ + 1);
  after.first = std::min(after.first + kGuard, after.last + 1 - kSeed);
  limit_flights();
  if (after.first < before.last + kFewestContactFrames) {
    fail("fewer than 5 frames show the contact", "a higher frame rate would");
  }
}

void ShotAnalysis::limit_flights() {
  const auto longest = static_cast<std::size_t>(std::max(options_.flight_frames, 8));
  Flight& before = shot_.before;
  Flight& after = shot_.after;
  if (before.last - before.first + 1 > longest) before.first = before.last + 1 - longest;
  if (after.last - after.first + 1 > longest) after.last = after.first + longest - 1;
}

// The flights up to the touch and from the separation on, once these are known.
void ShotAnalysis::extend_flights() {
  Flight& before = shot_.before;
  Flight& after = shot_.after;
  while (before.last + 1 < lowest_ &&
         time_[before.last + 1] <= shot_.contact_start_s.value - shot_.contact_start_s.sd) {
    ++before.last;
  }
  while (after.first > lowest_ + 1 &&
         time_[after.first - 1] >= shot_.contact_end_s.value + shot_.contact_end_s.sd) {
    --after.first;
  }
  limit_flights();
}

void ShotAnalysis::fit_flights() {
  const auto line = [&](const std::vector<double>& v, const Flight& f) {
    const rod::PolynomialFit fit =
        rod::fit_polynomial(time_, v, f.first, f.last, 1, time_[lowest_]);
    if (fit.count < kSeed) fail("fewer than 6 centres are known in a flight");
    return fit;
  };
  before_t_ = line(flat_t_, shot_.before), before_n_ = line(flat_n_, shot_.before);
  after_t_ = line(flat_t_, shot_.after), after_n_ = line(flat_n_, shot_.after);
  if (!(normal_velocity(before_n_, time_[lowest_]) < 0)) {
    fail("the ball does not approach the surface", "is the surface angle right?");
  }
  if (!(normal_velocity(after_n_, time_[lowest_]) > 0)) fail("the ball does not leave the surface");
}

// Sum of squares of the onset polynomials on both sides for a touch at `start_s`; the separation is
// where the flight after is as high as the flight before was at the touch.
ShotAnalysis::Onset ShotAnalysis::onset(double start_s) const {
  const double height = normal_at(before_n_, start_s);
  // Flight after, solved for that height from the lowest frame on.
  double end = time_[lowest_];
  for (int i = 0; i < 30; ++i) {
    end += (height - normal_at(after_n_, end)) / normal_velocity(after_n_, end);
  }
  Onset result{0, end};
  const double middle = time_[lowest_];
  if (!(end > middle) || !(start_s < middle)) {
    return {std::numeric_limits<double>::infinity(), end};
  }
  const auto side = [&](const rod::PolynomialFit& flight, double edge, double reach, int power) {
    // Frames from well inside the flight to half way to the deepest point.
    std::vector<double> tau, off;
    for (std::size_t i = 0; i < time_.size(); ++i) {
      const double inside = (time_[i] - edge) / reach;  // 0 at the edge, 1 at the deepest
      if (inside < -0.5 || inside > 0.6 || std::isnan(qn_[i])) continue;
      tau.push_back(std::max(0.0, inside));
      off.push_back(qn_[i] - normal_at(flight, time_[i]));
    }
    Eigen::MatrixXd design(static_cast<Eigen::Index>(tau.size()), 3);
    Eigen::VectorXd target(design.rows());
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      const double x = tau[static_cast<std::size_t>(i)];
      const double onset = std::pow(x, power);
      design.row(i) << onset, onset * x, onset * x * x;
      target[i] = off[static_cast<std::size_t>(i)];
    }
    if (design.rows() < 4) return std::numeric_limits<double>::infinity();
    const Eigen::VectorXd a = design.colPivHouseholderQr().solve(target);
    return (design * a - target).squaredNorm() / static_cast<double>(design.rows());
  };
  result.cost =
      side(before_n_, start_s, middle - start_s, 2) + side(after_n_, end, middle - end, 3);
  return result;
}

void ShotAnalysis::find_touch() {
  // From a little before the flight's last frame to well before the deepest: a scan, a parabola.
  const double from = time_[shot_.before.last] - 6 * track_.interval_s;
  const double to = time_[lowest_] - 0.3 * (time_[lowest_] - from);
  constexpr int kSteps = 200;
  const double step = (to - from) / kSteps;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const double cost = onset(from + i * step).cost;
    if (cost < least) least = cost, best = i;
  }
  double start = from + best * step, curvature = 0;
  if (best > 0 && best < kSteps) {
    const double left = onset(start - step).cost, right = onset(start + step).cost;
    const double bend = left - 2 * least + right;
    if (bend > 0) start += std::clamp((left - right) / 2 / bend, -1.0, 1.0) * step;
  }
  const double reach = 10 * step;  // wide enough not to see single frames enter the sums
  const double low = onset(start - reach).cost, high = onset(start + reach).cost;
  if (std::isfinite(low) && std::isfinite(high)) {
    curvature = (low - 2 * least + high) / square(reach);
  }
  // The cost is a mean of squares over some frames of noise: its curvature tells the deviation. The
  // onset is no exact polynomial, which costs about a frame.
  const double frames = std::max(4.0, (time_[lowest_] - start) / track_.interval_s);
  const double noise = curvature > 0 ? shot_.noise_m * std::sqrt(2 / curvature / frames) : 0;
  const double sd = std::hypot(noise, track_.interval_s);
  const double end = onset(start).end_s;
  const double ratio = -normal_velocity(before_n_, start) / normal_velocity(after_n_, end);
  shot_.contact_start_s = {start, sd};
  shot_.contact_end_s = {end, sd * ratio};
  shot_.contact_s = {end - start, sd * (1 + ratio)};
}

Estimate ShotAnalysis::spin(const Flight& flight) const {
  double sum = 0, squares = 0, count = 0;
  for (std::size_t i = flight.first; i < flight.last; ++i) {
    if (std::isnan(track_.turn_rad[i])) continue;
    const double omega = track_.turn_rad[i] / track_.interval_s;
    sum += omega, squares += omega * omega, ++count;
  }
  if (count < 3) return {kNotMeasured, kNotMeasured};
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1))};
}

void ShotAnalysis::fill_flight(Flight& flight, const rod::PolynomialFit& t,
                               const rod::PolynomialFit& n, double instant) {
  const auto sd = [&](const rod::PolynomialFit& fit) {
    return std::max(fit.rms, shot_.noise_m) * std::sqrt(fit.cofactor_at(1, 1));
  };
  flight.vt_m_s = {t.slope_at(instant) - gt_ * (instant - time_[0]), sd(t)};
  flight.vn_m_s = {normal_velocity(n, instant), sd(n)};
  flight.omega_rad_s = spin(flight);
}

Shot ShotAnalysis::run() {
  shot_.file = track_.file;
  shot_.surface_angle_deg = options_.surface_angle_deg;
  rotate();
  lowest_ = lowest_frame();
  find_flights();
  fit_flights();
  find_touch();
  extend_flights();
  fit_flights();
  find_touch();
  const double start = shot_.contact_start_s.value, end = shot_.contact_end_s.value;
  fill_flight(shot_.before, before_t_, before_n_, start);
  fill_flight(shot_.after, after_t_, after_n_, end);

  // The deepest point: a parabola through the frames around the lowest.
  const auto reach =
      static_cast<std::size_t>(std::clamp((end - start) / track_.interval_s / 8, 2.0, 50.0));
  const rod::PolynomialFit deep =
      rod::fit_polynomial(time_, qn_, lowest_ - reach, lowest_ + reach, 2, time_[lowest_]);
  const double turn = -deep.coefficients[1] / 2 / deep.coefficients[2];
  const double deepest = deep.at(time_[lowest_] + turn);
  const double height = normal_at(before_n_, start);
  shot_.t_max_compression_s = time_[lowest_] + turn - start;
  shot_.max_deflection_m = {height - deepest,
                            std::hypot(shot_.noise_m * std::sqrt(deep.leverage(time_[lowest_])),
                                       shot_.before.vn_m_s.value * shot_.contact_start_s.sd)};
  const double cross =
      time_[lowest_] + (before_n_.at(time_[lowest_]) - after_n_.at(time_[lowest_])) /
                           (after_n_.slope_at(0) - before_n_.slope_at(0));
  const auto carried = [&](const rod::PolynomialFit& flight) {
    return std::max(flight.rms, shot_.noise_m) * std::sqrt(flight.leverage(cross));
  };
  shot_.crossing_s = cross;
  shot_.crossing_above_lowest_m = {
      normal_at(before_n_, cross) - deepest,
      std::hypot(carried(before_n_), carried(after_n_),
                 shot_.noise_m * std::sqrt(deep.leverage(time_[lowest_] + turn)))};

  const double angle = options_.surface_angle_deg * kRadPerDeg;
  const double touch_t = before_t_.at(start) - gt_ / 2 * square(start - time_[0]);
  shot_.touch_x_m = std::cos(angle) * touch_t - std::sin(angle) * height;
  shot_.touch_y_m = std::sin(angle) * touch_t + std::cos(angle) * height;

  derive(shot_, options_.body, options_.gravity_m_s2);
  return shot_;
}

}  // namespace

void derive(Shot& shot, const ImpactBody& body, double gravity_m_s2) {
  const double pull = gravity_m_s2 * std::cos(shot.surface_angle_deg * kRadPerDeg);
  const Estimate in = shot.before.vn_m_s, out = shot.after.vn_m_s;
  const double in_sd = std::hypot(in.sd, pull * shot.contact_start_s.sd);
  const double out_sd = std::hypot(out.sd, pull * shot.contact_end_s.sd);
  shot.restitution = {-out.value / in.value,
                      std::hypot(out_sd / in.value, out.value / square(in.value) * in_sd)};
  const auto state = [](const Flight& flight) {
    PlaneState s;
    s.vt_m_s = flight.vt_m_s.value, s.vn_m_s = flight.vn_m_s.value;
    if (!std::isnan(flight.omega_rad_s.value)) s.omega_rad_s = flight.omega_rad_s.value;
    return s;
  };
  shot.friction =
      contact::effective_friction(body, state(shot.before), state(shot.after), shot.contact_s.value,
                                  gravity_m_s2, shot.surface_angle_deg);
  shot.friction_sd = std::hypot(shot.before.vt_m_s.sd, shot.after.vt_m_s.sd,
                                shot.friction.sound * std::hypot(in_sd, out_sd)) /
                     (out.value - in.value);
}

void move_contact(Shot& shot, const Estimate& start_s, const Estimate& duration_s,
                  const ImpactBody& body, double gravity_m_s2) {
  const double angle = shot.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  const double later = start_s.value - shot.contact_start_s.value;
  const double vt = shot.before.vt_m_s.value, vn = shot.before.vn_m_s.value;
  const double fall_t = -gravity_m_s2 * s * later, fall_n = -gravity_m_s2 * c * later;
  const double along_t = (vt + fall_t / 2) * later, along_n = (vn + fall_n / 2) * later;
  shot.touch_x_m += c * along_t - s * along_n;
  shot.touch_y_m += s * along_t + c * along_n;
  shot.before.vt_m_s.value += fall_t;
  shot.before.vn_m_s.value += fall_n;
  const double after = start_s.value + duration_s.value - shot.contact_end_s.value;
  shot.after.vt_m_s.value -= gravity_m_s2 * s * after;
  shot.after.vn_m_s.value -= gravity_m_s2 * c * after;
  shot.contact_start_s = start_s;
  shot.contact_s = duration_s;
  shot.contact_end_s = {start_s.value + duration_s.value, std::max(start_s.sd, duration_s.sd)};
  shot.t_max_compression_s -= later;
  shot.max_deflection_m = {shot.max_deflection_m.value + along_n, std::abs(vn) * start_s.sd};
  derive(shot, body, gravity_m_s2);
}

Shot measure_shot(const Track& track, const ShotOptions& options) {
  return ShotAnalysis(track, options).run();
}

}  // namespace impactdic::sim::shot
