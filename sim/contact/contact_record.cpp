#include "sim/contact/contact_record.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace impactdic::sim::contact {

void ContactRecord::enter(ContactPhaseKind kind, const char* name, const ContactInstant& now) {
  int& open = kind == ContactPhaseKind::kNormal ? open_normal_ : open_tangential_;
  if (open >= 0) {
    if (std::string_view(outcome_.phases[open].name) == name) return;
    close(open, now);
  }
  open = static_cast<int>(outcome_.phases.size());
  outcome_.phases.push_back({kind, name, now.time_s, now.time_s, (*now.x)[kSlip]});
}

void ContactRecord::close(int open, const ContactInstant& now) {
  ContactPhase& phase = outcome_.phases[open];
  phase.end_s = now.time_s;
  phase.slip_j = phase.kind == ContactPhaseKind::kTangential ? (*now.x)[kSlip] - phase.slip_j : 0;
}

void ContactRecord::step(double force_n) {
  ++outcome_.steps;
  outcome_.peak_force_n = std::max(outcome_.peak_force_n, force_n);
}

void ContactRecord::turn(double time_s, const ContactPoint& at, double force_n) {
  if (outcome_.t_max_compression_s == 0) outcome_.t_max_compression_s = time_s - start_s_;
  if (at.deflection_m > outcome_.max_deflection_m) {
    outcome_.max_deflection_m = at.deflection_m;
    outcome_.max_force_n = force_n;
  }
  outcome_.peak_force_n = std::max(outcome_.peak_force_n, force_n);
}

ContactOutcome ContactRecord::finish(bool separated, const ContactInstant& now,
                                     const ContactPoint& at, const ContactDynamics& dynamics,
                                     const NormalLaw& normal, const FrictionLaw& friction) {
  close(open_normal_, now);
  close(open_tangential_, now);
  // A ball that sinks in without turning is deepest at the end.
  if (!separated && at.deflection_m > outcome_.max_deflection_m) {
    outcome_.max_deflection_m = at.deflection_m;
    outcome_.max_force_n = at.law_n;
  }
  outcome_.separated = separated;
  outcome_.end_s = now.time_s;
  outcome_.end = *now.x;
  outcome_.end_point = at;
  outcome_.separation_force_n = separated ? at.law_n : 0;
  const double stored = normal.stored_j(at.deflection_m, dynamics.memory);
  outcome_.plastic_j = normal.work_j(at.deflection_m, dynamics.memory) - stored;
  outcome_.released_j = separated ? stored : 0;
  outcome_.released_tangential_j = separated ? friction.stored_j(at, now.time_s) : 0;
  return std::move(outcome_);
}

}  // namespace impactdic::sim::contact
