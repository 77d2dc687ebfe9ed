#include <impactdic/error.h>
#include <impactdic/impact_model.h>

#include <cmath>

#include "sim/contact/numbers/numbers.h"

namespace impactdic {

double ImpactBody::inertia() const {
  return sim::contact::BodyNumbers<double>{shape, mass_kg, diameter_m, length_m, inertia_kg_m2}
      .inertia();
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
