// What one contact leaves behind: its phases, its extremes, what the surface keeps.
#pragma once

#include <functional>

#include "sim/contact/contact_integration.h"

namespace impactdic::sim::contact {

struct ContactInstant {
  double time_s = 0;
  const ImpactState* x = nullptr;
};

class ContactRecord {
 public:
  // `touch_force_n`: of the damper, at the touch.
  ContactRecord(double start_s, double touch_force_n)
      : start_s_(start_s), last_force_n_(touch_force_n) {
    outcome_.peak_force_n = touch_force_n;
  }

  // Each of the two sequences of phases has one open at a time; the same name goes on with it.
  void enter(ContactPhaseKind kind, const char* name, const ContactInstant& now);
  // An accepted step in compression that ends with this force. `force_within(s)` is the force s
  // after the step before it began, which lasted `stretch_s` up to here.
  void step(double force_n, double stretch_s, const std::function<double(double)>& force_within);
  // The deflection turns from growing to falling.
  void turn(double time_s, const ContactPoint& at, double force_n);
  void count_step() { ++outcome_.steps; }

  ContactOutcome finish(bool separated, const ContactInstant& now, const ContactPoint& at,
                        const ContactDynamics& dynamics, const NormalLaw& normal,
                        const FrictionLaw& friction);

 private:
  void close(int open, const ContactInstant& now);

  double start_s_;
  double last_force_n_;
  bool force_rises_ = false;
  int open_normal_ = -1, open_tangential_ = -1;
  ContactOutcome outcome_;
};

}  // namespace impactdic::sim::contact
