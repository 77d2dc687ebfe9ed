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
  // Until qn = 0, of a shell its part in contact, is reached from above; infinite if it never is.
  Real time_to_touch(const State& from) const;

  // Sets a body that has come to the surface on it.
  void put_down(State& x) const { x[kQn] = shell_.given() ? -shell_.reach(x[kFlat]) : Real(0); }
  // See Shell.
  Real flattest(const State& from, const Real& flight_s) const {
    return swings(from) ? shell_.flattest_in_flight(from, flight_s) : Real(0);
  }
  // Whether a shell that has just left touches once more as it swings, in the same blow.
  bool touches_again(const State& from) const {
    return swings(from) && shell_.next_touch(from, gravity_n_).same_blow;
  }

  Real gravity_t() const { return gravity_t_; }
  Real gravity_n() const { return gravity_n_; }

 private:
  // Out of contact a shell that swings has energy.
  bool swings(const State& x) const { return shell_.given() && shell_.energy_j(x) > 0; }
  // When a step of h, from one state to the other, touches the surface; infinite if it does not.
  double touch_within(const Flown& from, const Flown& to, double h) const;
  Flown step(const Flown& from, const Real& h) const;
  int steps(const State& from, double elapsed) const;

  Shell<Real> shell_;
  Real gravity_t_, gravity_n_;
  Real mass_kg_;
  Real drag_per_m_{}, lift_{};  // a = -drag |v| v + lift omega x v
};

}  // namespace impactdic::sim::contact
