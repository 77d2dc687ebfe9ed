// Models of an impact on a surface: what they are asked, and what they answer.
//
// Axes are local, metres: t along the surface, n out of it, b = t x n. An impact in the plane of t
// and n spins about b alone: omega and angles without another axis are about b, positive
// counter-clockwise where t runs right and n up. The surface is inclined by surface_angle_deg,
// counter-clockwise from the horizontal, so that gravity is (-g sin(angle), -g cos(angle)).
// Sources: docs/sources.md; numbers of equations are those of the dissertation.
#pragma once

#include <impactdic/export.h>
#include <impactdic/models/shell.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// kOther: a ball whose moment of inertia is given.
enum class BodyShape { kHollowSphere, kSolidSphere, kRod, kOther };

// A rigid body. A ball touches the surface below its centre; a rod touches it with
// the end that hangs lower, whose cap has the radius diameter_m / 2.
struct ImpactBody {
  BodyShape shape = BodyShape::kSolidSphere;
  double mass_kg = 0;
  double diameter_m = 0;
  double length_m = 0;       // rods only
  double inertia_kg_m2 = 0;  // about the centre; 0: from the shape

  double radius_m() const { return diameter_m / 2; }
  // I_C: thin shell 2/3 m R^2, solid sphere 2/5 m R^2, slender rod m L^2 / 12, or as given.
  double inertia() const;
  // kappa = I_C / (m R^2).
  double inertia_factor() const { return inertia() / (mass_kg * radius_m() * radius_m()); }
  // Throws InvalidArgument naming the key.
  void validate() const;
};

// Equations, sources and ranges: docs/models.md.
enum class NormalModel {
  kLinearSpringDamper,
  kHertzDamper,
  kJacksonGreen,
  kKogutEtsion,
  kThornton,
  kTsuji,         // Tsuji, Tanaka and Ishida 1992
  kKuwabaraKono,  // Kuwabara and Kono 1987; Brilliantov et al. 1996
  kHuntCrossley,  // Hunt and Crossley 1975
  kWaltonBraun,   // Walton and Braun 1986
  kStronge,       // elastic-plastic, Stronge 2000
  kJkr            // Johnson, Kendall and Roberts 1971
};
enum class FrictionModel {
  kNone,
  kCoulomb,
  kThreePhase,
  kFullSliding,
  kBrody,
  kMawBarberFawcett,
  kMindlin,           // partial slip under other normal laws; Mindlin and Deresiewicz 1953
  kTangentialSpring,  // Stronge 2000: a spring along the surface that slips at Coulomb's limit
  kGripSlip,          // Cross 2002: slides first, then grips
  kSpeedDependent     // Coulomb friction that falls with the speed of slip
};
// kPublished: the author's own rule, so that its figures can be remade. kSound: no rule that breaks
// a law of physics.
enum class ModelPreset { kPublished, kSound };
// What the damper does after the maximum compression: nothing; act until the force is zero; act
// until the deflection is zero (the force is then negative at the end: the surface pulls).
enum class RestitutionDamping { kNone, kToZeroForce, kToZeroDeflection };
// How much deflection an elastic-plastic contact keeps (Jackson et al. 2010; Etsion et al. 2005).
enum class ResidualLaw { kJackson, kKogutEtsion };

// The names that stand in job files, e.g. "hertz_damper". The parsers throw InvalidArgument.
std::string_view name_of(NormalModel model);
std::string_view name_of(FrictionModel model);
std::string_view name_of(ModelPreset preset);
std::string_view name_of(RestitutionDamping damping);
std::string_view name_of(ResidualLaw law);
std::string_view name_of(BodyShape shape);
NormalModel parse_normal_model(std::string_view name);
FrictionModel parse_friction_model(std::string_view name);
ModelPreset parse_preset(std::string_view name);
RestitutionDamping parse_restitution_damping(std::string_view name);
ResidualLaw parse_residual_law(std::string_view name);
BodyShape parse_shape(std::string_view name);

// The parameters of the contact; each law uses its own and the others stay zero.
struct ContactParameters {
  // linear_spring_damper, walton_braun: N/m; hertz_damper, tsuji, kuwabara_kono, hunt_crossley:
  // N/m^1.5.
  double stiffness = 0;
  double damping_n_s_per_m = 0;
  RestitutionDamping restitution_damping = RestitutionDamping::kNone;
  double friction_kinetic = 0;
  // three_phase, grip_slip, speed_dependent; at least friction_kinetic
  double friction_static = 0;
  double poisson = 0;  // maw_barber_fawcett, mindlin, jackson_green: of the (softer) body
  // The elastic-plastic laws: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; yield of the weaker body.
  double reduced_modulus_pa = 0;
  double yield_strength_pa = 0;
  ResidualLaw residual = ResidualLaw::kJackson;
  // tsuji: alpha of P = k d^1.5 + alpha sqrt(m k) d^(1/4) d'.
  double damping_factor = 0;
  // kuwabara_kono: A of P = k (d^1.5 + 3/2 A d^(1/2) d').
  double dissipation_s = 0;
  // hunt_crossley: alpha of P = k d^1.5 (1 + 3/2 alpha d'); e = 1 - alpha v at low speed.
  double damping_s_per_m = 0;
  // walton_braun: the way back has the stiffness k2 = this + hardening x the largest force.
  double unloading_stiffness_n_per_m = 0, unloading_hardening_per_m = 0;
  double adhesion_j_per_m2 = 0;             // jkr: work of adhesion
  double tangential_stiffness_n_per_m = 0;  // tangential_spring, grip_slip
  // speed_dependent: mu = mu_k + (mu_s - mu_k) exp(-slip speed / this).
  double friction_speed_m_s = 0;
  // Of every law, balls only: couples against the spin along the surface, this x R P, and about the
  // normal, 3 pi/16 x this x sqrt(R delta) P.
  double rolling_friction = 0, spinning_friction = 0;

  // The constant of that law's damper; NaN where it has none.
  double damping(NormalModel law) const;
  void set_damping(NormalModel law, double value);
};

// The keys, with their units, of a law's stiffness and of its damper in job files; empty where it
// has none.
std::string_view stiffness_key(NormalModel law);
std::string_view damping_key(NormalModel law);
// Whether P = k delta^1.5 while nothing damps, with k in N/m^1.5.
bool has_hertz_spring(NormalModel law);
// Whether the friction law takes a Poisson's ratio: parts of the contact slip while others stick.
bool slips_partially(FrictionModel law);
// Whether the contact gives way along the surface and remembers how far.
bool remembers_slip(FrictionModel law);

// Of one body, as handbooks state it.
struct ElasticMaterial {
  double young_pa = 0;
  double poisson = 0;

  double shear_pa() const { return young_pa / (2 * (1 + poisson)); }
};

// The materials of a contact, and what it restitutes at one speed.
struct ContactMaterials {
  ElasticMaterial body, surface;     // `surface`: of the surface, or of the other body
  double restitution = 0;            // in normal impact; 0: not given
  double restitution_speed_m_s = 0;  // at which it was measured; a linear spring needs none
};

// E*: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (Hertz 1882). Pa.
double reduced_modulus_pa(const ElasticMaterial& a, const ElasticMaterial& b);
// G*: 1/G* = (2 - nu1)/(4 G1) + (2 - nu2)/(4 G2) (Mindlin 1949). Pa.
double reduced_shear_modulus_pa(const ElasticMaterial& a, const ElasticMaterial& b);
// Poisson's ratio of two equal bodies with the same G*/E* = 2(1 - nu)/(2 - nu).
double equivalent_poisson(const ElasticMaterial& a, const ElasticMaterial& b);
// k = 4/3 E* sqrt(R) of P = k delta^1.5 (Hertz 1882). N/m^1.5.
double hertz_stiffness(double reduced_modulus_pa, double contact_radius_m);

// The motion of the mass centre at t = 0.
struct InitialMotion {
  double vt_m_s = 0;
  double vn_m_s = 0;  // negative: towards the surface
  double omega_rad_s = 0;
  double gap_m = 0;      // distance left to the surface; 0: contact begins at t = 0
  double angle_deg = 0;  // rods: the angle of the axis from the surface, of the centre seen from
                         // the striking end: 90 is upright
  // Out of the plane of t and n, balls only.
  double vb_m_s = 0;
  double omega_t_rad_s = 0, omega_n_rad_s = 0;

  // The motion stays in the plane of t and n.
  bool plane() const { return vb_m_s == 0 && omega_t_rad_s == 0 && omega_n_rad_s == 0; }
};

// A second ball that moves freely, on the other side of the surface: its centre lies below the
// plane of contact, so that the first ball's contact point meets the top of this one.
struct OtherBody {
  ImpactBody body;
  InitialMotion initial;  // without gap and angle
};

// Forces of the air on a ball in free flight: drag against the velocity v, and Magnus' force across
// velocity and spin (Mehta 1985),
//   m a = - C_D rho A/2 |v| v + C_M rho A R/2 omega x v,   A = pi R^2,
// so that the coefficient of lift is C_M R omega / |v|. Out of contact only: in the few ms of a
// contact they are far below its forces.
struct AirForces {
  double density_kg_m3 = 1.2;
  double drag_coefficient = 0;  // C_D; about 0.5 of a smooth ball
  double lift_coefficient = 0;  // C_M; about 1 of a tennis ball

  bool act() const { return drag_coefficient != 0 || lift_coefficient != 0; }
};

struct SolverOptions {
  double relative_tolerance = 1e-10;  // of each state's own scale, per step
  int contacts = 1;                   // how many contacts to follow (separation, then re-contact)
};

// An impact whose path is integrated.
struct ImpactJob {
  NormalModel normal = NormalModel::kLinearSpringDamper;
  FrictionModel friction = FrictionModel::kCoulomb;
  ModelPreset preset = ModelPreset::kSound;
  ImpactBody body;
  ContactParameters contact;
  double surface_angle_deg = 0;
  InitialMotion initial;
  double gravity_m_s2 = 9.81;
  AirForces air;
  SolverOptions solver;
  // Of curvature of the surface where the ball meets it; 0: flat; below zero: hollow.
  double surface_radius_m = 0;
  // What the ball meets instead of a surface that rests.
  std::optional<OtherBody> other;
  // A ball that flattens as a shell, in series with the normal law; else it is rigid.
  std::optional<BallShell> shell;
  // What the contact's stiffness and damping were computed from, for the record only.
  std::optional<ContactMaterials> materials;

  // 1/R = 1/R_ball + 1/R_surface, or of both balls (Hertz 1882).
  double contact_radius_m() const;
  // The mass that the contact moves: the body's, or m1 m2/(m1 + m2).
  double contact_mass_kg() const;
  // Computes from the materials what the laws take: reduced modulus; the stiffness of a Hertz
  // contact; the Poisson's ratio of maw_barber_fawcett and mindlin, that of two equal bodies with
  // the same ratio of tangential to normal stiffness; the damping, or the stiffness of
  // walton_braun's way back, where a restitution is given. Throws InvalidArgument naming the key.
  void take_materials(const ContactMaterials& from);

  // Throws InvalidArgument naming the key, as it stands in a job file, and why.
  void validate() const;
};

// A rotation as a unit quaternion.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

// Motion of the mass centre. q counts from t = 0, but for qn, which counts from the first touch of
// the surface, so that qn = -deflection for a ball in contact (the dissertation's q1, q2, q3, Eqs
// 3.1-3.4). angle_rad is the integral of omega_rad_s; where the body spins about b alone it is the
// angle that the body has turned.
struct BodyState {
  double qt_m = 0, qn_m = 0, angle_rad = 0;
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
  double qb_m = 0, vb_m_s = 0;
  double omega_t_rad_s = 0, omega_n_rad_s = 0;
  // Of a ball since t = 0, its x, y, z along t, n, b; not followed where two balls move.
  Quaternion orientation;
  // Of a shell: its flattening, and how far its outline is nearer to the surface than its mass
  // centre, with their rates.
  double flattening_m = 0, flattening_rate_m_s = 0;
  double outline_lag_m = 0, outline_lag_rate_m_s = 0;
};

// Energy in joules, since the start: kinetic_start_j + gravity_j = the sum of all others.
struct EnergyLedger {
  double kinetic_start_j = 0;
  double gravity_j = 0;  // work done by the weight
  double kinetic_j = 0;
  double normal_elastic_j = 0;      // stored, recoverable
  double damping_j = 0;             // dissipated by the damper
  double tangential_elastic_j = 0;  // stored in the tangential springs
  double slip_j = 0;                // dissipated by friction; negative where a rule feeds energy in
  double plastic_j = 0;             // kept by permanent deformation
  double residual_j = 0;            // what the integration lost
  double air_j = 0;                 // taken by the air in free flight
  double vibration_j = 0;           // of a shell: its spring, and its parts against each other
};

struct TrajectoryPoint {
  double time_s = 0;
  BodyState state;
  double deflection_m = 0;
  double normal_force_n = 0, tangential_force_n = 0;
  double tip_vt_m_s = 0;  // tangential velocity of the contact point
  EnergyLedger energy;
  double tangential_force_b_n = 0, tip_vb_m_s = 0;
  BodyState other;  // of the second ball, where there is one
};

enum class ContactPhaseKind { kFlight, kNormal, kTangential };

struct ContactPhase {
  ContactPhaseKind kind = ContactPhaseKind::kNormal;
  // flight; compression, restitution; sliding, sticking, post_sliding, rolling, reversed_sliding,
  // partial_slip, gross_slip, frictionless.
  const char* name = "";
  double start_s = 0, end_s = 0;
  // Tangential phases: dissipated by friction; negative: the rule feeds energy in.
  double slip_j = 0;
};

// Derivatives of an impact's outcome by the numbers of its job, in SI units and degrees as they
// stand there (sensitivity equations with the jumps of Aizerman and Gantmakher 1958 at each switch
// of a law).
struct ImpactDerivatives {
  std::vector<std::string> inputs;    // as in a job file: "contact.friction_kinetic"
  std::vector<std::string> outcomes;  // as in summary.json: "final.vt_m_s"
  // Of outcome r by input c: values[r * inputs.size() + c]. NaN where there is none: the body does
  // not leave the surface, or the motion forks, as where slip has just ended at the separation.
  std::vector<double> values;
};

// NaN where the body did not leave the surface and a figure therefore does not exist.
struct ImpactResult {
  // The body left the surface; otherwise its weight holds it there, and `final` is the moment when
  // its rebound turned back.
  bool separated = false;
  BodyState start, final;
  double contact_start_s = 0;
  double contact_s = 0;  // duration of the first contact
  double end_s = 0;      // of `final`
  // From the contact's start, as are the phases of a job without gap.
  double t_max_compression_s = 0;
  double max_deflection_m = 0;
  double max_force_n = 0;         // P_m: the normal force at the maximum compression
  double peak_force_n = 0;        // the largest normal force: a damper shifts it before that
  double separation_force_n = 0;  // normal force at that moment; negative: the surface pulls
  double restitution = 0;         // of the contact point's normal velocity (source Eq. 3.11)
  double tip_vt_start_m_s = 0, tip_vt_final_m_s = 0;
  double impulse_t_n_s = 0, impulse_n_n_s = 0;  // of the contact force
  std::vector<ContactPhase> phases;
  EnergyLedger energy;
  std::vector<std::string> warnings;
  std::vector<TrajectoryPoint> trajectory;  // as the request asks
  long evaluations = 0;                     // of the right-hand side
  long steps = 0;                           // accepted, of all contacts
  double tip_vb_start_m_s = 0, tip_vb_final_m_s = 0, impulse_b_n_s = 0;
  double max_flattening_m = 0;                   // of a shell
  BodyState other_start, other_final;            // of the second ball, where there is one
  std::optional<ImpactDerivatives> derivatives;  // where they were asked for
};

// Effective friction of an impact, an impulse ratio, positive where it opposes the slip.
struct EffectiveFriction {
  double published = 0;    // Eq. 3.12: leaves gravity's impulse out
  double sound = 0;        // (dvt + g sin(angle) T) / (dvn + g cos(angle) T)
  double rolling_cap = 0;  // (1 + e_t)|vt0 + R omega0| / [(1 + 1/kappa)(1 + e)|vn0|], e_t >= 0
};

// Velocities of the mass centre along and out of the surface (m/s) and spin (rad/s, positive
// counter-clockwise; the contact point of a ball moves at vt + R omega).
struct ImpactVelocities {
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
};

// Models that are a formula: the motion after from the motion before, without a path, phases or a
// duration. Garwin 1969, Cross 2002, Walton 1993, Stronge 1990.
enum class ReboundModel { kGarwin, kCross, kWalton, kStronge };
std::string_view name_of(ReboundModel model);
// Throws InvalidArgument.
ReboundModel parse_rebound_model(std::string_view name);
bool is_rebound_model(std::string_view name);

struct ReboundJob {
  ReboundModel model = ReboundModel::kWalton;
  // kPublished: the authors' own rule (Garwin 1969: nothing is lost; Cross 2002: friction grips
  // without limit). kSound: the surface's restitution also for Garwin, and neither grips harder
  // than friction_kinetic allows. Walton (1993) and Stronge (1990) know that limit themselves.
  ModelPreset preset = ModelPreset::kSound;
  ImpactBody body;
  double restitution = 1;             // normal; Stronge: energetic
  double tangential_restitution = 0;  // e_x of Cross, beta_0 of Walton; -1 to 1
  double friction_kinetic = 0;
  double surface_angle_deg = 0;
  // Rods: angle_deg is the axis above the surface, the centre seen from the striking end.
  InitialMotion initial;

  // Throws InvalidArgument naming the key, as it stands in a job file.
  void validate() const;
};

struct ReboundResult {
  ImpactVelocities before, after;
  double restitution = 0;  // of the contact point's normal velocity
  double kinetic_before_j = 0, kinetic_after_j = 0;
  std::vector<std::string> warnings;  // energy that the rule creates
};

}  // namespace impactdic
