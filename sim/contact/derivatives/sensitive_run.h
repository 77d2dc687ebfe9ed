// An impact of one body, followed with the derivatives of its motion by the numbers of its job.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/contact/contact_integration.h"
#include "sim/contact/flight/flight.h"

namespace impactdic::sim::contact {

// As ImpactRun, without energies and orientation. Derivatives are those by the inputs that
// `numbers` are seeded with.
class SensitiveRun final : public TrajectoryRequest<Sensitive> {
 public:
  using State = ImpactStateOf<Sensitive>;

  // `job` and `numbers` must outlive the object. `times_s`: where `path` is wanted, ascending; also
  // before the touch and after the last separation.
  SensitiveRun(const ImpactJob& job, const JobNumbers<Sensitive>& numbers,
               std::span<const double> times_s = {});

  // Throws Error where the motion cannot be followed.
  void run();

  bool separated() const { return separated_; }
  const ContactOutcomeOf<Sensitive>& first() const { return first_; }
  const State& touch() const { return touch_; }
  const Sensitive& touch_s() const { return touch_s_; }
  const Sensitive& touch_rate_m_s() const { return touch_rate_; }
  const State& end() const { return now_; }
  const Sensitive& end_s() const { return time_s_; }
  // Velocity of the contact point, along t and b, at the first touch and at its end.
  struct Tips {
    Sensitive t_start, t_end, b_start, b_end;
  };
  const Tips& tips() const { return tips_; }
  // The states at the times asked for, which do not move with the inputs.
  const std::vector<State>& path() const { return path_; }

  double next_s() const override;
  void take(const Sensitive& time_s, const State& x) override;
  void reach(const Sensitive&, const State&) override {}

 private:
  bool reach_surface(int contact);
  void follow_contact(bool told);
  void record_flight(double until_s);

  const ImpactJob& job_;
  const JobNumbers<Sensitive>& numbers_;
  const std::span<const double> times_s_;
  const Flight<Sensitive> flight_;
  NormalLawPtr<Sensitive> normal_;
  FrictionLawPtr<Sensitive> friction_;
  std::optional<ContactDynamicsOf<Sensitive>> dynamics_;
  Tips tips_;
  State now_{}, touch_{};
  Sensitive time_s_{}, touch_s_{}, touch_rate_{};
  bool separated_ = false;
  ContactOutcomeOf<Sensitive> first_;
  std::vector<State> path_;
};

}  // namespace impactdic::sim::contact
