#include <impactdic/error.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/closed_form.h"
#include "sim/contact/never.h"

namespace impactdic::sim::contact {

namespace {

// The contact point's velocity and the normal impulse's work as the normal impulse p grows. Within
// a stretch (one sense of slip, or sticking) velocities are linear in p and the work is quadratic.
class ImpulseProcess {
 public:
  ImpulseProcess(double inverse_tt, double inverse_tn, double inverse_nn, double friction)
      : tt_(inverse_tt), tn_(inverse_tn), nn_(inverse_nn), friction_(friction) {}

  double vt = 0, vn = 0, work = 0, jt = 0, jn = 0;

  // Grows p by the shorter of: to vt = 0, to vn = 0 in compression, to work = target.
  // Returns whether one of the latter two was met.
  bool advance(bool compression, double target) {
    const double ratio = tangential_ratio();  // dJt/dp
    const double vt_rate = tt_ * ratio + tn_, vn_rate = tn_ * ratio + nn_;
    const double to_stop = vt * vt_rate < 0 ? -vt / vt_rate : kNever;
    const double to_end =
        compression ? (vn_rate > 0 ? -vn / vn_rate : kNever) : step_to_work(vn_rate, target - work);
    const double step = std::min(to_stop, to_end);
    if (step == kNever) throw Error("the impulse does not end", "Stronge's restitution");
    jt += ratio * step;
    jn += step;
    work += step * (vn + 0.5 * vn_rate * step);
    vn += vn_rate * step;
    vt = to_stop <= to_end ? 0 : vt + vt_rate * step;
    return to_end <= to_stop;
  }

 private:
  double tangential_ratio() const {
    if (vt != 0) return vt > 0 ? -friction_ : friction_;
    const double holding = -tn_ / tt_;
    return std::clamp(holding, -friction_, friction_);
  }

  // The smallest step > 0 with vn step + rate/2 step^2 = work.
  double step_to_work(double rate, double wanted) const {
    const double root = vn * vn + 2 * rate * wanted;
    if (root < 0) return kNever;
    return 2 * wanted / (vn + std::sqrt(root));
  }

  double tt_, tn_, nn_, friction_;
};

}  // namespace

ImpactVelocities stronge_rebound(const ImpactBody& body, double arm_t_m, double arm_n_m,
                                 const ImpactVelocities& before, double energetic_restitution,
                                 double friction) {
  const double per_mass = 1 / body.mass_kg, per_inertia = 1 / body.inertia();
  ImpulseProcess process(per_mass + arm_n_m * arm_n_m * per_inertia,
                         -arm_t_m * arm_n_m * per_inertia,
                         per_mass + arm_t_m * arm_t_m * per_inertia, friction);
  process.vt = before.vt_m_s - before.omega_rad_s * arm_n_m;
  process.vn = before.vn_m_s + before.omega_rad_s * arm_t_m;
  if (!(process.vn < 0)) {
    throw InvalidArgument("the contact point does not approach the surface", "vn_m_s");
  }
  while (!process.advance(true, 0)) {
  }
  const double target = process.work * (1 - energetic_restitution * energetic_restitution);
  if (energetic_restitution > 0) {
    while (!process.advance(false, target)) {
    }
  }
  return {before.vt_m_s + process.jt * per_mass, before.vn_m_s + process.jn * per_mass,
          before.omega_rad_s + (arm_t_m * process.jn - arm_n_m * process.jt) * per_inertia};
}

}  // namespace impactdic::sim::contact
