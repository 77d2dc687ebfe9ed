#include "host/impact/contact_edge.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <unsupported/Eigen/NonLinearOptimization>
#include <vector>

namespace impactdic::impact {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// What the track says of the height: centres at instants, or steps between two.
struct Observation {
  double from, to;  // equal for a centre
  double value, sd;
};

// Centres where nothing else was measured; steps otherwise: the circle of a ball that is pressed
// against a surface is no measure of its centre of mass.
std::vector<Observation> observations(const ImpactSeries& s, double from, double to,
                                      double position_scale, double step_scale) {
  std::vector<Observation> result;
  const double usual = median_of(s.from_circle ? s.position_sd : s.step_sd);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double at = static_cast<double>(i), next = s.from_circle ? at : at + 1;
    if (at < from || next > to) continue;
    const double value = s.from_circle ? s.position_n[i] : s.step_n[i];
    double sd = s.from_circle ? s.position_sd[i] : s.step_sd[i];
    if (!(sd > 0)) sd = usual > 0 ? usual : 1e-2;
    sd *= s.from_circle ? position_scale : step_scale;
    if (std::isfinite(value)) result.push_back({at, next, value, sd});
  }
  return result;
}

// As MINPACK's Levenberg-Marquardt wants it.
struct Problem {
  using Scalar = double;
  using InputType = Vector;
  using ValueType = Vector;
  using JacobianType = Matrix;
  static constexpr int InputsAtCompileTime = Eigen::Dynamic;
  static constexpr int ValuesAtCompileTime = Eigen::Dynamic;

  std::function<void(const Vector&, Vector&)> residuals;
  int unknowns = 0, count = 0;

  int inputs() const { return unknowns; }
  int values() const { return count; }
  int operator()(const Vector& x, Vector& r) const {
    residuals(x, r);
    return r.allFinite() ? 0 : -1;
  }
  // Central differences; the unknowns are scaled to about one.
  int df(const Vector& x, Matrix& jacobian) const {
    Vector plus(count), minus(count);
    for (int i = 0; i < unknowns; ++i) {
      const double step = 1e-5 * std::max(1e-2, std::abs(x[i]));
      Vector moved = x;
      moved[i] += step;
      residuals(moved, plus);
      moved[i] -= 2 * step;
      residuals(moved, minus);
      jacobian.col(i) = (plus - minus) / (2 * step);
    }
    return jacobian.allFinite() ? 0 : -1;
  }
};

struct Solution {
  bool ok = false;
  Vector x, sd;
  double chi_square = 0;
  int freedom = 0;
};

Solution solve(Problem& problem, Vector start) {
  Solution solution;
  if (problem.count <= problem.unknowns) return solution;
  Eigen::LevenbergMarquardt<Problem> search(problem);
  search.parameters.maxfev = 200;
  search.parameters.xtol = search.parameters.ftol = 1e-11;
  if (search.minimize(start) == Eigen::LevenbergMarquardtSpace::UserAsked) return solution;
  Vector r(problem.count);
  problem.residuals(start, r);
  Matrix jacobian(problem.count, problem.unknowns);
  if (problem.df(start, jacobian) != 0 || !r.allFinite()) return solution;
  const Eigen::ColPivHouseholderQR<Matrix> qr(jacobian.transpose() * jacobian);
  if (!qr.isInvertible()) return solution;
  solution.x = start;
  solution.sd = qr.inverse().diagonal().cwiseMax(0.0).cwiseSqrt();
  solution.chi_square = r.squaredNorm();
  solution.freedom = problem.count - problem.unknowns;
  solution.ok = solution.sd.allFinite();
  return solution;
}

// Whether the misfit is what chance makes of it.
bool holds(const Solution& s) {
  return s.chi_square < s.freedom + 3.5 * std::sqrt(2.0 * s.freedom);
}

// The height before and after the touch at `touch`, in a time that runs from flight into contact.
class OnsetMotion {
 public:
  // What is added to the power law; v is the speed, v0 that at the touch.
  enum class Damper {
    striking,  // A v/v0
    fading,    // B (1 - v/v0)
    dragging,  // as fading, on a surface that is still dented where the force has faded: the power
               // law's deflection then counts from where K x^p = B
  };
  struct Law {
    double touch, height, speed;          // speed towards the surface, at the touch
    double stiffness, exponent, damping;  // in units of the scales below
    Damper damper;
    double gravity, deflection_scale, acceleration_scale;
  };
  OnsetMotion(const Law& law, double until) : law_(law) {
    if (law.damper == Damper::dragging && law.damping > 0 && law.stiffness > 0) {
      dent_ = std::pow(law.damping / law.stiffness, 1 / law.exponent);
    }
    // Enough for 1e-6 of the deflection at the deepest point.
    constexpr int kSteps = 64;
    step_ = std::max(until - law.touch, 1e-3) / kSteps;
    nodes_.reserve(kSteps + 1);
    Eigen::Vector2d y(0, law.speed);  // deflection and its rate
    nodes_.push_back(y);
    for (int i = 0; i < kSteps; ++i) {
      const Eigen::Vector2d k1 = rate(y), k2 = rate(y + step_ / 2 * k1),
                            k3 = rate(y + step_ / 2 * k2), k4 = rate(y + step_ * k3);
      y += step_ / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      nodes_.push_back(y);
    }
  }
  double height(double time) const {
    const double since = time - law_.touch;
    if (since <= 0) {
      return law_.height - law_.speed * since + law_.gravity * since * since / 2;
    }
    // Cubic Hermite between the nodes.
    const auto last = static_cast<double>(nodes_.size() - 2);
    const double cell = std::min(std::floor(since / step_), last);
    const auto i = static_cast<std::size_t>(cell);
    const double u = since / step_ - cell, w = 1 - u;
    const Eigen::Vector2d &a = nodes_[i], &b = nodes_[i + 1];
    const double x = w * w * (1 + 2 * u) * a[0] + u * u * (3 - 2 * u) * b[0] +
                     step_ * u * w * (w * a[1] - u * b[1]);
    return law_.height - x;
  }

 private:
  Eigen::Vector2d rate(const Eigen::Vector2d& y) const {
    const double x = std::max(y[0], 0.0) / law_.deflection_scale;
    const double slow = y[1] / law_.speed;
    double force = law_.stiffness * std::pow(x + dent_, law_.exponent);
    if (dent_ > 0) {
      force -= law_.damping * slow;
    } else {
      force += law_.damping * (law_.damper == Damper::striking ? slow : 1 - slow);
    }
    return {y[1], -law_.gravity - law_.acceleration_scale * force};
  }

  Law law_;
  double step_ = 0, dent_ = 0;
  std::vector<Eigen::Vector2d> nodes_;
};

class EdgeFit {
 public:
  EdgeFit(const ImpactSeries& series, const EdgeRequest& request)
      : request_(request), sign_(request.end ? -1 : 1) {
    const double inner = request.turn, outer = static_cast<double>(request.from);
    for (const Observation& o : observations(series, std::min(inner, outer), std::max(inner, outer),
                                             request.position_scale, request.step_scale)) {
      data_.push_back({sign_ * (request.end ? o.to : o.from), sign_ * (request.end ? o.from : o.to),
                       o.from == o.to ? o.value : sign_ * o.value, o.sd});
    }
    const double touch = sign_ * request.guess, until = sign_ * request.turn;
    speed_ = std::abs(request.flight.state[1]);
    deflection_scale_ = std::max(speed_ * (until - touch) * 2 / kPi, 1e-9);
    // Deviations to units of the noise.
    Eigen::Matrix2d covariance = request.flight.covariance;
    covariance(0, 1) *= sign_, covariance(1, 0) *= sign_;
    flight_ = {request.flight.state[0], sign_ * request.flight.state[1]};
    whiten_ = Eigen::LLT<Eigen::Matrix2d>(covariance.inverse()).matrixU();
    touch_ = touch;
    // A smooth and a hard onset; from the wrong one, or from too far off, the search may end in a
    // minimum that is not the least.
    for (const auto& [off, exponent, damping] :
         {std::array{0.0, 1.2, 0.02}, {1.5, 1.5, 0.1}, {-1.5, 1.0, 0.1}, {3.0, 1.1, 0.2}}) {
      Vector start(6);
      start << off, 0, 0, 1, exponent, damping;
      starts_.push_back(start);
    }
  }

  ContactEdge fit(double reach) {
    const double until = sign_ * request_.guess * (1 - reach) + sign_ * request_.turn * reach;
    std::vector<Observation> data;
    for (const Observation& o : data_) {
      if (o.to <= until) data.push_back(o);
    }
    using Damper = OnsetMotion::Damper;
    Solution s = least(data, until, request_.end ? Damper::fading : Damper::striking, starts_);
    ContactEdge edge;
    if (!s.ok) return edge;
    if (request_.end) s = averaged(s, least(data, until, Damper::dragging, {s.x}));
    // Touch, height and exponent do not depend on the damper.
    const OnsetMotion::Law found = law(s.x, Damper::striking);
    edge.ok = true;
    edge.misfit = s.chi_square / s.freedom;
    edge.law_holds = holds(s);
    const double inflation = edge.law_holds ? 1 : std::sqrt(edge.misfit);
    edge.instant = sign_ * found.touch;
    edge.sd = s.sd[0] * inflation;
    edge.exponent = found.exponent;
    edge.exponent_sd = s.sd[4] * inflation;
    edge.height = found.height;
    edge.reach = reach;
    return edge;
  }

 private:
  Solution least(const std::vector<Observation>& data, double until, OnsetMotion::Damper damper,
                 const std::vector<Vector>& starts) const {
    Problem problem;
    problem.unknowns = 6;
    problem.count = static_cast<int>(data.size()) + 2;
    problem.residuals = [&](const Vector& x, Vector& r) {
      const OnsetMotion::Law l = law(x, damper);
      const OnsetMotion motion(l, until);
      for (std::size_t i = 0; i < data.size(); ++i) {
        const Observation& o = data[i];
        const double model =
            o.from == o.to ? motion.height(o.from) : motion.height(o.to) - motion.height(o.from);
        r[static_cast<Eigen::Index>(i)] = (o.value - model) / o.sd;
      }
      r.tail<2>() = whiten_ * (flight_at(l) - flight_);
    };
    Solution s;
    for (const Vector& start : starts) {
      const Solution next = solve(problem, start);
      // The flight that was fitted ends where the data begin: nothing touches before.
      if (!next.ok || touch_ + next.x[0] < sign_ * static_cast<double>(request_.from)) continue;
      if (!s.ok || next.chi_square < s.chi_square) s = next;
      if (s.ok && holds(s)) break;
    }
    return s;
  }
  // The data can seldom tell whether the surface is still dented where the force has faded. Both
  // laws have a say, each by its likelihood, and their distance is part of the deviation (Bayesian
  // model averaging, Hoeting et al. 1999).
  static Solution averaged(const Solution& a, const Solution& b) {
    if (!b.ok) return a;
    const double weight = 1 / (1 + std::exp((b.chi_square - a.chi_square) / 2));  // of b
    const Vector apart = b.x - a.x;
    Solution s = b.chi_square < a.chi_square ? b : a;
    s.x = a.x + weight * apart;
    s.sd = ((1 - weight) * a.sd.cwiseAbs2() + weight * b.sd.cwiseAbs2() +
            weight * (1 - weight) * apart.cwiseAbs2())
               .cwiseSqrt();
    return s;
  }
  // Unknowns: touch (frames from the guess), speed and height (from those of the flight, in parts
  // of the speed), stiffness, exponent, damping.
  OnsetMotion::Law law(const Vector& x, OnsetMotion::Damper damper) const {
    const double speed = std::max(speed_ * (1 + 0.1 * x[1]), 0.1 * speed_);
    OnsetMotion::Law l{touch_ + x[0],
                       0,
                       speed,
                       x[3],
                       std::clamp(x[4], 0.3, 4.0),
                       x[5],
                       damper,
                       request_.gravity_n,
                       deflection_scale_,
                       request_.peak_acceleration};
    const double since = l.touch - sign_ * request_.flight.at;
    l.height = flight_[0] + flight_[1] * since + l.gravity * since * since / 2 + speed_ * x[2];
    return l;
  }
  // Height and velocity of the law's free flight where the measured one is given.
  Eigen::Vector2d flight_at(const OnsetMotion::Law& l) const {
    const double since = sign_ * request_.flight.at - l.touch;
    return {l.height - l.speed * since + l.gravity * since * since / 2,
            -l.speed + l.gravity * since};
  }

  EdgeRequest request_;
  double sign_, touch_ = 0;
  std::vector<Observation> data_;
  double speed_ = 0, deflection_scale_ = 1;
  Eigen::Vector2d flight_;
  Eigen::Matrix2d whiten_;
  std::vector<Vector> starts_;
};

}  // namespace

ContactEdge fit_edge(const ImpactSeries& series, const EdgeRequest& request) {
  EdgeFit fit(series, request);
  ContactEdge edge;
  for (const double reach : {0.95, 0.7, 0.5, 0.35}) {
    const ContactEdge next = fit.fit(reach);
    if (next.ok) edge = next;
    if (edge.law_holds) break;
  }
  return edge;
}

TurnInstant fit_turn(const ImpactSeries& series, double guess, double reach,
                     double peak_acceleration, double position_scale, double step_scale) {
  const std::vector<Observation> data =
      observations(series, guess - reach, guess + reach, position_scale, step_scale);
  TurnInstant turn;
  if (data.size() < 6) return turn;
  // Height about the turn at x[0]: line, parabola and its two-sided part of the velocity.
  const bool centres = series.from_circle;
  Problem problem;
  problem.unknowns = centres ? 5 : 4;
  problem.count = static_cast<int>(data.size());
  const double base = centres ? data[data.size() / 2].value : 0.0;
  problem.residuals = [&](const Vector& x, Vector& r) {
    const auto height = [&](double time) {
      const double s = (time - guess - x[0]) / reach;
      const double change = s * s * (x[1] / 2 + x[2] * s / 3 + x[3] * std::abs(s) / 3);
      return peak_acceleration * (reach * reach * change + (centres ? x[4] : 0.0)) + base;
    };
    for (std::size_t i = 0; i < data.size(); ++i) {
      const Observation& o = data[i];
      const double model = centres ? height(o.from) : height(o.to) - height(o.from);
      r[static_cast<Eigen::Index>(i)] = (o.value - model) / o.sd;
    }
  };
  Vector start = Vector::Zero(problem.unknowns);
  start[1] = 1;
  const Solution s = solve(problem, start);
  if (!s.ok || std::abs(s.x[0]) > reach) return turn;
  turn.ok = true;
  turn.instant = guess + s.x[0];
  turn.sd = s.sd[0] * (holds(s) ? 1 : std::sqrt(s.chi_square / s.freedom));
  return turn;
}

}  // namespace impactdic::impact
