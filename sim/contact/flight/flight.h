// Free flight of a body between its contacts.
#pragma once

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// Gravity in closed form; with forces of the air a Runge-Kutta method of fourth order whose steps
// are short enough that its error is rounding.
template <typename Real>
class Flight {
 public:
  using State = ImpactStateOf<Real>;

  explicit Flight(const JobNumbers<Real>& numbers);

  struct Flown {
    State state;
    Real air_j{};  // that the air took meanwhile
  };
  // The motion `elapsed` after a state, or before it.
  Flown after(const State& from, const Real& elapsed) const;
  // Until qn = 0 is reached from above; infinite if it never is.
  Real time_to_touch(const State& from) const;

  Real gravity_t() const { return gravity_t_; }
  Real gravity_n() const { return gravity_n_; }

 private:
  Flown step(const Flown& from, const Real& h) const;
  int steps(const State& from, double elapsed) const;

  Real gravity_t_, gravity_n_;
  Real mass_kg_;
  Real drag_per_m_{}, lift_{};  // a = -drag |v| v + lift omega x v
};

}  // namespace impactdic::sim::contact
