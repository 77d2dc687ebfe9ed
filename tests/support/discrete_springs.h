// Partial slip by following many springs one by one: an independent reference for
// maw_barber_fawcett. Each spring is pressed, dragged along and clipped to Coulomb's limit in turn;
// a damper that pushes adds its friction where springs slip, one that pulls takes load off them.
//
// The error falls with the square of the number of springs, since nothing in here is rounded to
// whole springs or whole steps: a spring that is touched within a step moves for its part of the
// step, and the edge of what slips is interpolated between springs. The damper's friction, which
// jumps with the slip, follows Moreau (1988): it stops the slip within a step, but does not turn it
// round.
#pragma once

#include <impactdic/impact_model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace impactdic::support {

struct SpringsOutcome {
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
};

// The deflection by the classical method of Runge and Kutta; nothing along the surface acts on it.
class NormalPath {
 public:
  explicit NormalPath(const ImpactJob& job)
      : mass_(job.body.mass_kg),
        stiffness_(job.contact.stiffness),
        damping_(job.contact.damping_n_s_per_m),
        damped_(job.contact.restitution_damping != RestitutionDamping::kNone),
        weight_(job.body.mass_kg * job.gravity_m_s2 *
                std::cos(job.surface_angle_deg * 3.14159265358979323846 / 180)),
        rate_(-job.initial.vn_m_s) {}

  double depth() const { return depth_; }
  double rate() const { return rate_; }
  bool compressing() const { return compressing_; }
  double force() const { return force(depth_, rate_); }
  // Of the springs along the surface.
  double reach() const {
    if (compressing_ || !damped_ || damping_ == 0) return depth_;
    return std::pow(std::max(force(), 0.0) / stiffness_, 2.0 / 3.0);
  }
  bool over() const { return !compressing_ && (depth_ <= 0 || force() <= 0); }

  void step(double dt) {
    std::array<double, 5> way{0, rate_, 0, 0, 0}, pull{0, 0, 0, 0, 0};
    const double part[] = {0, 0, 0.5, 0.5, 1};
    for (int i = 1; i < 5; ++i) {
      const double rate = rate_ + part[i] * dt * pull[i - 1];
      const double depth = depth_ + part[i] * dt * way[i - 1];
      way[i] = rate;
      pull[i] = -(force(depth, rate) - weight_) / mass_;
    }
    depth_ += dt / 6 * (way[1] + 2 * way[2] + 2 * way[3] + way[4]);
    rate_ += dt / 6 * (pull[1] + 2 * pull[2] + 2 * pull[3] + pull[4]);
    if (rate_ < 0) compressing_ = false;
  }

 private:
  double force(double depth, double rate) const {
    const double damper = rate > 0 || damped_ ? damping_ * rate : 0;
    return stiffness_ * std::pow(std::max(depth, 0.0), 1.5) + damper;
  }

  double mass_, stiffness_, damping_;
  bool damped_;
  double weight_, depth_ = 0, rate_;
  bool compressing_ = true;
};

// The springs of one half of the contact, from its middle outwards.
class SpringRow {
 public:
  SpringRow(double radius, double largest_depth, int springs, double alpha)
      : dx_(std::sqrt(radius * largest_depth) / springs),
        alpha_(alpha),
        u_(springs, 0.0),
        inside_(springs, 0.0),
        pressed_(springs) {
    for (int i = 0; i < springs; ++i) pressed_[i] = std::pow((i + 0.5) * dx_, 2) / radius;
  }

  // The contact becomes `reach` deep and its point moves by `way`.
  void move(double reach, double way) {
    const std::size_t before = touched_;
    while (touched_ < u_.size() && pressed_[touched_] < reach) ++touched_;
    while (touched_ > 0 && pressed_[touched_ - 1] >= reach) u_[--touched_] = 0;
    sum_ = 0;
    for (std::size_t i = 0; i < touched_; ++i) {
      const double new_part = (reach - pressed_[i]) / (reach - reach_);
      const double moved = u_[i] + (i < before ? way : new_part * way);
      const double bound = alpha_ * (reach - pressed_[i]);
      u_[i] = std::clamp(moved, -bound, bound);
      inside_[i] = bound - std::abs(moved);
      sum_ += u_[i];
    }
    reach_ = reach;
  }
  // int u dx of the half.
  double sum() const { return sum_ * dx_; }

  // The part of the pressure that rests on springs at their bound; negative at the lower bound.
  double share_at_bound() const {
    double all = 0, share = 0;
    const double least = 1e-9 * alpha_ * reach_;
    for (std::size_t i = 0; i < touched_; ++i) {
      const double uz = reach_ - pressed_[i];
      all += uz;
      if (inside_[i] > least) continue;
      share += u_[i] > 0 ? uz : -uz;
      // The edge lies between the springs, where the distance from the bound goes to zero.
      if (i < 2 || !(inside_[i - 1] > least)) continue;
      const double slope = inside_[i - 2] - inside_[i - 1];
      const double beyond = slope > 0 ? std::min(inside_[i - 1] / slope, 1.0) : 0.5;
      share +=
          (u_[i] > 0 ? 1 : -1) * (reach_ - 0.5 * (pressed_[i] + pressed_[i - 1])) * (0.5 - beyond);
    }
    return all > 0 ? share / all : 0;
  }

 private:
  double dx_, alpha_, reach_ = 0, sum_ = 0;
  std::size_t touched_ = 0;
  std::vector<double> u_, inside_, pressed_;  // inside_: how far from its bound
};

// How fast springs slip along their bound at a step's end. `change`: by the springs alone; the
// damper slows the slip by up to `slowed`, stops it within the step, and may then hold it, but
// does not turn it round.
inline double slip_left(double slip, double change, double slowed) {
  const double free = slip + change;
  if (free >= slowed) return free - slowed;
  if (slip <= 0 || change >= 0) return std::min(free, 0.0);
  return (1 - std::min(slip / (slowed - change), 1.0)) * change;  // stopped within the step
}

// `steps` steps per duration of the undamped contact, without gravity along the surface.
inline SpringsOutcome discrete_springs(const ImpactJob& job, int springs, int steps) {
  const double m = job.body.mass_kg, radius = job.body.radius_m(), inertia = job.body.inertia();
  const double k = job.contact.stiffness, nu = job.contact.poisson;
  const double mu = job.contact.friction_kinetic, b = job.contact.damping_n_s_per_m;
  const double ratio = 2 * (1 - nu) / (2 - nu), modulus = 0.75 * k / std::sqrt(radius);
  const double alpha = mu / ratio, speed = -job.initial.vn_m_s;
  const double mobility = 1 / m + radius * radius / inertia;
  const double undamped = std::pow(1.25 * m * speed * speed / k, 0.4);
  const double dt = 2.94328 * undamped / speed / steps;
  NormalPath normal(job);
  SpringRow row(radius, 1.02 * undamped, springs, alpha);
  const double first = job.initial.vt_m_s + radius * job.initial.omega_rad_s;
  // At the touch all springs are at their bound, or none.
  double share = std::abs(first) > alpha * speed ? (first > 0) - (first < 0) : 0;
  // The velocity is that of the steps' middles.
  double tip = first, last_rate = speed, before_s = 0.5 * dt;
  for (int step = 0; step < 60 * steps && !normal.over(); ++step) {
    const double damper = normal.compressing() ? mu * b * normal.rate() * share : 0;
    normal.step(0.5 * dt);
    const double springs_only = tip - before_s * mobility * 2 * ratio * modulus * row.sum();
    const double side = damper > 0 ? 1 : -1;
    const double slip = side * tip - alpha * last_rate;
    const double slip_change = side * springs_only - alpha * normal.rate() - slip;
    const double left = slip_left(slip, slip_change, before_s * mobility * std::abs(damper));
    tip = damper == 0 ? springs_only : side * (alpha * normal.rate() + left);
    last_rate = normal.rate();
    before_s = dt;
    normal.step(0.5 * dt);
    row.move(normal.reach(), dt * tip);
    if (normal.compressing() && b > 0) share = row.share_at_bound();
  }
  const double impulse = (tip - first) / mobility;
  return {job.initial.vt_m_s + impulse / m, -normal.rate(),
          job.initial.omega_rad_s + radius * impulse / inertia};
}

// The velocity of the contact point along the surface after the impact.
inline double discrete_springs_tip(const ImpactJob& job, int springs, int steps) {
  const SpringsOutcome s = discrete_springs(job, springs, steps);
  return s.vt_m_s + job.body.radius_m() * s.omega_rad_s;
}

}  // namespace impactdic::support
