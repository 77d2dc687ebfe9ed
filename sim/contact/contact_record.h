// What one contact leaves behind: its phases, its extremes, what the surface keeps.
#pragma once

#include "sim/contact/contact_integration.h"

namespace impactdic::sim::contact {

struct ContactInstant {
  double time_s = 0;
  const ImpactState* x = nullptr;
};

class ContactRecord {
 public:
  // `touch_force_n`: of the damper, at the touch.
  ContactRecord(double start_s, double touch_force_n) : start_s_(start_s) {
    outcome_.peak_force_n = touch_force_n;
  }

  // Each of the two sequences of phases has one open at a time; the same name goes on with it.
  void enter(ContactPhaseKind kind, const char* name, const ContactInstant& now);
  // An accepted step that ends with this force. The largest force is an event, hence a step's end.
  void step(double force_n);
  // The deflection turns from growing to falling.
  void turn(double time_s, const ContactPoint& at, double force_n);

  ContactOutcome finish(bool separated, const ContactInstant& now, const ContactPoint& at,
                        const ContactDynamics& dynamics, const NormalLaw& normal,
                        const FrictionLaw& friction);

 private:
  void close(int open, const ContactInstant& now);

  double start_s_;
  int open_normal_ = -1, open_tangential_ = -1;
  ContactOutcome outcome_;
};

}  // namespace impactdic::sim::contact
