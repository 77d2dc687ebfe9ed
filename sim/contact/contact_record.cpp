#include "sim/contact/contact_record.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace impactdic::sim::contact {

template <typename Real>
void ContactRecord<Real>::enter(ContactPhaseKind kind, const char* name,
                                const ContactInstant& now) {
  int& open = kind == ContactPhaseKind::kNormal ? open_normal_ : open_tangential_;
  if (open >= 0) {
    if (std::string_view(outcome_.phases[open].name) == name) return;
    close(open, now);
  }
  open = static_cast<int>(outcome_.phases.size());
  const double time_s = value_of(now.time_s);
  outcome_.phases.push_back({kind, name, time_s, time_s, value_of((*now.x)[kSlip])});
}

template <typename Real>
void ContactRecord<Real>::close(int open, const ContactInstant& now) {
  ContactPhase& phase = outcome_.phases[open];
  phase.end_s = value_of(now.time_s);
  const bool slips = phase.kind == ContactPhaseKind::kTangential;
  phase.slip_j = slips ? value_of((*now.x)[kSlip]) - phase.slip_j : 0;
}

template <typename Real>
void ContactRecord<Real>::step(const Real& force_n) {
  ++outcome_.steps;
  outcome_.peak_force_n = std::max(outcome_.peak_force_n, force_n);
}

template <typename Real>
void ContactRecord<Real>::turn(const Real& time_s, const ContactPoint& at, const Real& force_n) {
  if (outcome_.t_max_compression_s == 0) outcome_.t_max_compression_s = time_s - start_s_;
  if (at.deflection_m > outcome_.max_deflection_m) {
    outcome_.max_deflection_m = at.deflection_m;
    outcome_.max_force_n = force_n;
  }
  outcome_.peak_force_n = std::max(outcome_.peak_force_n, force_n);
}

template <typename Real>
auto ContactRecord<Real>::finish(bool separated, const ContactInstant& now, const ContactPoint& at,
                                 [[maybe_unused]] const ContactDynamicsOf<Real>& dynamics,
                                 [[maybe_unused]] const NormalLawOf<Real>& normal,
                                 [[maybe_unused]] const FrictionLawOf<Real>& friction)
    -> ContactOutcome {
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
  outcome_.separation_force_n = separated ? at.law_n : Real(0);
  if constexpr (!kHasDerivatives<Real>) {
    const double stored = normal.stored_j(at.deflection_m, dynamics.memory);
    outcome_.plastic_j = normal.work_j(at.deflection_m, dynamics.memory) - stored;
    outcome_.released_j = separated ? stored : 0;
    outcome_.released_tangential_j = separated ? friction.stored_j(at, now.time_s) : 0;
  }
  return std::move(outcome_);
}

template <typename Real>
void continue_blow(ContactOutcomeOf<Real>& blow, const ContactOutcomeOf<Real>& next) {
  if (next.max_deflection_m > blow.max_deflection_m) {
    blow.max_deflection_m = next.max_deflection_m;
    blow.max_force_n = next.max_force_n;
  }
  blow.peak_force_n = std::max(blow.peak_force_n, next.peak_force_n);
  blow.max_flattening_m = std::max(blow.max_flattening_m, next.max_flattening_m);
  blow.separation_force_n = next.separation_force_n;
  blow.separated = next.separated;
  blow.end_s = next.end_s;
  blow.end = next.end;
  blow.end_point = next.end_point;
}

template void continue_blow(ContactOutcomeOf<double>&, const ContactOutcomeOf<double>&);
template void continue_blow(ContactOutcomeOf<Sensitive>&, const ContactOutcomeOf<Sensitive>&);
template class ContactRecord<double>;
template class ContactRecord<Sensitive>;

}  // namespace impactdic::sim::contact
