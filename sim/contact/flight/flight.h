// Free flight of a body between its contacts.
#pragma once

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// Gravity in closed form; with forces of the air a Runge-Kutta method of fourth order whose steps
// are short enough that its error is rounding.
class Flight {
 public:
  explicit Flight(const ImpactJob& job);

  struct Flown {
    ImpactState state;
    double air_j = 0;  // that the air took meanwhile
  };
  // The motion `elapsed` after a state, or before it.
  Flown after(const ImpactState& from, double elapsed) const;
  // Until qn = 0 is reached from above; infinite if it never is.
  double time_to_touch(const ImpactState& from) const;

  double gravity_t() const { return gravity_t_; }
  double gravity_n() const { return gravity_n_; }

 private:
  Flown step(const Flown& from, double h) const;
  int steps(const ImpactState& from, double elapsed) const;

  double gravity_t_, gravity_n_;
  double mass_kg_;
  double drag_per_m_ = 0, lift_ = 0;  // a = -drag |v| v + lift omega x v
};

}  // namespace impactdic::sim::contact
