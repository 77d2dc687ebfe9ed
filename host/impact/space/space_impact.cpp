#include "host/impact/space/space_impact.h"

#include <array>
#include <cmath>
#include <functional>

#include "host/impact/impulse_figures.h"

namespace impactdic::impact {
namespace {

// The sources of the figures, all independent: the analysis of the plane states no covariances.
enum Source {
  kVt,  // before
  kVb,
  kImpulseT,  // over the mass
  kImpulseN,
  kSpinTBefore,
  kSpinNBefore,
  kSpinBBefore,
  kSpinTAfter,
  kSpinNAfter,
  kRadiusPx,
  kSources
};
using Values = std::array<double, kSources>;

class SpaceFigures {
 public:
  SpaceFigures(const std::array<Measured, kSources>& sources, std::optional<double> inertia_factor)
      : sources_(sources), inertia_(inertia_factor.value_or(kNotMeasured)) {}

  Tangential slip(const Values& x) const {
    return tip_velocity({x[kVt], x[kVb]}, x[kSpinBBefore], x[kSpinTBefore], x[kRadiusPx]);
  }
  // Impulse ratio.
  Tangential friction(const Values& x) const {
    const double impulse_b = -inertia_ * x[kRadiusPx] * (x[kSpinTAfter] - x[kSpinTBefore]);
    return {x[kImpulseT] / x[kImpulseN], impulse_b / x[kImpulseN]};
  }
  // From the direction against the slip to the friction, positive from t towards b.
  double friction_off(const Values& x) const {
    const Tangential f = friction(x), s = slip(x);
    return std::atan2(f.t * s.b - f.b * s.t, -(f.t * s.t + f.b * s.b));
  }

  Measured propagate(const std::function<double(const Values&)>& figure) const {
    Values at;
    for (std::size_t i = 0; i < kSources; ++i) at[i] = sources_[i].value;
    Measured result{figure(at), 0};
    if (!std::isfinite(result.value)) return {};
    for (std::size_t i = 0; i < kSources; ++i) {
      const double step = 0.1 * sources_[i].sd;
      if (!(step > 0)) continue;
      Values plus = at, minus = at;
      plus[i] += step, minus[i] -= step;
      result.sd = std::hypot(result.sd, (figure(plus) - figure(minus)) / 0.2);
    }
    return result;
  }

 private:
  std::array<Measured, kSources> sources_;
  double inertia_;
};

}  // namespace

std::optional<SpaceImpact> space_impact(const ImpactOptions& options, const ImpactAnalysis& plane) {
  if (!std::isfinite(plane.before.spin_t.value) || !std::isfinite(plane.after.spin_t.value)) {
    return std::nullopt;
  }
  SpaceImpact space;
  space.spin_before = {plane.before.spin_t, plane.before.spin_n, plane.before.spin};
  space.spin_after = {plane.after.spin_t, plane.after.spin_n, plane.after.spin};
  for (MeasuredVector* spin : {&space.spin_before, &space.spin_after}) {
    // The surface's angle mixes the two.
    const double angle_sd = options.surface_angle_sd_rad;
    const double t = spin->t.value, n = spin->n.value;
    spin->t.sd = std::hypot(spin->t.sd, n * angle_sd);
    spin->n.sd = std::hypot(spin->n.sd, t * angle_sd);
  }
  // Gravity is taken off the impulses.
  const double gravity = options.gravity.value_or(plane.fall.value);
  const double lasted = std::isfinite(plane.duration.value) ? plane.duration.value : 0.0;
  const double angle = options.gravity_angle_rad - options.surface_angle_rad;
  const auto difference = [](const Measured& a, const Measured& b, double off) {
    return Measured{a.value - b.value - off, std::hypot(a.sd, b.sd)};
  };
  const SpaceFigures figures(
      {plane.before.vt, std::isfinite(plane.before.vb.value) ? plane.before.vb : Measured{0, 0},
       difference(plane.after.vt, plane.before.vt, gravity * std::cos(angle) * lasted),
       difference(plane.after.vn, plane.before.vn, gravity * std::sin(angle) * lasted),
       space.spin_before.t, space.spin_before.n, space.spin_before.b, space.spin_after.t,
       space.spin_after.n, plane.radius_px},
      options.inertia_factor);
  space.slip_t = figures.propagate([&](const Values& x) { return figures.slip(x).t; });
  space.slip_b = figures.propagate([&](const Values& x) { return figures.slip(x).b; });
  space.friction_t = figures.propagate([&](const Values& x) { return figures.friction(x).t; });
  space.friction_b = figures.propagate([&](const Values& x) { return figures.friction(x).b; });
  space.friction = figures.propagate([&](const Values& x) {
    const Tangential f = figures.friction(x);
    return std::hypot(f.t, f.b);
  });
  space.friction_off_rad =
      figures.propagate([&](const Values& x) { return figures.friction_off(x); });
  space.spin_change_n =
      figures.propagate([](const Values& x) { return x[kSpinNAfter] - x[kSpinNBefore]; });
  return space;
}

}  // namespace impactdic::impact
