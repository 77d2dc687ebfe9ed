#include "host/impact/impact_figures.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/impact/impulse_figures.h"

namespace impactdic::impact {
namespace {

using SourceValues = ImpactSources::Vector;

struct Velocity {
  double t = 0, n = 0;
};

// The figures of one impact as functions of their sources.
class Figures {
 public:
  Figures(const ImpactSources& sources, const ImpactOptions& options)
      : s_(sources), options_(options) {}

  // In the surface's axes, turned by what its angle is in doubt of.
  Velocity before(const SourceValues& x) const {
    return turned({x[kVt0] + gt(x) * (x[kStart] - s_.before.at),
                   x[kVn0] + gn(x) * (x[kStart] - s_.before.at)},
                  x[kAngle]);
  }
  Velocity after(const SourceValues& x) const {
    return turned(
        {x[kVt1] + gt(x) * (x[kEnd] - s_.after.at), x[kVn1] + gn(x) * (x[kEnd] - s_.after.at)},
        x[kAngle]);
  }
  // In the picture's axes, y up, whatever the surface's angle is.
  Velocity in_picture(const Velocity& v, const SourceValues& x) const {
    return turned(v, -options_.surface_angle_rad - x[kAngle]);
  }

  // Impulses of the surface over the mass: gravity's taken off.
  Velocity impulse(const SourceValues& x) const {
    const Velocity in = before(x), out = after(x);
    const Velocity fall = turned({gt(x), gn(x)}, x[kAngle]);
    const double lasted = x[kEnd] - x[kStart];
    return {surface_impulse(in.t, out.t, fall.t * lasted),
            surface_impulse(in.n, out.n, fall.n * lasted)};
  }
  double ratio(const SourceValues& x) const {
    const Velocity j = impulse(x);
    return impulse_ratio(j.t, j.n);
  }
  double published_ratio(const SourceValues& x) const {
    const Velocity in = before(x), out = after(x);
    return impulse_ratio(surface_impulse(in.t, out.t), surface_impulse(in.n, out.n));
  }
  // Velocity of the ball's contact point along the surface.
  double tip(const SourceValues& x) const {
    const double spin = std::isfinite(x[kSpin0]) ? x[kSpin0] : 0.0;
    return tip_velocity(before(x).t, spin, x[kRadius]);
  }
  double restitution(const SourceValues& x) const {
    return impact::restitution(before(x).n, after(x).n);
  }
  double rolling_cap(const SourceValues& x) const {
    const Velocity in = before(x), out = after(x);
    // Without the spin after nothing is known of the tip's reversal.
    const double after =
        std::isfinite(x[kSpin1]) ? tip_velocity(out.t, x[kSpin1], x[kRadius]) : 0.0;
    return impact::rolling_cap(tip(x), after, *options_.inertia_factor,
                               surface_impulse(in.n, out.n));
  }
  double closing_inertia(const SourceValues& x) const {
    return impact::closing_inertia(impulse(x).t, x[kRadius], x[kSpin1] - x[kSpin0]);
  }

 private:
  // Axes that are turned counter-clockwise by `angle`.
  static Velocity turned(const Velocity& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.t + s * v.n, c * v.n - s * v.t};
  }
  double gn(const SourceValues& x) const { return x[kGravity] * s_.direction.n; }
  double gt(const SourceValues& x) const { return x[kGravity] * s_.direction.t; }

  const ImpactSources& s_;
  const ImpactOptions& options_;
};

constexpr double kHollow = 2.0 / 3, kSolid = 2.0 / 5;

// The turn of the surface's axes after which the impulse along the surface is the one that changes
// the spin: |J| sin(a + turn) = kappa R d(omega), where a is the impulse's angle to the normal. An
// inertia factor that is not known lies anywhere between those of a solid ball and a thin shell.
// The angle's tolerance is no part of it: the direction found is the same whatever was given.
Measured surface_off(ImpactSources s, const ImpactOptions& options) {
  s.covariance[static_cast<std::size_t>(ErrorSource::kAngle)].setZero();
  const Figures f(s, options);
  const auto turn = [&](const SourceValues& x, double inertia) {
    const Velocity j = f.impulse(x);
    const double along = inertia * x[kRadius] * (x[kSpin1] - x[kSpin0]);
    return std::asin(along / std::hypot(j.t, j.n)) - std::atan2(j.t, j.n);
  };
  const double inertia = options.inertia_factor.value_or((kHollow + kSolid) / 2);
  Measured off = propagate(s, [&](const SourceValues& x) { return turn(x, inertia); }).measured;
  if (!options.inertia_factor) {
    const double half = (turn(s.value, kHollow) - turn(s.value, kSolid)) / 2;
    off.sd = std::hypot(off.sd, half / std::sqrt(3.0));
  }
  return off;
}

Propagated spin(const ImpactSources& s, int source) {
  return propagate(s, [source](const SourceValues& x) { return x[source]; });
}

ImpulseClosure close(const ImpactSources& s, const Figures& f, const ImpactOptions& options,
                     ImpactAnalysis& result) {
  ImpulseClosure closure;
  const Measured change =
      propagate(s, [](const SourceValues& x) { return x[kSpin1] - x[kSpin0]; }).measured;
  if (!(std::abs(change.value) > 3 * change.sd)) return closure;
  const Measured inertia =
      noted(result, ImpactFigure::kClosingInertia,
            propagate(s, [&](const SourceValues& x) { return f.closing_inertia(x); }));
  closure.inertia_factor = inertia;
  if (!std::isfinite(inertia.value)) return closure;
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

// The figures of one flight, from kVx… of `first` on.
FlightMotion motion(const ImpactSources& s, const FlightRange& range, const Figures& f,
                    ImpactFigure first, int spin_source, ImpactAnalysis& result) {
  const bool in = first == ImpactFigure::kVxBefore;
  const auto local = [&](const SourceValues& x) { return in ? f.before(x) : f.after(x); };
  const auto global = [&](const SourceValues& x) { return f.in_picture(local(x), x); };
  auto next = static_cast<int>(first);
  const auto note = [&](const Propagated& p) {
    return noted(result, static_cast<ImpactFigure>(next++), p);
  };
  FlightMotion m;
  m.first = range.first;
  m.last = range.last;
  m.vx = note(propagate(s, [&](const SourceValues& x) { return global(x).t; }));
  m.vy = note(propagate(s, [&](const SourceValues& x) { return global(x).n; }));
  m.vt = note(propagate(s, [&](const SourceValues& x) { return local(x).t; }));
  m.vn = note(propagate(s, [&](const SourceValues& x) { return local(x).n; }));
  m.spin = note(spin(s, spin_source));
  return m;
}

}  // namespace

ImpactSources::ImpactSources() : value(SourceValues::Zero()), per_gravity(SourceValues::Zero()) {
  covariance.fill(Matrix::Zero());
}

void ImpactSources::add(ErrorSource kind, int source, double sd) {
  if (std::isfinite(sd)) covariance[static_cast<std::size_t>(kind)](source, source) += sd * sd;
}

void Propagated::add(ErrorSource kind, double sd) {
  double& part = budget.parts[static_cast<std::size_t>(kind)];
  part = std::hypot(part, sd);
  measured.sd = std::hypot(measured.sd, sd);
}

Measured noted(ImpactAnalysis& result, ImpactFigure figure, const Propagated& propagated) {
  result.budgets[static_cast<std::size_t>(figure)] = propagated.budget;
  return propagated.measured;
}

double crossing_of(const ImpactSources& s, const SourceValues& x) {
  // n + v (t - at) + g (t - at)^2 / 2 on both sides; g t^2 / 2 is the same.
  const double g = x[kGravity] * s.direction.n;
  const auto offset = [&](int n, int v, double at) { return x[n] - x[v] * at + g * at * at / 2; };
  const double apart = offset(kN0, kVn0, s.before.at) - offset(kN1, kVn1, s.after.at);
  return apart / (x[kVn1] - g * s.after.at - x[kVn0] + g * s.before.at);
}

Propagated propagate(const ImpactSources& s,
                     const std::function<double(const SourceValues&)>& figure) {
  Propagated result;
  const double value = figure(s.value);
  if (!std::isfinite(value)) return result;
  result.measured = {value, 0};
  ImpactSources::Matrix all = ImpactSources::Matrix::Zero();
  for (const auto& part : s.covariance) all += part;
  // Central differences; what a figure does not depend on, or depends on without being known (a
  // ball without spin measured), adds nothing.
  SourceValues slope = SourceValues::Zero();
  for (int i = 0; i < kImpactSources; ++i) {
    const double step = 0.1 * std::sqrt(all(i, i));
    if (!(step > 0) || !std::isfinite(s.value[i])) continue;
    SourceValues plus = s.value, minus = s.value;
    plus[i] += step;
    minus[i] -= step;
    slope[i] = (figure(plus) - figure(minus)) / (2 * step);
  }
  for (std::size_t kind = 0; kind < kErrorSources; ++kind) {
    const double variance = slope.dot(s.covariance[kind] * slope);
    result.add(static_cast<ErrorSource>(kind), std::sqrt(std::max(0.0, variance)));
  }
  constexpr double kStep = 0.01;  // of gravity: figures are nearly straight in it
  const SourceValues change = kStep * s.gravity() * s.per_gravity;
  result.budget.per_gravity = (figure(s.value + change) - figure(s.value - change)) / (2 * kStep);
  return result;
}

void fill_figures(const ImpactSources& s, const ImpactOptions& options, ImpactAnalysis& result) {
  const Figures f(s, options);
  result.before = motion(s, s.before, f, ImpactFigure::kVxBefore, kSpin0, result);
  result.after = motion(s, s.after, f, ImpactFigure::kVxAfter, kSpin1, result);
  const auto note = [&](ImpactFigure figure, const std::function<double(const SourceValues&)>& of) {
    return noted(result, figure, propagate(s, of));
  };
  result.restitution =
      note(ImpactFigure::kRestitution, [&](const SourceValues& x) { return f.restitution(x); });
  // Friction opposes the slip of the contact point.
  const double against = against_slip(f.tip(s.value));
  result.friction_published = note(ImpactFigure::kFrictionPublished, [&](const SourceValues& x) {
    return against * f.published_ratio(x);
  });
  result.friction =
      note(ImpactFigure::kFriction, [&](const SourceValues& x) { return against * f.ratio(x); });
  if (options.inertia_factor) {
    result.rolling_cap =
        note(ImpactFigure::kRollingCap, [&](const SourceValues& x) { return f.rolling_cap(x); });
  }
  result.closure = close(s, f, options, result);
  result.surface_off_rad = surface_off(s, options);
}

}  // namespace impactdic::impact
