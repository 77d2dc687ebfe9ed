#include "host/impact/contact_edge.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/impact/least_squares.h"
#include "host/impact/onset_motion.h"

namespace impactdic::impact {
namespace {

using Vector = Eigen::VectorXd;

// What the track says of the height: centres at instants, or steps between two.
struct Observation {
  double from, to;  // equal for a centre
  double value, sd;
};

// Of the whole track.
double usual_deviation(const ImpactSeries& s) {
  std::vector<double> sds;
  sds.reserve(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    sds.push_back(s.from_circle ? s.position_sd(i) : s.step_sd(i));
  }
  return upper_median(finite(std::move(sds)));
}

// Centres where nothing else was measured; steps otherwise: the circle of a ball that is pressed
// against a surface is no measure of its centre of mass.
std::vector<Observation> observations(const ImpactSeries& s, double from, double to,
                                      double position_scale, double step_scale) {
  std::vector<Observation> result;
  std::optional<double> usual;  // where it is needed
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double at = static_cast<double>(i), next = s.from_circle ? at : at + 1;
    if (at < from || next > to) continue;
    const double value = s.from_circle ? s.position_n[i] : s.step_n[i];
    double sd = s.from_circle ? s.position_sd(i) : s.step_sd(i);
    if (!(sd > 0)) {
      if (!usual) usual = usual_deviation(s);
      sd = *usual > 0 ? *usual : 1e-2;
    }
    sd *= s.from_circle ? position_scale : step_scale;
    if (std::isfinite(value)) result.push_back({at, next, value, sd});
  }
  return result;
}

// Short or noisy contacts seldom tell touch, exponent and damper apart. What the laws of contact
// have in common is part of the data: a power about the linear spring's 1 and Hertz's 1.5, and a
// damper of less than the peak force that does not push.
constexpr double kTolerance = 1e-8;
constexpr double kUsualExponent = 1.25, kExponentSd = 0.35;
constexpr double kUsualDamping = 0.15, kDampingSd = 0.5;
constexpr double kPushingSd = 0.02;

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

  // Up to so much of the way to the maximum compression; the last of these is kept in any case.
  ContactEdge fit(double reach, bool is_last) {
    const double until = sign_ * request_.guess * (1 - reach) + sign_ * request_.turn * reach;
    std::vector<Observation> data;
    for (const Observation& o : data_) {
      if (o.to <= until) data.push_back(o);
    }
    ContactEdge edge;
    const std::vector<LawMinima> laws = minima_of_laws(data, until);
    if (laws.empty()) return edge;
    std::vector<Solution> found;
    for (const LawMinima& one : laws) {
      found.insert(found.end(), one.minima.begin(), one.minima.end());
    }
    const Solution& best = best_of(found);
    const bool alone = request_.likeliest_alone || (!holds(best) && !is_last);
    const Solution s = alone ? best : averaged(best, touches_of(laws));
    // Touch, height and exponent do not depend on the damper.
    const OnsetLaw<double> l = law(s.x.data(), Damper::kStriking);
    edge.ok = true;
    edge.misfit = s.chi_square / s.freedom;
    edge.law_holds = holds(best);
    const double inflation = edge.law_holds ? 1 : std::sqrt(edge.misfit);
    edge.instant = sign_ * l.touch;
    edge.sd = s.sd[0] * inflation;
    edge.exponent = l.exponent;
    edge.exponent_sd = s.sd[4] * inflation;
    edge.height = l.height;
    edge.reach = reach;
    return edge;
  }

 private:
  static constexpr int kUnknowns = 6;
  static constexpr double kSame = 0.3;     // deviations of the touch between searches that agree
  static constexpr double kUnlikely = 12;  // chi square more than the least
  static constexpr double kShortestStep = 1e-3, kLongestStep = 0.5;  // frames, the first of them
  static constexpr double kStepGrowth = 1.25;
  static constexpr int kMostTouches = 40;

  // What is fitted, up to which time, by which law.
  struct Fit {
    const std::vector<Observation>& data;
    double until;
    Damper damper;
  };
  struct LawMinima {
    Fit fit;
    std::vector<Solution> minima;  // one or more
  };
  // A touch at a given instant, with all else fitted, and the part of time that it stands for.
  struct Touch {
    Solution solution;
    double share;
  };

  // Each law is searched from the minima of the one before it.
  std::vector<LawMinima> minima_of_laws(const std::vector<Observation>& data, double until) const {
    const std::vector<Damper> dampers = request_.end
                                            ? std::vector{Damper::kFading, Damper::kDragging}
                                            : std::vector{Damper::kStriking};
    std::vector<LawMinima> laws;
    std::vector<Vector> starts = starts_;
    for (const Damper damper : dampers) {
      LawMinima law{{data, until, damper}, {}};
      law.minima = minima(law.fit, starts);
      if (law.minima.empty()) continue;
      starts.clear();
      for (const Solution& one : law.minima) starts.push_back(one.x);
      laws.push_back(std::move(law));
    }
    return laws;
  }
  static const Solution& best_of(const std::vector<Solution>& found) {
    return *std::min_element(found.begin(), found.end(), [](const Solution& a, const Solution& b) {
      return a.chi_square < b.chi_square;
    });
  }
  // What a misfit that is no chance widens deviations by, squared.
  static double scatter_of(const Solution& best) {
    return holds(best) ? 1 : best.chi_square / best.freedom;
  }

  // Of the data, the flight before and what laws of contact have in common.
  auto residuals_of(const Fit& fit) const {
    return [this, fit]<typename T>(const T* x, T* r) {
      const OnsetLaw<T> l = law(x, fit.damper);
      const OnsetMotion<T> motion(l, fit.until);
      for (const Observation& o : fit.data) {
        const T model =
            o.from == o.to ? motion.height(o.from) : T(motion.height(o.to) - motion.height(o.from));
        *r++ = (o.value - model) / o.sd;
      }
      const std::array<T, 2> flight = flight_at(l);
      const T height = flight[0] - flight_[0], speed = flight[1] - flight_[1];
      *r++ = whiten_(0, 0) * height + whiten_(0, 1) * speed;
      *r++ = whiten_(1, 1) * speed;
      *r++ = (x[4] - kUsualExponent) / kExponentSd;
      *r++ = (x[5] - kUsualDamping) / kDampingSd;
      *r++ = std::min(T(0.0), x[5]) / kPushingSd;
    };
  }
  static int count_of(const Fit& fit) { return static_cast<int>(fit.data.size()) + 5; }

  // All that the searches from `starts` end in, each once.
  std::vector<Solution> minima(const Fit& fit, const std::vector<Vector>& starts) const {
    std::vector<Solution> found;
    for (const Vector& start : starts) {
      const Solution next = solve<kUnknowns>(residuals_of(fit), count_of(fit), start, kTolerance);
      // The flight that was fitted ends where the data begin: nothing touches before.
      if (!next.ok || next.x[0] < earliest()) continue;
      const auto same = std::find_if(found.begin(), found.end(), [&](const Solution& other) {
        return std::abs(next.x[0] - other.x[0]) < kSame * std::max(next.sd[0], other.sd[0]);
      });
      if (same == found.end()) {
        found.push_back(next);
      } else if (next.chi_square < same->chi_square) {
        *same = next;
      }
    }
    return found;
  }

  double earliest() const { return sign_ * static_cast<double>(request_.from) - touch_; }

  std::vector<Touch> touches_of(const std::vector<LawMinima>& laws) const {
    std::vector<Touch> touches;
    for (const LawMinima& one : laws) add_touches(one.fit, one.minima, touches);
    return touches;
  }
  // On both sides of the best of `found`, until none is likely.
  void add_touches(const Fit& fit, const std::vector<Solution>& found,
                   std::vector<Touch>& touches) const {
    const Solution& best = best_of(found);
    const double unlikely = best.chi_square + kUnlikely * scatter_of(best);
    const double first_step = std::clamp(best.sd[0] / 2, kShortestStep, kLongestStep);
    const auto is_beyond_all = [&](double at, double way) {
      return std::none_of(found.begin(), found.end(), [&](const Solution& one) {
        return way * (one.x[0] - at) > 0 && one.chi_square < unlikely;
      });
    };
    for (const double way : {-1.0, 1.0}) {
      Vector rest = best.x.tail(kUnknowns - 1);
      double step = first_step, at = way < 0 ? best.x[0] : best.x[0] + step;
      for (int k = 0; k < kMostTouches && at > earliest() && at < fit.until - touch_; ++k) {
        const Solution next = touching(fit, at, rest);
        if (next.ok) {
          touches.push_back({next, step});
          rest = next.x.tail(kUnknowns - 1);
          if (next.chi_square > unlikely && is_beyond_all(at, way)) break;
        }
        step *= kStepGrowth;
        at += way * step;
      }
    }
  }
  Solution touching(const Fit& fit, double at, const Vector& rest) const {
    const auto residuals = [at, all = residuals_of(fit)]<typename T>(const T* x, T* r) {
      const std::array<T, kUnknowns> whole{T(at), x[0], x[1], x[2], x[3], x[4]};
      all(whole.data(), r);
    };
    Solution s = solve<kUnknowns - 1>(residuals, count_of(fit), rest, kTolerance);
    if (!s.ok) return s;
    Vector x(kUnknowns), sd(kUnknowns);
    x << at, s.x;
    sd << 0, s.sd;
    s.x = x, s.sd = sd;
    return s;
  }

  // A soft touch some frames before a hard one may describe the data as well, and the data can
  // seldom tell whether the surface is still dented where the force has faded. Every touch has a
  // say, by its profile likelihood (Venzon and Moolgavkar 1988), and so has every law
  // (Hoeting et al. 1999); their distances are part of the deviation.
  static Solution averaged(const Solution& best, const std::vector<Touch>& touches) {
    if (touches.empty()) return best;
    double least = best.chi_square;
    for (const Touch& one : touches) least = std::min(least, one.solution.chi_square);
    const auto weight = [&](const Touch& one) {
      return one.share * std::exp((least - one.solution.chi_square) / (2 * scatter_of(best)));
    };
    double weights = 0;
    Vector mean = Vector::Zero(kUnknowns), variance = mean;
    for (const Touch& one : touches) {
      weights += weight(one), mean += weight(one) * one.solution.x;
    }
    mean /= weights;
    for (const Touch& one : touches) {
      const Solution& t = one.solution;
      variance += weight(one) * (t.sd.cwiseAbs2() + (t.x - mean).cwiseAbs2());
    }
    Solution s = best;
    s.x = mean, s.sd = (variance / weights).cwiseSqrt();
    return s;
  }
  // Unknowns: touch (frames from the guess), speed and height (from those of the flight, in parts
  // of the speed), stiffness, exponent, damping.
  template <typename T>
  OnsetLaw<T> law(const T* x, Damper damper) const {
    const T speed = std::max(T(speed_ * (1.0 + 0.1 * x[1])), T(0.1 * speed_));
    OnsetLaw<T> l{touch_ + x[0],
                  T(0.0),
                  speed,
                  x[3],
                  std::clamp(x[4], T(0.3), T(4.0)),
                  x[5],
                  damper,
                  request_.gravity_n,
                  deflection_scale_,
                  request_.peak_acceleration};
    const T since = l.touch - sign_ * request_.flight.at;
    l.height = flight_[0] + flight_[1] * since + l.gravity * since * since / 2.0 + speed_ * x[2];
    return l;
  }
  // Height and velocity of the law's free flight where the measured one is given.
  template <typename T>
  std::array<T, 2> flight_at(const OnsetLaw<T>& l) const {
    const T since = sign_ * request_.flight.at - l.touch;
    return {l.height - l.speed * since + l.gravity * since * since / 2.0,
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

// Height about the turn at x[0], in `reach`: line, parabola and its two-sided part of the velocity;
// of centres also the level.
template <bool kCentres>
struct TurnResiduals {
  static constexpr int kUnknowns = kCentres ? 5 : 4;
  const std::vector<Observation>& data;
  double guess, reach, peak_acceleration, base;

  template <typename T>
  T height(const T* x, double time) const {
    using std::abs;
    const T s = (time - guess - x[0]) / reach;
    T change = reach * reach * s * s * (x[1] / 2.0 + x[2] * s / 3.0 + x[3] * abs(s) / 3.0);
    if constexpr (kCentres) change += x[4];
    return peak_acceleration * change + base;
  }
  template <typename T>
  void operator()(const T* x, T* r) const {
    for (const Observation& o : data) {
      T model = height(x, o.to);
      if constexpr (!kCentres) model -= height(x, o.from);
      *r++ = (o.value - model) / o.sd;
    }
  }
  Solution solved() const {
    Vector start = Vector::Zero(kUnknowns);
    start[1] = 1;
    return solve<kUnknowns>(*this, static_cast<int>(data.size()), start, kTolerance);
  }
};

}  // namespace

ContactEdge fit_edge(const ImpactSeries& series, const EdgeRequest& request) {
  EdgeFit fit(series, request);
  ContactEdge edge;
  constexpr std::array kReaches = {0.95, 0.7, 0.5, 0.35};
  for (const double reach : kReaches) {
    const ContactEdge next = fit.fit(reach, reach == kReaches.back());
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
  const double base = series.from_circle ? data[data.size() / 2].value : 0.0;
  const Solution s =
      series.from_circle
          ? TurnResiduals<true>{data, guess, reach, peak_acceleration, base}.solved()
          : TurnResiduals<false>{data, guess, reach, peak_acceleration, base}.solved();
  if (!s.ok || std::abs(s.x[0]) > reach) return turn;
  turn.ok = true;
  turn.instant = guess + s.x[0];
  const double inflation = holds(s) ? 1 : std::sqrt(s.chi_square / s.freedom);
  turn.sd = s.sd[0] * inflation;
  if (series.from_circle) {
    turn.height = base + peak_acceleration * s.x[4];
    turn.height_sd = std::abs(peak_acceleration) * s.sd[4] * inflation;
  }
  return turn;
}

}  // namespace impactdic::impact
