#include "sim/job/materials_toml.h"

#include <impactdic/error.h>

#include <cmath>

#include "host/base/parse.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::job {
namespace {

// Young's modulus and Poisson's ratio, or neither.
ElasticMaterial read_material(StrictTable& table) {
  ElasticMaterial material;
  if (!table.has("young_pa")) {
    table.hint("poisson", "it belongs to young_pa");
    return material;
  }
  material.young_pa = table.number("young_pa");
  material.poisson = table.number("poisson");
  if (!(material.young_pa > 0)) throw InvalidArgument("must be positive", table.place("young_pa"));
  return material;
}

// Where a file gives both a material and what follows from it, as a resolved job does, the two must
// agree; the figure that stands there is taken, to its last digit.
void keep_given(StrictTable& table, const std::string& key, double& computed) {
  if (!table.has(key)) return;
  const double given = table.number(key);
  if (!(std::abs(given - computed) <= 1e-9 * std::abs(computed))) {
    throw InvalidArgument("does not follow from the materials, which give " + shortest(computed),
                          table.place(key), "leave it out, or the materials");
  }
  computed = given;
}

}  // namespace

bool has_spring_damper(const ImpactJob& job) { return !damping_key(job.normal).empty(); }

bool takes_restitution(const ImpactJob& job) {
  return has_spring_damper(job) || job.normal == NormalModel::kWaltonBraun;
}

bool needs_restitution_speed(const ImpactJob& job) {
  return has_hertz_spring(job.normal) && job.normal != NormalModel::kTsuji;
}

std::string stiffness_key(const ImpactJob& job) {
  return std::string(impactdic::stiffness_key(job.normal));
}

std::optional<ContactMaterials> read_materials(StrictTable& root, StrictTable& contact,
                                               const ImpactJob& job) {
  ContactMaterials materials;
  const std::string across = job.other ? "other" : "surface";
  materials.body = read_material(root.table("body"));
  materials.surface = read_material(root.table(across));
  const bool elastic = materials.body.young_pa > 0, surface = materials.surface.young_pa > 0;
  if (elastic != surface) {
    throw InvalidArgument("the key is missing",
                          root.table(elastic ? across : "body").place("young_pa"),
                          "both bodies are elastic: a rigid one has a very large modulus");
  }
  if (takes_restitution(job) && contact.has("restitution")) {
    materials.restitution = contact.number("restitution");
    if (!(materials.restitution > 0 && materials.restitution <= 1)) {
      throw InvalidArgument("must be above 0 and at most 1", contact.place("restitution"));
    }
    if (needs_restitution_speed(job)) {
      materials.restitution_speed_m_s = contact.number("restitution_speed_m_s");
    } else {
      contact.hint("restitution_speed_m_s",
                   "the restitution of this law does not depend on the speed");
    }
  }
  if (!elastic && materials.restitution == 0) return std::nullopt;
  return materials;
}

void take_materials(StrictTable& table, ImpactJob& job, const ContactMaterials& materials) {
  try {
    job.take_materials(materials);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), table.file() + ": " + error.where(), error.hint());
  }
  if (materials.body.young_pa > 0) {
    keep_given(table, "reduced_modulus_pa", job.contact.reduced_modulus_pa);
    if (has_hertz_spring(job.normal)) {
      keep_given(table, stiffness_key(job), job.contact.stiffness);
    }
    if (slips_partially(job.friction)) {
      keep_given(table, "poisson", job.contact.poisson);
    }
  }
  if (materials.restitution > 0) {
    if (job.normal == NormalModel::kWaltonBraun) {
      keep_given(table, "unloading_stiffness_n_per_m", job.contact.unloading_stiffness_n_per_m);
      return;
    }
    double damping = job.contact.damping(job.normal);
    keep_given(table, std::string(damping_key(job.normal)), damping);
    job.contact.set_damping(job.normal, damping);
  }
}

void write_material(TomlText& text, const ElasticMaterial& material) {
  text.number("young_pa", material.young_pa);
  text.number("poisson", material.poisson);
}

}  // namespace impactdic::sim::job
