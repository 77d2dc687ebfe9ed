#include "host/impact/impact_figures.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/impact/impulse_figures.h"

namespace impactdic::impact {
namespace {

using Vector = ImpactSources::Vector;

// The figures of one impact as functions of their sources.
class Figures {
 public:
  Figures(const ImpactSources& sources, const ImpactOptions& options, double radius_px)
      : s_(sources), options_(options), radius_(radius_px) {}

  double vn0(const Vector& x) const { return x[kVn0] + gn() * (x[kStart] - s_.before.at); }
  double vt0(const Vector& x) const { return x[kVt0] + gt() * (x[kStart] - s_.before.at); }
  double vn1(const Vector& x) const { return x[kVn1] + gn() * (x[kEnd] - s_.after.at); }
  double vt1(const Vector& x) const { return x[kVt1] + gt() * (x[kEnd] - s_.after.at); }

  // Impulses of the surface over the mass: gravity's taken off.
  double impulse_n(const Vector& x) const {
    return surface_impulse(vn0(x), vn1(x), gn() * (x[kEnd] - x[kStart]));
  }
  double impulse_t(const Vector& x) const {
    return surface_impulse(vt0(x), vt1(x), gt() * (x[kEnd] - x[kStart]));
  }
  double ratio(const Vector& x) const { return impulse_ratio(impulse_t(x), impulse_n(x)); }
  double published_ratio(const Vector& x) const {
    return impulse_ratio(surface_impulse(vt0(x), vt1(x)), surface_impulse(vn0(x), vn1(x)));
  }
  // Velocity of the ball's contact point along the surface.
  double tip(const Vector& x) const {
    const double spin = std::isfinite(x[kSpin0]) ? x[kSpin0] : 0.0;
    return tip_velocity(vt0(x), spin, radius_);
  }
  double restitution(const Vector& x) const { return impact::restitution(vn0(x), vn1(x)); }
  double rolling_cap(const Vector& x) const {
    // Without the spin after nothing is known of the tip's reversal.
    const double after = std::isfinite(x[kSpin1]) ? tip_velocity(vt1(x), x[kSpin1], radius_) : 0.0;
    return impact::rolling_cap(tip(x), after, *options_.inertia_factor,
                               surface_impulse(vn0(x), vn1(x)));
  }
  double closing_inertia(const Vector& x) const {
    return impact::closing_inertia(impulse_t(x), radius_, x[kSpin1] - x[kSpin0]);
  }

 private:
  double gn() const { return s_.gravity * s_.direction.n; }
  double gt() const { return s_.gravity * s_.direction.t; }

  const ImpactSources& s_;
  const ImpactOptions& options_;
  double radius_;
};

FlightMotion motion(const ImpactSources& s, const FlightRange& range, Measured spin, double angle,
                    const std::function<double(const Vector&)>& vt,
                    const std::function<double(const Vector&)>& vn) {
  const double c = std::cos(angle), n = std::sin(angle);
  FlightMotion m;
  m.first = range.first;
  m.last = range.last;
  m.vt = propagate(s, vt);
  m.vn = propagate(s, vn);
  m.vx = propagate(s, [&](const Vector& x) { return c * vt(x) - n * vn(x); });
  m.vy = propagate(s, [&](const Vector& x) { return n * vt(x) + c * vn(x); });
  m.spin = spin;
  return m;
}

ImpulseClosure close(const ImpactSources& s, const Figures& f, const ImpactOptions& options) {
  ImpulseClosure closure;
  const Measured change = propagate(s, [](const Vector& x) { return x[kSpin1] - x[kSpin0]; });
  if (!(std::abs(change.value) > 3 * change.sd)) return closure;
  const Measured inertia = propagate(s, [&](const Vector& x) { return f.closing_inertia(x); });
  closure.inertia_factor = inertia;
  if (!std::isfinite(inertia.value)) return closure;
  constexpr double kHollow = 2.0 / 3, kSolid = 2.0 / 5;
  // Without a given inertia: that of the sphere which suits better.
  const double assumed = options.inertia_factor.value_or(
      std::abs(inertia.value - kSolid) < std::abs(inertia.value - kHollow) ? kSolid : kHollow);
  if (options.inertia_factor) {
    closure.ratio = {inertia.value / assumed, inertia.sd / assumed};
  }
  const double off = std::abs(inertia.value / assumed - 1);
  const double allowed = 2 * inertia.sd / assumed + 0.02;
  if (inertia.value + 2 * inertia.sd < 0) {
    closure.verdict = ClosureVerdict::kSigns;
  } else if (off <= allowed) {
    closure.verdict = ClosureVerdict::kCloses;
  } else if (inertia.sd / assumed > 0.5) {
    closure.verdict = ClosureVerdict::kUndetermined;
  } else {
    closure.verdict = off < 0.25 ? ClosureVerdict::kLeverArm : ClosureVerdict::kScale;
  }
  return closure;
}

}  // namespace

double crossing_of(const ImpactSources& s, const Vector& x) {
  // n + v (t - at) + g (t - at)^2 / 2 on both sides; g t^2 / 2 is the same.
  const double g = s.gravity * s.direction.n;
  const auto offset = [&](int n, int v, double at) { return x[n] - x[v] * at + g * at * at / 2; };
  const double apart = offset(kN0, kVn0, s.before.at) - offset(kN1, kVn1, s.after.at);
  return apart / (x[kVn1] - g * s.after.at - x[kVn0] + g * s.before.at);
}

Measured propagate(const ImpactSources& s, const std::function<double(const Vector&)>& figure) {
  Measured result;
  result.value = figure(s.value);
  if (!std::isfinite(result.value)) return {};
  // Central differences; what a figure does not depend on, or depends on without being known (a
  // ball without spin measured), adds nothing.
  Vector slope = Vector::Zero();
  for (int i = 0; i < kImpactSources; ++i) {
    const double step = 0.1 * std::sqrt(s.covariance(i, i));
    if (!(step > 0) || !std::isfinite(s.value[i])) continue;
    Vector plus = s.value, minus = s.value;
    plus[i] += step;
    minus[i] -= step;
    slope[i] = (figure(plus) - figure(minus)) / (2 * step);
  }
  result.sd = std::sqrt(std::max(0.0, slope.dot(s.covariance * slope)));
  return result;
}

void fill_figures(const ImpactSources& s, const ImpactOptions& options, ImpactAnalysis& result) {
  const Figures f(s, options, result.radius_px);
  const auto vt0 = [&](const Vector& x) { return f.vt0(x); };
  const auto vn0 = [&](const Vector& x) { return f.vn0(x); };
  const auto vt1 = [&](const Vector& x) { return f.vt1(x); };
  const auto vn1 = [&](const Vector& x) { return f.vn1(x); };
  const auto spin = [&](int i) {
    return std::isfinite(s.value[i]) ? Measured{s.value[i], std::sqrt(s.covariance(i, i))}
                                     : Measured{};
  };
  const double angle = options.surface_angle_rad;
  result.before = motion(s, s.before, spin(kSpin0), angle, vt0, vn0);
  result.after = motion(s, s.after, spin(kSpin1), angle, vt1, vn1);
  result.restitution = propagate(s, [&](const Vector& x) { return f.restitution(x); });
  // Friction opposes the slip of the contact point.
  const double against = against_slip(f.tip(s.value));
  result.friction_published =
      propagate(s, [&](const Vector& x) { return against * f.published_ratio(x); });
  result.friction = propagate(s, [&](const Vector& x) { return against * f.ratio(x); });
  if (options.inertia_factor) {
    result.rolling_cap = propagate(s, [&](const Vector& x) { return f.rolling_cap(x); });
  }
  result.closure = close(s, f, options);
}

}  // namespace impactdic::impact
