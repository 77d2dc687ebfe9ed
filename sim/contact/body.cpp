#include "sim/contact/body.h"

#include <impactdic/error.h>

#include <cmath>

namespace impactdic::sim::contact {

double Body::inertia() const {
  if (inertia_kg_m2 > 0) return inertia_kg_m2;
  const double radius = radius_m();
  switch (shape) {
    case Shape::kHollowSphere:
      return 2.0 / 3.0 * mass_kg * radius * radius;
    case Shape::kSolidSphere:
      return 0.4 * mass_kg * radius * radius;
    case Shape::kRod:
      return mass_kg * length_m * length_m / 12.0;
    case Shape::kOther:
      break;
  }
  return 0;
}

void Body::validate() const {
  const auto positive = [](double value, const char* key) {
    if (!(value > 0) || !std::isfinite(value)) throw InvalidArgument("must be positive", key);
  };
  positive(mass_kg, "body.mass_kg");
  positive(diameter_m, "body.diameter_m");
  if (inertia_kg_m2 != 0) positive(inertia_kg_m2, "body.inertia_kg_m2");
  if (shape == Shape::kRod) positive(length_m, "body.length_m");
  if (shape == Shape::kOther && inertia_kg_m2 == 0) {
    throw InvalidArgument("a body without a shape needs its moment of inertia",
                          "body.inertia_kg_m2");
  }
}

}  // namespace impactdic::sim::contact
