// What one contact leaves behind: its phases, its extremes, what the surface keeps.
#pragma once

#include <algorithm>

#include "sim/contact/contact_integration.h"

namespace impactdic::sim::contact {

template <typename Real>
struct ContactInstant {
  Real time_s{};
  const ImpactStateOf<Real>* x = nullptr;
};

template <typename Real>
class ContactRecord {
 public:
  using ContactInstant = contact::ContactInstant<Real>;
  using ContactPoint = ContactPointOf<Real>;
  using ContactOutcome = ContactOutcomeOf<Real>;

  // `touch_force_n`: of the damper, at the touch.
  ContactRecord(const Real& start_s, const Real& touch_force_n) : start_s_(start_s) {
    outcome_.peak_force_n = touch_force_n;
  }

  // Each of the two sequences of phases has one open at a time; the same name goes on with it.
  void enter(ContactPhaseKind kind, const char* name, const ContactInstant& now);
  // An accepted step that ends with this force. The largest force is an event, hence a step's end.
  void step(const Real& force_n);
  // The deflection turns from growing to falling.
  void turn(const Real& time_s, const ContactPoint& at, const Real& force_n);

  // A shell has flattened so far, and turns back.
  void flatten(const Real& flattening_m) {
    outcome_.max_flattening_m = std::max(outcome_.max_flattening_m, flattening_m);
  }

  ContactOutcome finish(bool separated, const ContactInstant& now, const ContactPoint& at,
                        const ContactDynamicsOf<Real>& dynamics, const NormalLawOf<Real>& normal,
                        const FrictionLawOf<Real>& friction);

 private:
  void close(int open, const ContactInstant& now);

  Real start_s_;
  int open_normal_ = -1, open_tangential_ = -1;
  ContactOutcome outcome_;
};

// A blow of a shell goes on after it had left the surface for a moment: `next` is added to it.
template <typename Real>
void continue_blow(ContactOutcomeOf<Real>& blow, const ContactOutcomeOf<Real>& next);

}  // namespace impactdic::sim::contact
