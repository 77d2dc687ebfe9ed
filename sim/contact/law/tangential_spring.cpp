// A spring along the surface in series with Coulomb friction: Stronge's bilinear compliance (2000,
// chapter 5), whose spring sticks or slips as a whole, and Cross's grip and slip (2002), which
// needs more friction to come loose than to go on slipping. It is also what partial slip becomes
// under a linear normal law: a contact of constant area, a flat punch, sticks until all of it slips
// (Jaeger 1998; Ciavarella 1998), with k_t / k_n = G* / E*.
//
// While it sticks the spring is stretched by the way of the contact point; while it slips it is
// stretched by mu P / k_t, and what the contact point moves beyond that is slip.
#include <algorithm>
#include <cmath>

#include "sim/contact/law/friction_law.h"

namespace impactdic::sim::contact {

namespace {

template <typename Real>
class TangentialSpring final : public FrictionLawOf<Real> {
 public:
  using ContactPoint = ContactPointOf<Real>;
  using Traction = TractionOf<Real>;
  using Guards = typename FrictionLawOf<Real>::Guards;

  TangentialSpring(const Real& stiffness, const Real& kinetic, const Real& least_static)
      : stiffness_(stiffness), kinetic_(kinetic), static_(std::max(least_static, kinetic)) {}

  // A load that grows from nothing more slowly than the spring would be stretched lets it slip at
  // once; a step from a state that sticks could pass over that.
  void begin(const ContactPoint& at, In<Real>) override {
    hold(at, Real(0));
    pulled_ = at.law_n < 0;
    const Real outgrows = stiffness_ * abs(at.tip_vt_m_s) - static_ * at.normal_rate_n_s;
    if (at.tip_vt_m_s != 0 && !(at.law_n > 0) && outgrows > 0) side_ = at.tip_vt_m_s > 0 ? 1 : -1;
  }

  bool asks_force_rate() const override { return true; }

  Traction traction(const ContactPoint& at) const override {
    Traction result;
    if (side_ == 0) {
      result.force_n = -stiffness_ * stretch(at);
      return result;
    }
    result.force_n = -side_ * kinetic_ * at.normal_n;
    result.dissipation_w = kinetic_ * at.normal_n * slip_speed(at);
    return result;
  }

  int guards(const ContactPoint& at, Guards& values) const override {
    if (side_ != 0) {
      values[0] = pulled_ ? Real(-at.law_n) : slip_speed(at);
      return 1;
    }
    const Real force = stiffness_ * stretch(at), most = static_ * at.normal_n;
    values[0] = most - force;
    values[1] = most + force;
    return 2;
  }

  void cross(int guard, const ContactPoint& at) override {
    if (side_ != 0) {
      // What was pulled is pressed from here on: the spring takes up the slip if it can.
      const bool slips = pulled_ && slip_speed(at) > 0;
      pulled_ = false;
      if (!slips) hold(at, stretch(at));
      return;
    }
    pulled_ = at.law_n < 0;
    const Real held = stored(stretch(at));
    side_ = guard == 0 ? 1 : -1;
    // What the spring gives up as it comes loose is lost in that instant.
    lost_j_ = held - stored(stretch(at));
  }

  void jump(const ContactPoint& before, const ContactPoint& after) override {
    if (side_ != 0) hold(after, stretch(before));
  }

  Real lost_at_once_j() const override { return lost_j_; }

  const char* mode() const override { return side_ == 0 ? "sticking" : "sliding"; }

  Real stored_j(const ContactPoint& at, In<Real>) const override { return stored(stretch(at)); }

 private:
  Real stored(const Real& stretch_m) const { return 0.5 * stiffness_ * stretch_m * stretch_m; }

  Real stretch(const ContactPoint& at) const {
    return side_ == 0 ? Real(at.tip_m - anchor_m_)
                      : Real(side_ * kinetic_ * at.normal_n / stiffness_);
  }

  // Of the slip in its own direction.
  Real slip_speed(const ContactPoint& at) const {
    const bool pressed = at.law_n >= 0;
    const Real stretching = pressed ? kinetic_ * at.normal_rate_n_s / stiffness_ : Real(0);
    return side_ * at.tip_vt_m_s - stretching;
  }

  void hold(const ContactPoint& at, const Real& stretch_m) {
    side_ = 0;
    lost_j_ = Real(0);
    anchor_m_ = at.tip_m - stretch_m;
  }

  Real stiffness_, kinetic_, static_;
  double side_ = 0;      // 0: it sticks; +-1: it slips that way
  bool pulled_ = false;  // it slips without load, until the surface presses
  Real anchor_m_{};
  Real lost_j_{};  // of the last time it came loose
};

}  // namespace

template <typename Real>
FrictionLawPtr<Real> make_tangential_spring(const Real& stiffness_n_per_m,
                                            const Real& friction_kinetic,
                                            const Real& friction_static) {
  return std::make_unique<TangentialSpring<Real>>(stiffness_n_per_m, friction_kinetic,
                                                  friction_static);
}

template FrictionLawPtr<double> make_tangential_spring(const double&, const double&, const double&);
template FrictionLawPtr<Sensitive> make_tangential_spring(const Sensitive&, const Sensitive&,
                                                          const Sensitive&);

}  // namespace impactdic::sim::contact
