// The part of a job that says what the bodies are made of.
#pragma once

#include <impactdic/impact_model.h>

#include <optional>
#include <string>

namespace impactdic::sim::job {

class StrictTable;
class TomlText;

// A spring whose stiffness the job states, beside a damper.
bool has_spring_damper(const ImpactJob& job);
// A normal law whose restitution follows from one constant and may be given in its place.
bool takes_restitution(const ImpactJob& job);
// Of those, one whose restitution depends on the speed.
bool needs_restitution_speed(const ImpactJob& job);
// The key of the spring's stiffness, which has the law's unit.
std::string stiffness_key(const ImpactJob& job);

// Both bodies' moduli, from the tables body and surface (or other), and a restitution of the normal
// impact, from the table contact; nullopt where neither is given. Throws InvalidArgument naming
// file and key.
std::optional<ContactMaterials> read_materials(StrictTable& root, StrictTable& contact,
                                               const ImpactJob& job);
// The parameters of the contact that follow from them. Throws InvalidArgument naming file and key
// where the table states others.
void take_materials(StrictTable& contact, ImpactJob& job, const ContactMaterials& materials);
void write_material(TomlText& text, const ElasticMaterial& material);

}  // namespace impactdic::sim::job
