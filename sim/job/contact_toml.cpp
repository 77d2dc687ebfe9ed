#include "sim/job/contact_toml.h"

#include <impactdic/error.h>

#include "sim/contact/closed_form.h"
#include "sim/job/job_toml.h"
#include "sim/job/materials_toml.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::job {

namespace {

// Materials, where they are given, say the stiffness of a Hertz contact once more (take_materials).
bool follows_from_materials(const ImpactJob& job) {
  return job.materials && job.materials->body.young_pa > 0;
}

void read_spring(StrictTable& table, const ImpactJob& job, bool partial,
                 ContactParameters& contact) {
  const std::string key = stiffness_key(job);
  const bool follows =
      has_hertz_spring(job.normal) && !table.has(key) && follows_from_materials(job);
  if (!follows) contact.stiffness = needed(table, key.c_str(), partial);
  const std::string takes = std::string(name_of(job.normal)) + " takes " + key;
  table.hint("stiffness_n_per_m", takes);
  table.hint("stiffness_n_per_m1p5", takes);
  if (has_spring_damper(job)) {
    contact.set_damping(job.normal, table.number(std::string(damping_key(job.normal)), 0));
    table.hint("damping_n_s_per_m",
               std::string(name_of(job.normal)) + " takes " + std::string(damping_key(job.normal)));
  }
}

// tsuji and kuwabara_kono damp throughout: as published until the deflection is zero.
const char* usual_damping(const ImpactJob& job) {
  if (job.normal != NormalModel::kTsuji && job.normal != NormalModel::kKuwabaraKono) return "none";
  return job.preset == ModelPreset::kPublished ? "to_zero_deflection" : "to_zero_force";
}

void read_normal(StrictTable& table, const ImpactJob& job, bool partial,
                 ContactParameters& contact) {
  const bool elastic = follows_from_materials(job);
  if (!stiffness_key(job).empty()) {
    read_spring(table, job, partial, contact);
  } else {
    contact.reduced_modulus_pa = needed(table, "reduced_modulus_pa", partial || elastic);
  }
  switch (job.normal) {
    case NormalModel::kLinearSpringDamper:
    case NormalModel::kHertzDamper:
    case NormalModel::kTsuji:
    case NormalModel::kKuwabaraKono:
      contact.restitution_damping =
          choose(table, "restitution_damping", usual_damping(job), parse_restitution_damping);
      break;
    case NormalModel::kHuntCrossley:
      table.hint("restitution_damping", "hunt_crossley damps throughout and never pulls");
      break;
    case NormalModel::kWaltonBraun:
      contact.unloading_hardening_per_m = table.number("unloading_hardening_per_m", 0);
      if (contact.unloading_hardening_per_m != 0) {
        contact.unloading_stiffness_n_per_m =
            table.number("unloading_stiffness_n_per_m", contact.stiffness);
      } else {
        contact.unloading_stiffness_n_per_m =
            needed(table, "unloading_stiffness_n_per_m", partial || table.has("restitution"));
      }
      break;
    case NormalModel::kJkr:
      contact.adhesion_j_per_m2 = needed(table, "adhesion_j_m2", partial);
      break;
    default:
      contact.yield_strength_pa = needed(table, "yield_strength_pa", partial);
      if (job.normal == NormalModel::kStronge) break;
      contact.poisson = needed(table, "poisson", partial);
      contact.residual = choose(table, "residual", "jackson", parse_residual_law);
  }
}

void read_friction(StrictTable& table, const ImpactJob& job, bool partial,
                   ContactParameters& contact) {
  if (job.friction != FrictionModel::kNone) {
    contact.friction_kinetic = needed(table, "friction_kinetic", partial);
  }
  contact.rolling_friction = table.number("rolling_friction", 0);
  contact.spinning_friction = table.number("spinning_friction", 0);
  switch (job.friction) {
    case FrictionModel::kThreePhase:
      contact.friction_static = needed(table, "friction_static", partial);
      break;
    case FrictionModel::kSpeedDependent:
      contact.friction_static = needed(table, "friction_static", partial);
      contact.friction_speed_m_s = needed(table, "friction_speed_m_s", partial);
      break;
    case FrictionModel::kGripSlip:
      contact.friction_static = table.number("friction_static", contact.friction_kinetic);
      contact.tangential_stiffness_n_per_m = needed(table, "tangential_stiffness_n_per_m", partial);
      break;
    case FrictionModel::kTangentialSpring:
      contact.tangential_stiffness_n_per_m = needed(table, "tangential_stiffness_n_per_m", partial);
      [[fallthrough]];
    default:
      table.hint("friction_static", "only three_phase, grip_slip and speed_dependent have it");
  }
  if (slips_partially(job.friction)) {
    contact.poisson = needed(table, "poisson", partial || follows_from_materials(job));
  }
}

}  // namespace

ContactParameters read_contact(StrictTable& table, const ImpactJob& job, bool partial) {
  ContactParameters contact;
  read_normal(table, job, partial, contact);
  read_friction(table, job, partial, contact);
  return contact;
}

ContactParameters read_kelvin_voigt(StrictTable& table, const ImpactJob& job) {
  ContactParameters contact;
  const bool published = job.preset == ModelPreset::kPublished;
  contact.restitution_damping =
      published ? RestitutionDamping::kToZeroDeflection : RestitutionDamping::kToZeroForce;
  if (table.has("restitution")) {
    const double restitution = table.number("restitution"), duration = table.number("contact_s");
    if (!(restitution > 0 && restitution <= 1)) {
      throw InvalidArgument("must be above 0 and at most 1", table.place("restitution"));
    }
    if (!(duration > 0)) throw InvalidArgument("must be positive", table.place("contact_s"));
    const contact::SpringDamperParameters pair =
        published ? contact::kelvin_voigt_parameters(job.body.mass_kg, restitution, duration)
                  : contact::force_free_parameters(job.body.mass_kg, restitution, duration);
    contact.stiffness = pair.stiffness;
    contact.damping_n_s_per_m = pair.damping_n_s_per_m;
  } else {
    contact.stiffness = table.number("stiffness_n_per_m");
    contact.damping_n_s_per_m = table.number("damping_n_s_per_m");
  }
  read_friction(table, job, false, contact);
  return contact;
}

namespace {

void write_spring(TomlText& text, const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  text.number(stiffness_key(job), contact.stiffness);
  if (has_spring_damper(job)) {
    text.number(std::string(damping_key(job.normal)), contact.damping(job.normal));
  }
  if (job.normal == NormalModel::kWaltonBraun) {
    text.number("unloading_stiffness_n_per_m", contact.unloading_stiffness_n_per_m);
    text.number("unloading_hardening_per_m", contact.unloading_hardening_per_m);
  } else if (job.normal != NormalModel::kHuntCrossley) {
    text.name("restitution_damping", name_of(contact.restitution_damping));
  }
  if (job.materials && job.materials->restitution > 0) {
    text.number("restitution", job.materials->restitution);
    if (needs_restitution_speed(job)) {
      text.number("restitution_speed_m_s", job.materials->restitution_speed_m_s);
    }
  }
  if (job.materials && job.materials->body.young_pa > 0) {
    text.number("reduced_modulus_pa", contact.reduced_modulus_pa);
  }
}

void write_friction(TomlText& text, const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  // Beyond those of the job's own friction: what other models of a comparison need.
  if (job.friction != FrictionModel::kNone || contact.friction_kinetic != 0) {
    text.number("friction_kinetic", contact.friction_kinetic);
  }
  if (job.friction == FrictionModel::kThreePhase || contact.friction_static != 0) {
    text.number("friction_static", contact.friction_static);
  }
  if (contact.tangential_stiffness_n_per_m != 0) {
    text.number("tangential_stiffness_n_per_m", contact.tangential_stiffness_n_per_m);
  }
  if (contact.friction_speed_m_s != 0) {
    text.number("friction_speed_m_s", contact.friction_speed_m_s);
  }
  if (contact.rolling_friction != 0) text.number("rolling_friction", contact.rolling_friction);
  if (contact.spinning_friction != 0) text.number("spinning_friction", contact.spinning_friction);
}

}  // namespace

void write_contact(TomlText& text, const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  const bool spring = !stiffness_key(job).empty();
  const bool fitted =
      !spring && job.normal != NormalModel::kStronge && job.normal != NormalModel::kJkr;
  text.table("contact");
  if (spring) {
    write_spring(text, job);
  } else {
    text.number("reduced_modulus_pa", contact.reduced_modulus_pa);
    if (job.normal == NormalModel::kJkr) {
      text.number("adhesion_j_m2", contact.adhesion_j_per_m2);
    } else {
      text.number("yield_strength_pa", contact.yield_strength_pa);
    }
    if (fitted) text.name("residual", name_of(contact.residual));
  }
  if (fitted || slips_partially(job.friction) || contact.poisson != 0) {
    text.number("poisson", contact.poisson);
  }
  write_friction(text, job);
}

}  // namespace impactdic::sim::job
