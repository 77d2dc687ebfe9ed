// What an impact simulation is asked to do: laws, body, contact, motion at the start.
//
// Axes are local: t along the surface, n out of it, metres; omega and angles are positive
// counter-clockwise. The surface is inclined by angle_deg, counter-clockwise from the horizontal,
// so that gravity is (-g sin(angle), -g cos(angle)).
#pragma once

#include <string>
#include <string_view>

#include "sim/contact/body.h"

namespace impactdic::sim::contact {

enum class NormalModel {
  kLinearSpringDamper,
  kHertzDamper,
  kJacksonGreen,
  kKogutEtsion,
  kThornton
};
enum class FrictionModel { kNone, kCoulomb, kThreePhase, kFullSliding, kBrody, kMawBarberFawcett };
// kPublished: the source's own rule, so that its figures can be remade. kSound: no rule that breaks
// a law of physics.
enum class Preset { kPublished, kSound };
// What the damper does after the maximum compression: nothing; act until the force is zero; act
// until the deflection is zero (the force is then negative at the end: the surface pulls).
enum class RestitutionDamping { kNone, kToZeroForce, kToZeroDeflection };
// How much deflection an elastic-plastic contact keeps (Jackson et al. 2010; Etsion et al. 2005).
enum class ResidualLaw { kJackson, kKogutEtsion };

// The names that stand in job files, e.g. "hertz_damper". The parsers throw InvalidArgument.
std::string_view name_of(NormalModel model);
std::string_view name_of(FrictionModel model);
std::string_view name_of(Preset preset);
std::string_view name_of(RestitutionDamping damping);
std::string_view name_of(ResidualLaw law);
std::string_view name_of(Shape shape);
NormalModel parse_normal_model(std::string_view name);
FrictionModel parse_friction_model(std::string_view name);
Preset parse_preset(std::string_view name);
RestitutionDamping parse_restitution_damping(std::string_view name);
ResidualLaw parse_residual_law(std::string_view name);
Shape parse_shape(std::string_view name);

// The parameters of the contact; each law uses its own and the others stay zero.
struct Contact {
  // linear_spring_damper: N/m; hertz_damper: N/m^1.5.
  double stiffness = 0;
  double damping_n_s_per_m = 0;
  RestitutionDamping restitution_damping = RestitutionDamping::kNone;
  double friction_kinetic = 0;
  double friction_static = 0;  // three_phase only; at least friction_kinetic
  double poisson = 0;          // maw_barber_fawcett, jackson_green: of the (softer) body
  // The elastic-plastic laws: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; yield of the weaker body.
  double reduced_modulus_pa = 0;
  double yield_strength_pa = 0;
  ResidualLaw residual = ResidualLaw::kJackson;
};

// The motion of the mass centre at t = 0.
struct InitialMotion {
  double vt_m_s = 0;
  double vn_m_s = 0;  // negative: towards the surface
  double omega_rad_s = 0;
  double gap_m = 0;      // distance left to the surface; 0: contact begins at t = 0
  double angle_deg = 0;  // rods: the angle of the axis from the surface, of the centre seen from
                         // the striking end: 90 is upright
};

struct SolverOptions {
  double relative_tolerance = 1e-10;  // of each state's own scale, per step
  int contacts = 1;                   // how many contacts to follow (separation, then re-contact)
};

struct ImpactJob {
  NormalModel normal = NormalModel::kLinearSpringDamper;
  FrictionModel friction = FrictionModel::kCoulomb;
  Preset preset = Preset::kSound;
  Body body;
  Contact contact;
  double surface_angle_deg = 0;
  InitialMotion initial;
  double gravity_m_s2 = 9.81;
  SolverOptions solver;

  // Throws InvalidArgument naming the key, as it stands in a job file, and why.
  void validate() const;
};

}  // namespace impactdic::sim::contact
