// The rod's equations of motion between two events. Internal to sim/rod.
//
// State: x, y, angle, axial and bending modal coordinates (mass-normalised, m sqrt(kg)), then their
// rates in the same order, then six running sums: normal work, friction work, damping work, gravity
// work (J), normal and tangential impulse (N s).
#pragma once

#include <cstddef>
#include <vector>

#include "sim/contact/law/normal_elastoplastic.h"
#include "sim/rod/rod_impact.h"

namespace impactdic::sim::rod {

using State = std::vector<double>;

enum class Contact { kFree, kLoading, kUnloading };
enum class Friction { kSlipForward, kSlipBackward, kStick };

// What of the past the forces need.
struct Memory {
  Contact contact = Contact::kFree;
  Friction friction = Friction::kStick;
  double largest_m = 0;   // largest compression so far
  double residual_m = 0;  // of that
};

struct Forces {
  double normal_n = 0, tangential_n = 0;
  double holding_n = 0;  // the tangential force that would hold the tip where it is
};

class Dynamics {
 public:
  explicit Dynamics(const RodJob& job);

  std::size_t size() const { return 2 * coordinates_ + 6; }
  std::size_t sums() const { return 2 * coordinates_; }
  // At the first touch: the tip meets the flat undeformed.
  State start() const;
  void rates(const State& state, State& rates, const Memory& memory) const;
  Forces forces(const State& state, const Memory& memory) const;

  double compression_m(const State& state) const;
  // The same of the undeformed rod.
  double rigid_compression_m(const State& state) const;
  double tip_vn_m_s(const State& state) const;
  double tip_vt_m_s(const State& state) const;
  double rigid_tip_vn_m_s(const State& state) const;
  double rigid_tip_vt_m_s(const State& state) const;
  double kinetic_j(const State& state) const;
  double vibration_j(const State& state) const;
  // The farthest the vibration can still carry the tip, whatever its phase.
  double vibration_reach_m(const State& state) const;
  double shortest_period_s() const;  // 0 for a rigid rod
  std::size_t rate(std::size_t coordinate) const { return coordinates_ + coordinate; }
  // +1, -1 or 0: which way the tip would slip under a vanishing normal force.
  double tendency(const State& state) const;
  const contact::ElasticPlasticLaw& law() const { return law_; }

 private:
  struct Tip;
  Tip tip(const State& state) const;
  // Tangential velocity of the contact point per unit rate of a mode.
  double tangential_gain(const Tip& tip, std::size_t mode) const;
  // Tangential acceleration of the contact point per unit tangential force, 1/kg.
  double mobility(const Tip& tip) const;
  void acceleration(const State& state, const Tip& tip, double normal_n, double tangential_n,
                    State& rates) const;

  RodJob job_;
  contact::ElasticPlasticLaw law_;
  std::size_t modes_, coordinates_;
  std::vector<double> frequency_;                // of each mode, rad/s
  std::vector<double> axial_, bending_, slope_;  // each mode at the tip; zero where not its kind
};

}  // namespace impactdic::sim::rod
