#include "sim/rod/rod_dynamics.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::sim::rod {
namespace {

// n-th root (from 1) of cos(bL) cosh(bL) = 1, the free-free beam, by Newton's method.
double free_free_root(int n) {
  double z = (n + 0.5) * kPi;
  // Divided by cosh so that the higher roots do not overflow.
  for (int i = 0; i < 20; ++i) {
    const double f = std::cos(z) - 1 / std::cosh(z);
    z -= f / (-std::sin(z) + std::tanh(z) / std::cosh(z));
  }
  return z;
}

}  // namespace

// Where the tip's centre is from the centre of mass, and how the contact point moves with each
// coordinate: v_normal = sum normal[i] rate[i], and the like for the tangent.
struct Dynamics::Tip {
  double cosine, sine;
  double rx, ry;              // centre of mass -> centre of the tip
  double axial_m, bending_m;  // deflection along and across the rod
  double axial_rate, bending_rate, slope_rate;
};

Dynamics::Dynamics(const RodJob& job)
    : job_(job),
      law_(job.surface, job.loading, job.residual),
      modes_(static_cast<std::size_t>(job.axial_modes + job.bending_modes)),
      coordinates_(3 + modes_) {
  const RodBody& body = job_.body;
  const double area = kPi * body.radius_m * body.radius_m;
  const double density = body.mass_kg / (area * body.length_m);
  const double wave_speed = std::sqrt(body.young_pa / density);
  const double tip_scale = 1 / std::sqrt(body.mass_kg);
  for (int n = 1; n <= job_.axial_modes; ++n) {
    frequency_.push_back(n * kPi * wave_speed / body.length_m);
    axial_.push_back(std::sqrt(2.0) * tip_scale);
    bending_.push_back(0);
    slope_.push_back(0);
  }
  for (int n = 1; n <= job_.bending_modes; ++n) {
    const double z = free_free_root(n);
    const double wave_number = z / body.length_m;
    const double sigma = (std::cosh(z) - std::cos(z)) / (std::sinh(z) - std::sin(z));
    frequency_.push_back(wave_number * wave_number * body.radius_m / 2 * wave_speed);
    axial_.push_back(0);
    bending_.push_back(2 * tip_scale);
    slope_.push_back(-2 * sigma * wave_number * tip_scale);
  }
}

State Dynamics::start() const {
  State state(size(), 0.0);
  state[1] = job_.body.radius_m + job_.body.length_m / 2 * std::sin(job_.angle_rad);
  state[2] = job_.angle_rad;
  state[rate(0)] = job_.vt_m_s;
  state[rate(1)] = job_.vn_m_s;
  state[rate(2)] = job_.omega_rad_s;
  return state;
}

Dynamics::Tip Dynamics::tip(const State& state) const {
  Tip tip{std::cos(state[2]), std::sin(state[2]), 0, 0, 0, 0, 0, 0, 0};
  for (std::size_t i = 0; i < modes_; ++i) {
    const double q = state[3 + i], q_rate = state[rate(3 + i)];
    tip.axial_m += axial_[i] * q;
    tip.bending_m += bending_[i] * q;
    tip.axial_rate += axial_[i] * q_rate;
    tip.bending_rate += bending_[i] * q_rate;
    tip.slope_rate += slope_[i] * q_rate;
  }
  const double along = tip.axial_m - job_.body.length_m / 2;
  tip.rx = along * tip.cosine - tip.bending_m * tip.sine;
  tip.ry = along * tip.sine + tip.bending_m * tip.cosine;
  return tip;
}

double Dynamics::compression_m(const State& state) const {
  return job_.body.radius_m - (state[1] + tip(state).ry);
}

double Dynamics::rigid_compression_m(const State& state) const {
  return job_.body.radius_m - (state[1] - job_.body.length_m / 2 * std::sin(state[2]));
}

double Dynamics::tip_vn_m_s(const State& state) const {
  const Tip t = tip(state);
  return state[rate(1)] + state[rate(2)] * t.rx + t.axial_rate * t.sine + t.bending_rate * t.cosine;
}

double Dynamics::tip_vt_m_s(const State& state) const {
  const Tip t = tip(state);
  const double omega = state[rate(2)];
  return state[rate(0)] - omega * t.ry + t.axial_rate * t.cosine - t.bending_rate * t.sine +
         job_.body.radius_m * (omega + t.slope_rate);
}

double Dynamics::rigid_tip_vn_m_s(const State& state) const {
  return state[rate(1)] - state[rate(2)] * job_.body.length_m / 2 * std::cos(state[2]);
}

double Dynamics::rigid_tip_vt_m_s(const State& state) const {
  return state[rate(0)] +
         state[rate(2)] * (job_.body.length_m / 2 * std::sin(state[2]) + job_.body.radius_m);
}

double Dynamics::kinetic_j(const State& state) const {
  const double vx = state[rate(0)], vy = state[rate(1)], omega = state[rate(2)];
  return (job_.body.mass_kg * (vx * vx + vy * vy) + job_.body.inertia_kg_m2() * omega * omega) / 2;
}

double Dynamics::vibration_j(const State& state) const {
  double sum = 0;
  for (std::size_t i = 0; i < modes_; ++i) {
    const double q = frequency_[i] * state[3 + i], q_rate = state[rate(3 + i)];
    sum += (q * q + q_rate * q_rate) / 2;
  }
  return sum;
}

double Dynamics::vibration_reach_m(const State& state) const {
  double sum = 0;
  for (std::size_t i = 0; i < modes_; ++i) {
    const double amplitude = std::hypot(state[3 + i], state[rate(3 + i)] / frequency_[i]);
    sum += amplitude * (axial_[i] + bending_[i]);
  }
  return sum;
}

double Dynamics::shortest_period_s() const {
  if (frequency_.empty()) return 0;
  return 2 * kPi / *std::max_element(frequency_.begin(), frequency_.end());
}

// Accelerations into the second half of `rates`: virtual work of the contact force on the tip.
void Dynamics::acceleration(const State& state, const Tip& t, double normal_n, double tangential_n,
                            State& rates) const {
  const double radius = job_.body.radius_m;
  rates[rate(0)] = tangential_n / job_.body.mass_kg;
  rates[rate(1)] = normal_n / job_.body.mass_kg - job_.gravity_m_s2;
  rates[rate(2)] = (t.rx * normal_n + (radius - t.ry) * tangential_n) / job_.body.inertia_kg_m2();
  const double along = normal_n * t.sine + tangential_n * t.cosine;
  const double across = normal_n * t.cosine - tangential_n * t.sine;
  for (std::size_t i = 0; i < modes_; ++i) {
    const double q = state[3 + i], q_rate = state[rate(3 + i)], frequency = frequency_[i];
    rates[rate(3 + i)] = axial_[i] * along + bending_[i] * across +
                         slope_[i] * radius * tangential_n - frequency * frequency * q -
                         2 * job_.modal_damping * frequency * q_rate;
  }
}

double Dynamics::tangential_gain(const Tip& t, std::size_t mode) const {
  return axial_[mode] * t.cosine - bending_[mode] * t.sine + slope_[mode] * job_.body.radius_m;
}

double Dynamics::mobility(const Tip& t) const {
  const double arm = job_.body.radius_m - t.ry;
  double sum = 1 / job_.body.mass_kg + arm * arm / job_.body.inertia_kg_m2();
  for (std::size_t i = 0; i < modes_; ++i) sum += std::pow(tangential_gain(t, i), 2);
  return sum;
}

Forces Dynamics::forces(const State& state, const Memory& memory) const {
  Forces forces;
  if (memory.contact == Contact::kFree) return forces;
  const double w = compression_m(state);
  forces.normal_n = memory.contact == Contact::kLoading
                        ? law_.loading_force_n(w)
                        : law_.unloading_force_n(w, memory.largest_m, memory.residual_m);
  // The tip's tangential acceleration is affine in the tangential force.
  const Tip t = tip(state);
  const double radius = job_.body.radius_m;
  const double omega = state[rate(2)];
  const double centripetal =
      -omega * omega * t.rx - 2 * omega * (t.axial_rate * t.sine + t.bending_rate * t.cosine);
  State rates(size());
  acceleration(state, t, forces.normal_n, 0, rates);
  const auto tangential = [&](const State& a) {
    double sum = a[rate(0)] + a[rate(2)] * (radius - t.ry);
    for (std::size_t i = 0; i < modes_; ++i) {
      sum += a[rate(3 + i)] * tangential_gain(t, i);
    }
    return sum;
  };
  forces.holding_n = -(tangential(rates) + centripetal) / mobility(t);
  const double limit = job_.friction_kinetic * forces.normal_n;
  if (memory.friction == Friction::kStick) {
    forces.tangential_n = std::clamp(forces.holding_n, -limit, limit);
  } else {
    forces.tangential_n = memory.friction == Friction::kSlipForward ? -limit : limit;
  }
  return forces;
}

double Dynamics::tendency(const State& state) const {
  // A unit normal force alone: does its tangential effect exceed what friction can hold?
  const Tip t = tip(state);
  const double radius = job_.body.radius_m;
  double coupling = t.rx * (radius - t.ry) / job_.body.inertia_kg_m2();
  for (std::size_t i = 0; i < modes_; ++i) {
    coupling += tangential_gain(t, i) * (axial_[i] * t.sine + bending_[i] * t.cosine);
  }
  if (std::abs(coupling) <= job_.friction_kinetic * mobility(t)) return 0;
  return coupling > 0 ? 1 : -1;
}

void Dynamics::rates(const State& state, State& rates, const Memory& memory) const {
  const Forces f = forces(state, memory);
  rates.resize(size());
  std::copy_n(state.begin() + static_cast<std::ptrdiff_t>(coordinates_), coordinates_,
              rates.begin());
  acceleration(state, tip(state), f.normal_n, f.tangential_n, rates);
  double damping = 0;
  for (std::size_t i = 0; i < modes_; ++i) {
    const double q_rate = state[rate(3 + i)];
    damping += 2 * job_.modal_damping * frequency_[i] * q_rate * q_rate;
  }
  double* sum = rates.data() + sums();
  sum[0] = f.normal_n * tip_vn_m_s(state);
  sum[1] = f.tangential_n * tip_vt_m_s(state);
  sum[2] = -damping;
  sum[3] = -job_.body.mass_kg * job_.gravity_m_s2 * state[rate(1)];
  sum[4] = f.normal_n;
  sum[5] = f.tangential_n;
}

}  // namespace impactdic::sim::rod
