#include "sim/contact/derivatives/sensitive_run.h"

#include <cmath>
#include <limits>
#include <utility>

#include "sim/contact/contact_record.h"
#include "sim/contact/never.h"

namespace impactdic::sim::contact {

SensitiveRun::SensitiveRun(const ImpactJob& job, const JobNumbers<Sensitive>& numbers,
                           std::span<const double> times_s)
    : job_(job),
      numbers_(numbers),
      times_s_(times_s),
      flight_(numbers),
      normal_(make_normal_law(job, numbers)) {}

void SensitiveRun::run() {
  const MotionNumbers<Sensitive>& m = numbers_.initial;
  now_[kVt] = m.vt_m_s, now_[kVn] = m.vn_m_s, now_[kVb] = m.vb_m_s;
  now_[kOmega] = m.omega_rad_s, now_[kOmegaT] = m.omega_t_rad_s;
  now_[kOmegaN] = m.omega_n_rad_s;
  now_[kQn] = m.gap_m;
  for (int contact = 0; contact < job_.solver.contacts; ++contact) {
    if (!reach_surface(contact)) break;
    follow_contact(contact == 0);
    while (separated_ && flight_.touches_again(now_) && reach_surface(contact + 1)) {
      follow_contact(contact == 0);
    }
    if (!first_.separated || !separated_) break;
  }
  if (separated_) record_flight(std::numeric_limits<double>::max());
}

double SensitiveRun::next_s() const {
  return path_.size() < times_s_.size() ? times_s_[path_.size()] : kNever;
}

// The instants of a contact move with the inputs: the body has not yet come, or has gone on, by
// what it moves meanwhile.
void SensitiveRun::take(const Sensitive& time_s, const State& x) {
  State rate = x, fixed = x;
  (*dynamics_)(x, rate, 0);
  for (std::size_t i = 0; i < fixed.size(); ++i) fixed[i].v -= rate[i].a * time_s.v;
  path_.push_back(fixed);
}

void SensitiveRun::record_flight(double until_s) {
  for (double t = next_s(); t <= until_s; t = next_s()) {
    path_.push_back(flight_.after(now_, Sensitive(t) - time_s_).state);
  }
}

// Flies to the next touch and says whether there is one. A gap of zero that is to change moves the
// touch, too.
bool SensitiveRun::reach_surface(int contact) {
  Sensitive flight(0);
  if (contact > 0 || now_[kQn] > 0) {
    flight = flight_.time_to_touch(now_);
    if (!std::isfinite(flight.a)) return false;
  } else {
    flight.v = -now_[kQn].v / now_[kVn].a;
  }
  // What is wanted of the instant of touch itself is in contact.
  record_flight(std::nextafter(time_s_.a + flight.a, -kNever));
  now_ = flight_.after(now_, flight).state;
  flight_.put_down(now_);
  time_s_ += flight;
  return true;
}

// `told`: of the first blow.
void SensitiveRun::follow_contact(bool told) {
  now_[kTip] = now_[kSprings] = Sensitive(0);
  friction_ = make_friction_law(job_, numbers_, now_[kVt], now_[kVn]);
  dynamics_.emplace(numbers_, *normal_, *friction_);
  dynamics_->aim(now_, remembers_slip(job_.friction));
  const State before = now_;
  const Sensitive touch_s = time_s_, rate = dynamics_->contact_point(now_).rate_m_s;
  ContactOutcomeOf<Sensitive> outcome =
      integrate_contact<Sensitive>(job_, *normal_, *friction_, *dynamics_, time_s_, now_, *this);
  time_s_ = outcome.end_s;
  now_ = outcome.end;
  separated_ = outcome.separated;
  if (!told) return;
  tips_.t_end = dynamics_->tip_t(now_), tips_.b_end = dynamics_->tip_b(now_);
  if (first_.steps > 0) return continue_blow(first_, outcome);
  touch_ = before, touch_s_ = touch_s, touch_rate_ = rate;
  tips_.t_start = dynamics_->tip_t(before), tips_.b_start = dynamics_->tip_b(before);
  first_ = std::move(outcome);
}

}  // namespace impactdic::sim::contact
