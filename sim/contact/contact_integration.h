// One contact of a body with the surface, from touch to separation.
#pragma once

#include <vector>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// What is known when the body has left the surface.
template <typename Real>
struct ContactOutcomeOf {
  bool separated = false;
  Real end_s{};
  ImpactStateOf<Real> end{};
  ContactPointOf<Real> end_point;
  Real t_max_compression_s{};  // from the touch; the first maximum
  Real max_deflection_m{}, max_force_n{}, peak_force_n{}, separation_force_n{};
  Real max_flattening_m{};  // of a shell
  // Of energies no derivatives are followed.
  double plastic_j = 0;  // kept by the surface
  // Stored when the body left, dissipated by the surface on its own.
  double released_tangential_j = 0;
  double released_j = 0;
  long steps = 0;
  std::vector<ContactPhase> phases;
};
using ContactOutcome = ContactOutcomeOf<double>;

// The points of the trajectory that the caller wants, ascending.
template <typename Real>
class TrajectoryRequest {
 public:
  virtual ~TrajectoryRequest() = default;
  // The next time wanted; infinite when there is none.
  virtual double next_s() const = 0;
  virtual void take(const Real& time_s, const ImpactStateOf<Real>& x) = 0;
  // An accepted step, or a part of one, has come here.
  virtual void reach(const Real& time_s, const ImpactStateOf<Real>& x) = 0;
};

// Integrates one contact that begins at `start_s` in state `start` (event_integrator.h).
template <typename Real>
ContactOutcomeOf<Real> integrate_contact(const ImpactJob& job, const NormalLawOf<Real>& normal,
                                         FrictionLawOf<Real>& friction,
                                         ContactDynamicsOf<Real>& dynamics, const Real& start_s,
                                         const ImpactStateOf<Real>& start,
                                         TrajectoryRequest<Real>& request);

}  // namespace impactdic::sim::contact
