#include <impactdic/error.h>
#include <impactdic/impact_model.h>

#include <cmath>

namespace impactdic {

double ImpactBody::inertia() const {
  if (inertia_kg_m2 > 0) return inertia_kg_m2;
  const double radius = radius_m();
  switch (shape) {
    case BodyShape::kHollowSphere:
      return 2.0 / 3.0 * mass_kg * radius * radius;
    case BodyShape::kSolidSphere:
      return 0.4 * mass_kg * radius * radius;
    case BodyShape::kRod:
      return mass_kg * length_m * length_m / 12.0;
    case BodyShape::kOther:
      break;
  }
  return 0;
}

void ImpactBody::validate() const {
  const auto positive = [](double value, const char* key) {
    if (!(value > 0) || !std::isfinite(value)) throw InvalidArgument("must be positive", key);
  };
  positive(mass_kg, "body.mass_kg");
  positive(diameter_m, "body.diameter_m");
  if (inertia_kg_m2 != 0) positive(inertia_kg_m2, "body.inertia_kg_m2");
  if (shape == BodyShape::kRod) positive(length_m, "body.length_m");
  if (shape == BodyShape::kOther && inertia_kg_m2 == 0) {
    throw InvalidArgument("a body without a shape needs its moment of inertia",
                          "body.inertia_kg_m2");
  }
}

}  // namespace impactdic
