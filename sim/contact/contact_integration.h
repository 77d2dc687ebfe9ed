// One contact of a body with the surface, from touch to separation.
#pragma once

#include <vector>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// What is known when the body has left the surface.
struct ContactOutcome {
  bool separated = false;
  double end_s = 0;
  ImpactState end{};
  ContactPoint end_point;
  double t_max_compression_s = 0;  // from the touch; the first maximum
  double max_deflection_m = 0, max_force_n = 0, peak_force_n = 0, separation_force_n = 0;
  double plastic_j = 0;  // kept by the surface
  // Stored when the body left, dissipated by the surface on its own.
  double released_tangential_j = 0;
  double released_j = 0;
  long steps = 0;
  std::vector<ContactPhase> phases;
};

// The points of the trajectory that the caller wants, ascending.
class TrajectoryRequest {
 public:
  virtual ~TrajectoryRequest() = default;
  // The next time wanted; infinite when there is none.
  virtual double next_s() const = 0;
  virtual void take(double time_s, const ImpactState& x) = 0;
  // An accepted step, or a part of one, has come here.
  virtual void reach(double time_s, const ImpactState& x) = 0;
};

// Integrates one contact that begins at `start_s` in state `start` (event_integrator.h).
ContactOutcome integrate_contact(const ImpactJob& job, const NormalLaw& normal,
                                 FrictionLaw& friction, ContactDynamics& dynamics, double start_s,
                                 const ImpactState& start, TrajectoryRequest& request);

}  // namespace impactdic::sim::contact
