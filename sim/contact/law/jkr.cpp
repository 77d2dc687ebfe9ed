// Johnson, Kendall and Roberts (1971): an elastic sphere that sticks to the surface with the work
// of adhesion w. With the contact's radius a and c = sqrt(2 pi w / E*),
//   d = a^2/R - c sqrt(a)        P = 4 E* a^3/(3 R) - 2 E* c a^1.5
// The bodies snap together at d = 0 and part at the least d, where the deflection, not the force,
// is what the motion prescribes. What it takes from d = 0 to there, 7.09 (w^5 R^4/E*^2)^(1/3), the
// rebound loses (Thornton and Ning 1998).
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {
namespace {

class Jkr final : public NormalLaw {
 public:
  Jkr(const ContactParameters& contact, double radius_m)
      : modulus_(contact.reduced_modulus_pa),
        radius_(radius_m),
        pull_(std::sqrt(2 * kPi * contact.adhesion_j_per_m2 / modulus_)),
        least_root_(std::cbrt(pull_ * radius_m / 4)),
        least_deflection_m_(-0.75 * pull_ * least_root_),
        touch_j_(branch_j(std::cbrt(pull_ * radius_m))) {}

  // Beyond the least deflection the force stays, so that an integration step may overshoot.
  double spring_n(double deflection_m, const NormalMemory&) const override {
    return force_n(root_of_width(deflection_m));
  }

  double work_j(double deflection_m, const NormalMemory&) const override {
    const double beyond = std::min(deflection_m - least_deflection_m_, 0.0);
    return branch_j(root_of_width(deflection_m)) - touch_j_ + force_n(least_root_) * beyond;
  }

  NormalMemory turn(double deflection_m, const NormalMemory& memory) const override {
    NormalMemory turned = NormalLaw::turn(deflection_m, memory);
    turned.residual_m = least_deflection_m_;
    return turned;
  }

  // dP/ds over dd/ds. The second derivative is not asked for: no law follows partial slip here.
  Slopes slopes(double deflection_m, const NormalMemory&) const override {
    const double s = root_of_width(deflection_m), cube = s * s * s;
    const double force = 2 * modulus_ * s * s * (4 * cube / radius_ - 3 * pull_);
    const double way = 4 * cube / radius_ - pull_;
    Slopes slopes;
    if (way > 0) slopes.spring = force / way;
    return slopes;
  }

  bool adhesive() const override { return pull_ > 0; }

  std::string out_of_range(double deflection_m) const override {
    const double part = deflection_m / radius_, limit = 0.2;
    if (part > limit) return beyond_limit("the largest deflection over the radius", part, limit);
    const double neck = least_root_ * least_root_ / radius_;
    if (neck > limit) return beyond_limit("the neck's radius over the body's", neck, limit);
    return "";
  }

  double duration_estimate_s(double mass_kg, double speed_m_s) const override {
    return hertz_duration_s(mass_kg, stiffness(), speed_m_s);
  }
  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return hertz_deflection_m(mass_kg, stiffness(), speed_m_s);
  }

 private:
  double stiffness() const { return 4.0 / 3 * modulus_ * std::sqrt(radius_); }

  // s = sqrt(a).
  double force_n(double s) const {
    const double cube = s * s * s;
    return 2 * modulus_ * cube * (2 * cube / (3 * radius_) - pull_);
  }

  // int P dd along the branch, from s = 0.
  double branch_j(double s) const {
    const double cube = s * s * s, part = cube / radius_;
    return 2 * modulus_ * cube * s *
           (4 * part * part / 15 - 2 * pull_ * part / 3 + pull_ * pull_ / 4);
  }

  // The larger root of s^4/R - c s = d. Both starts lie above it, where the curve is convex, so
  // that Newton's method comes down to it.
  double root_of_width(double deflection_m) const {
    const double above = deflection_m - least_deflection_m_;
    if (!(above > 0)) return least_root_;
    const double wide =
        std::cbrt(pull_ * radius_) + std::sqrt(std::sqrt(std::max(deflection_m, 0.0) * radius_));
    double s = wide;
    if (least_root_ > 0) {
      s = std::min(s, least_root_ + std::sqrt(above * radius_ / 6) / least_root_);
    }
    for (int i = 0; i < 60; ++i) {
      const double cube = s * s * s / radius_;
      const double next = s - (s * (cube - pull_) - deflection_m) / (4 * cube - pull_);
      if (!(next < s)) break;
      const bool close = s - next < 1e-15 * s;
      s = next;
      if (close) break;
    }
    return s;
  }

  double modulus_, radius_;
  double pull_;  // c
  double least_root_, least_deflection_m_;
  double touch_j_;
};

}  // namespace

std::unique_ptr<NormalLaw> make_jkr(const ContactParameters& contact, double radius_m) {
  return std::make_unique<Jkr>(contact, radius_m);
}

}  // namespace impactdic::sim::contact
