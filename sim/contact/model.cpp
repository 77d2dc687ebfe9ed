#include <impactdic/error.h>
#include <impactdic/simulate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/parse.h"

namespace impactdic {

namespace {

template <typename Enum, std::size_t N>
using Names = std::array<std::pair<Enum, std::string_view>, N>;

constexpr Names<NormalModel, 11> kNormalModels{
    {{NormalModel::kLinearSpringDamper, "linear_spring_damper"},
     {NormalModel::kHertzDamper, "hertz_damper"},
     {NormalModel::kJacksonGreen, "jackson_green"},
     {NormalModel::kKogutEtsion, "kogut_etsion"},
     {NormalModel::kThornton, "thornton"},
     {NormalModel::kTsuji, "tsuji"},
     {NormalModel::kKuwabaraKono, "kuwabara_kono"},
     {NormalModel::kHuntCrossley, "hunt_crossley"},
     {NormalModel::kWaltonBraun, "walton_braun"},
     {NormalModel::kStronge, "stronge_elastoplastic"},
     {NormalModel::kJkr, "jkr"}}};
constexpr Names<FrictionModel, 10> kFrictionModels{
    {{FrictionModel::kNone, "none"},
     {FrictionModel::kCoulomb, "coulomb"},
     {FrictionModel::kThreePhase, "three_phase"},
     {FrictionModel::kFullSliding, "full_sliding"},
     {FrictionModel::kBrody, "brody"},
     {FrictionModel::kMawBarberFawcett, "maw_barber_fawcett"},
     {FrictionModel::kMindlin, "mindlin"},
     {FrictionModel::kTangentialSpring, "tangential_spring"},
     {FrictionModel::kGripSlip, "grip_slip"},
     {FrictionModel::kSpeedDependent, "speed_dependent"}}};
constexpr Names<ModelPreset, 2> kPresets{
    {{ModelPreset::kPublished, "published"}, {ModelPreset::kSound, "sound"}}};
constexpr Names<RestitutionDamping, 3> kRestitutionDampings{
    {{RestitutionDamping::kNone, "none"},
     {RestitutionDamping::kToZeroForce, "to_zero_force"},
     {RestitutionDamping::kToZeroDeflection, "to_zero_deflection"}}};
constexpr Names<ResidualLaw, 2> kResidualLaws{
    {{ResidualLaw::kJackson, "jackson"}, {ResidualLaw::kKogutEtsion, "kogut_etsion"}}};
constexpr Names<BodyShape, 4> kShapes{{{BodyShape::kHollowSphere, "hollow_sphere"},
                                       {BodyShape::kSolidSphere, "solid_sphere"},
                                       {BodyShape::kRod, "rod"},
                                       {BodyShape::kOther, "other"}}};

template <typename Enum, std::size_t N>
std::string_view find_name(const Names<Enum, N>& names, Enum value) {
  for (const auto& [key, name] : names) {
    if (key == value) return name;
  }
  return "";
}

template <typename Enum, std::size_t N>
Enum find_value(const Names<Enum, N>& names, std::string_view text, const char* what) {
  std::string known;
  for (const auto& [value, name] : names) {
    if (name == text) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw InvalidArgument("'" + std::string(text) + "' is not known", what, "one of " + known);
}

void require(bool good, const char* what, const char* key, const std::string& hint = "") {
  if (!good) throw InvalidArgument(what, key, hint);
}

void require_positive(double value, const char* key, const std::string& hint = "") {
  require(std::isfinite(value) && value > 0, "must be positive", key, hint);
}

void require_not_negative(double value, const char* key) {
  require(std::isfinite(value) && value >= 0, "must not be negative", key);
}

void validate_normal(const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  const auto in_contact = [](std::string_view key) { return "contact." + std::string(key); };
  if (const std::string_view key = stiffness_key(job.normal); !key.empty()) {
    require_positive(contact.stiffness, in_contact(key).c_str());
  } else {
    require_positive(contact.reduced_modulus_pa, "contact.reduced_modulus_pa");
  }
  if (const std::string_view key = damping_key(job.normal); !key.empty()) {
    require_not_negative(contact.damping(job.normal), in_contact(key).c_str());
  }
  switch (job.normal) {
    case NormalModel::kTsuji:
    case NormalModel::kKuwabaraKono:
      require(contact.restitution_damping != RestitutionDamping::kNone,
              "this law damps the restitution, too", "contact.restitution_damping",
              "to_zero_force or to_zero_deflection");
      break;
    case NormalModel::kWaltonBraun:
      require_not_negative(contact.unloading_hardening_per_m, "contact.unloading_hardening_per_m");
      require(std::isfinite(contact.unloading_stiffness_n_per_m) &&
                  contact.unloading_stiffness_n_per_m >= contact.stiffness,
              "must be at least stiffness_n_per_m", "contact.unloading_stiffness_n_per_m",
              "the way back is the steeper one");
      break;
    case NormalModel::kJkr:
      require_not_negative(contact.adhesion_j_per_m2, "contact.adhesion_j_m2");
      break;
    case NormalModel::kJacksonGreen:
    case NormalModel::kKogutEtsion:
    case NormalModel::kThornton:
    case NormalModel::kStronge:
      require_positive(contact.yield_strength_pa, "contact.yield_strength_pa");
      break;
    default:
      break;
  }
}

// Laws whose contact gives way along the surface.
void validate_elastic_friction(const ImpactJob& job) {
  const std::string law(name_of(job.friction));
  require(job.body.shape != BodyShape::kRod, (law + " is a law for balls").c_str(), "friction");
  require_positive(job.contact.friction_kinetic, "contact.friction_kinetic");
  if (job.friction == FrictionModel::kMawBarberFawcett) {
    require(has_hertz_spring(job.normal),
            "maw_barber_fawcett needs the pressure of a Hertz contact", "normal",
            "hertz_damper, tsuji, kuwabara_kono or hunt_crossley; or friction mindlin");
  } else if (job.friction == FrictionModel::kMindlin) {
    require(job.normal != NormalModel::kJacksonGreen && job.normal != NormalModel::kKogutEtsion,
            "partial slip follows no normal force that jumps, as this published fit does", "normal",
            "thornton or stronge_elastoplastic; or friction tangential_spring");
    require(job.normal != NormalModel::kJkr, "partial slip knows no adhesion", "normal",
            "another law; or friction tangential_spring");
  } else {
    require_positive(job.contact.tangential_stiffness_n_per_m,
                     "contact.tangential_stiffness_n_per_m");
  }
}

void validate_friction(const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  require(!name_of(job.friction).empty(), "is not known", "friction");
  require_not_negative(contact.friction_kinetic, "contact.friction_kinetic");
  require_not_negative(contact.friction_static, "contact.friction_static");
  require(contact.friction_kinetic <= 100, "must be at most 100", "contact.friction_kinetic",
          "the body grips long before");
  require(contact.poisson >= 0 && contact.poisson <= 0.5, "must be from 0 to 0.5",
          "contact.poisson");
  if (job.friction == FrictionModel::kThreePhase || job.friction == FrictionModel::kGripSlip ||
      job.friction == FrictionModel::kSpeedDependent) {
    require(contact.friction_static >= contact.friction_kinetic,
            "must be at least friction_kinetic", "contact.friction_static");
  }
  if (job.friction == FrictionModel::kSpeedDependent) {
    require_positive(contact.friction_speed_m_s, "contact.friction_speed_m_s");
  }
  if (remembers_slip(job.friction)) validate_elastic_friction(job);
}

void validate_turning_resistance(const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  require_not_negative(contact.rolling_friction, "contact.rolling_friction");
  require_not_negative(contact.spinning_friction, "contact.spinning_friction");
  require(contact.rolling_friction <= 10, "must be at most 10", "contact.rolling_friction");
  require(contact.spinning_friction <= 100, "must be at most 100", "contact.spinning_friction");
  if (contact.rolling_friction == 0 && contact.spinning_friction == 0) return;
  require(job.body.shape != BodyShape::kRod && !job.other,
          "friction of rolling and spinning is known of one ball alone",
          contact.rolling_friction > 0 ? "contact.rolling_friction" : "contact.spinning_friction");
  if (contact.rolling_friction == 0 || job.initial.plane()) return;
  require(
      !remembers_slip(job.friction),
      "out of the plane of t and n rolling friction turns the slip, which this friction law does "
      "not know",
      "contact.rolling_friction", "coulomb, or rolling_friction 0");
  require(job.gravity_m_s2 == 0 || job.surface_angle_deg == 0,
          "out of the plane of t and n rolling friction needs a level surface or no gravity",
          "contact.rolling_friction");
}

void require_finite(const InitialMotion& m, const std::string& table) {
  for (const auto& [value, key] :
       {std::pair{m.vt_m_s, "vt_m_s"}, std::pair{m.vn_m_s, "vn_m_s"}, std::pair{m.vb_m_s, "vb_m_s"},
        std::pair{m.omega_rad_s, "omega_rad_s"}, std::pair{m.omega_t_rad_s, "omega_t_rad_s"},
        std::pair{m.omega_n_rad_s, "omega_n_rad_s"}, std::pair{m.angle_deg, "angle_deg"}}) {
    require(std::isfinite(value), "must be a finite number", (table + "." + key).c_str());
  }
}

// Motion out of the plane of t and n.
void validate_space(const ImpactJob& job) {
  if (job.initial.plane() && (!job.other || job.other->initial.plane())) return;
  require(job.body.shape != BodyShape::kRod, "a rod moves in the plane of t and n only",
          "initial.vb_m_s");
  const bool chapter4 = job.friction == FrictionModel::kThreePhase ||
                        job.friction == FrictionModel::kFullSliding ||
                        job.friction == FrictionModel::kBrody;
  require(job.preset == ModelPreset::kSound || !chapter4,
          "the published rule knows motion in the plane of t and n only", "preset", "sound");
}

void validate_air(const ImpactJob& job) {
  require(job.air.density_kg_m3 > 0 && std::isfinite(job.air.density_kg_m3), "must be positive",
          "air.density_kg_m3");
  require_not_negative(job.air.drag_coefficient, "air.drag_coefficient");
  require(std::isfinite(job.air.lift_coefficient), "must be a finite number",
          "air.lift_coefficient");
  require(!job.air.act() || (job.body.shape != BodyShape::kRod && !job.other),
          "the air's forces are known of one ball alone", "air");
}

// Its part in contact leaves the surface and comes back, so that no law may remember slip or depth.
void validate_shell(const ImpactJob& job) {
  const BallShell& shell = *job.shell;
  require_positive(shell.stiffness_n_per_m, "shell.stiffness_n_per_m");
  require_not_negative(shell.damping_n_s_per_m, "shell.damping_n_s_per_m");
  const double flat = shell.flat_fraction;
  require(flat > 0 && flat < 1, "must be above 0 and below 1", "shell.flat_fraction");
  const double reduced_kg = flat * (1 - flat) * job.body.mass_kg;
  require(shell.damping_n_s_per_m < 2 * std::sqrt(shell.stiffness_n_per_m * reduced_kg),
          "must be below that of a ball that does not swing", "shell.damping_n_s_per_m",
          "2 sqrt(k f (1 - f) m)");
  require(job.body.shape != BodyShape::kRod && !job.other, "is known of one ball alone", "shell");
  const bool forgets =
      job.normal == NormalModel::kLinearSpringDamper || has_hertz_spring(job.normal);
  require(forgets && job.contact.restitution_damping != RestitutionDamping::kToZeroForce,
          "lies in series with a surface that comes back with the ball", "normal",
          "linear_spring_damper or hertz_damper with restitution_damping none or "
          "to_zero_deflection, or hunt_crossley");
  require(!remembers_slip(job.friction), "knows no friction that remembers slip", "friction",
          "coulomb");
  require(job.preset == ModelPreset::kSound, "is known of sound models only", "preset");
  require(!job.air.act(), "swings without the air's forces", "air");
}

void validate_other(const ImpactJob& job) {
  const OtherBody& other = *job.other;
  const auto in_other = [](const Error& error) {
    std::string key = error.where();
    if (key.rfind("body.", 0) == 0) key = "other" + key.substr(4);
    return key;
  };
  try {
    other.body.validate();
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), in_other(error), error.hint());
  }
  require_finite(other.initial, "other");
  require(job.body.shape != BodyShape::kRod && other.body.shape != BodyShape::kRod,
          "two bodies that both move must be balls", "other.shape");
  require(job.surface_radius_m == 0, "the other ball is the surface", "surface.radius_m",
          "leave it out");
  require(job.solver.contacts == 1, "only one contact is followed of two balls", "solver.contacts");
}

}  // namespace

bool has_hertz_spring(NormalModel law) {
  return law == NormalModel::kHertzDamper || law == NormalModel::kTsuji ||
         law == NormalModel::kKuwabaraKono || law == NormalModel::kHuntCrossley;
}

bool slips_partially(FrictionModel law) {
  return law == FrictionModel::kMawBarberFawcett || law == FrictionModel::kMindlin;
}

bool remembers_slip(FrictionModel law) {
  return slips_partially(law) || law == FrictionModel::kTangentialSpring ||
         law == FrictionModel::kGripSlip;
}

std::string_view stiffness_key(NormalModel law) {
  if (has_hertz_spring(law)) return "stiffness_n_per_m1p5";
  const bool linear = law == NormalModel::kLinearSpringDamper || law == NormalModel::kWaltonBraun;
  return linear ? "stiffness_n_per_m" : "";
}

namespace {

struct Damper {
  std::string_view key;
  double ContactParameters::*constant = nullptr;
};

Damper damper_of(NormalModel law) {
  switch (law) {
    case NormalModel::kLinearSpringDamper:
    case NormalModel::kHertzDamper:
      return {"damping_n_s_per_m", &ContactParameters::damping_n_s_per_m};
    case NormalModel::kTsuji:
      return {"damping_factor", &ContactParameters::damping_factor};
    case NormalModel::kKuwabaraKono:
      return {"dissipation_s", &ContactParameters::dissipation_s};
    case NormalModel::kHuntCrossley:
      return {"damping_s_per_m", &ContactParameters::damping_s_per_m};
    default:
      return {};
  }
}

}  // namespace

std::string_view damping_key(NormalModel law) { return damper_of(law).key; }

double ContactParameters::damping(NormalModel law) const {
  const Damper damper = damper_of(law);
  return damper.constant == nullptr ? std::nan("") : this->*damper.constant;
}

void ContactParameters::set_damping(NormalModel law, double value) {
  const Damper damper = damper_of(law);
  if (damper.constant != nullptr) this->*damper.constant = value;
}

std::string_view name_of(NormalModel model) { return find_name(kNormalModels, model); }
std::string_view name_of(FrictionModel model) { return find_name(kFrictionModels, model); }
std::string_view name_of(ModelPreset preset) { return find_name(kPresets, preset); }
std::string_view name_of(RestitutionDamping damping) {
  return find_name(kRestitutionDampings, damping);
}
std::string_view name_of(ResidualLaw law) { return find_name(kResidualLaws, law); }
std::string_view name_of(BodyShape shape) { return find_name(kShapes, shape); }

NormalModel parse_normal_model(std::string_view name) {
  return find_value(kNormalModels, name, "normal");
}
FrictionModel parse_friction_model(std::string_view name) {
  if (name == "three_phase_friction") return FrictionModel::kThreePhase;  // its long name
  return find_value(kFrictionModels, name, "friction");
}
ModelPreset parse_preset(std::string_view name) { return find_value(kPresets, name, "preset"); }
RestitutionDamping parse_restitution_damping(std::string_view name) {
  return find_value(kRestitutionDampings, name, "contact.restitution_damping");
}
ResidualLaw parse_residual_law(std::string_view name) {
  return find_value(kResidualLaws, name, "contact.residual");
}
BodyShape parse_shape(std::string_view name) { return find_value(kShapes, name, "body.shape"); }

void ImpactJob::validate() const {
  body.validate();
  validate_normal(*this);
  validate_friction(*this);
  validate_turning_resistance(*this);
  require_not_negative(gravity_m_s2, "environment.gravity_m_s2");
  require(std::isfinite(surface_angle_deg) && std::abs(surface_angle_deg) <= 180,
          "must be from -180 to 180", "surface.angle_deg");
  validate_air(*this);
  require_finite(initial, "initial");
  validate_space(*this);
  if (other) validate_other(*this);
  if (shell) validate_shell(*this);
  require(std::isfinite(surface_radius_m) && !(surface_radius_m < 0 && contact_radius_m() <= 0),
          "a hollow must be wider than the ball", "surface.radius_m");
  require_not_negative(initial.gap_m, "initial.gap_m");
  const double tolerance = solver.relative_tolerance;
  require(tolerance >= 1e-14 && tolerance <= 1e-3, "must be from 1e-14 to 1e-3",
          "solver.relative_tolerance");
  require(solver.contacts >= 1, "must be at least 1", "solver.contacts");
  if (body.shape == BodyShape::kRod) {
    require(initial.angle_deg > 0 && initial.angle_deg < 180,
            "the striking end must be the lower one: between 0 and 180", "initial.angle_deg");
    require(initial.gap_m == 0, "a rod must start in contact", "initial.gap_m");
    require(solver.contacts == 1, "only one contact is followed for a rod", "solver.contacts");
  }
}

void SimulateRequest::validate() const {
  impact.validate();
  require(rate_hz >= 0 && std::isfinite(rate_hz), "must not be negative", "output.rate_hz");
  require(rate_hz == 0 || times_s.empty(), "the points are given twice", "times_s",
          "rate_hz or times_s");
  require(std::all_of(times_s.begin(), times_s.end(), [](double t) { return std::isfinite(t); }) &&
              std::is_sorted(times_s.begin(), times_s.end()),
          "must be numbers that ascend", "times_s");
}

}  // namespace impactdic
