// The body that strikes the surface.
#pragma once

namespace impactdic::sim::contact {

// kOther: a ball whose moment of inertia is given.
enum class Shape { kHollowSphere, kSolidSphere, kRod, kOther };

// A rigid body in plane motion. A ball touches the surface below its centre; a rod touches it with
// the end that hangs lower, whose cap has the radius diameter_m / 2.
struct Body {
  Shape shape = Shape::kSolidSphere;
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

}  // namespace impactdic::sim::contact
