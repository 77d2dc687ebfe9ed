// Partial slip with friction memory: Maw, Barber and Fawcett (1976), by the method of
// dimensionality reduction (Popov and Hess 2015).
//
// Independent springs stand at |x| <= a = sqrt(R D). With xi = x^2/R, a spring is pressed by
// u_z = D - xi, dragged by the contact point, and clipped to |u| <= alpha (D - xi) with
// alpha = mu E*/G*. Hence F_n = E* int u_z dx and F_t = -G* int u dx.
//
// Without a damper D is the deflection delta of a Hertz contact. Under another normal law it is the
// depth of the Hertz contact that carries the spring's force, k D^1.5 = P (Mindlin and Deresiewicz
// 1953 for any history of the load). A damper is to share in friction: gross slip obeys
// F_t = mu P, with P the whole normal force.
//  - While it pushes (compression), its force is spread as the springs' is, and where the contact
//    slips it adds its own friction. It holds nothing where the contact sticks.
//  - While it pulls (damped restitution), it takes load off the springs: D is then the depth of the
//    Hertz contact that carries P, k D^1.5 = P, and the contact shrinks to nothing as P does.
//
// All stuck springs move at the rate v of the contact point and all slipping ones at +-alpha D',
// whatever their place. So the profile is known exactly at any time without following springs: an
// inner stuck part u = s + g(xi), where s is the way of the contact point and g the memory
// (slip_memory.h), and an outer annulus at one of the bounds. The other bound cannot cut into the
// stuck part, because g is nowhere steeper than alpha; but a contact that shrinks faster than its
// stuck part loses the annulus, and then the other bound takes hold at the rim. Only the places
// where the mode changes are events.
#include <algorithm>
#include <cmath>

#include "sim/contact/law/friction_law.h"
#include "sim/contact/law/slip_memory.h"

namespace impactdic::sim::contact {

namespace {

template <typename Real>
class MawBarberFawcett final : public FrictionLawOf<Real> {
 public:
  using ContactPoint = ContactPointOf<Real>;
  using Traction = TractionOf<Real>;
  using Guards = typename FrictionLawOf<Real>::Guards;
  using Memory = SlipMemory<Real>;
  using Stuck = typename Memory::Stuck;

  MawBarberFawcett(const ImpactJob& job, const JobNumbers<Real>& numbers,
                   const Real& hertz_stiffness, bool hertz_spring)
      : radius_(numbers.contact_radius_m()),
        friction_(numbers.contact.friction_kinetic),
        stiffness_(hertz_stiffness),
        hertz_spring_(hertz_spring),
        damped_restitution_(job.contact.restitution_damping != RestitutionDamping::kNone),
        shear_modulus_(0.75 * hertz_stiffness / sqrt(radius_) * 2.0 *
                       (1.0 - numbers.contact.poisson) / (2.0 - numbers.contact.poisson)),
        alpha_(friction_ * (2.0 - numbers.contact.poisson) /
               (2.0 * (1.0 - numbers.contact.poisson))),
        memory_(radius_) {}

  void begin(const ContactPoint& at, In<Real> time_s) override {
    memory_.clear();
    time_s_ = time_s;
    if (abs(at.tip_vt_m_s) <= alpha_ * at.rate_m_s) {
      start_sticking(at, Real(0));
    } else {
      start_slip(at.tip_vt_m_s >= 0 ? 1 : -1, at);
    }
  }

  Traction traction(const ContactPoint& at) const override {
    Traction result;
    const Depth depth = depth_of(at);
    if (side_ == 0) {
      result.force_n = sticking_force(at);
      result.springs_rate_m2_s = at.tip_vt_m_s * half_width(depth.value);
      return result;
    }
    const Real damper = damper_friction(at);
    if (!(depth.value > 0)) {
      if (!gross_) return result;
      result.force_n = -side_ * damper;
      result.dissipation_w = side_ * damper * at.tip_vt_m_s;
      return result;
    }
    const SlipEdge<Real> edge = edge_at(at, depth.value);
    const Stuck stuck = stuck_at(edge);
    const Real springs = -2.0 * shear_modulus_ * slipping_sum(edge, stuck);
    if (holding_) {
      result.force_n = holding_force(at);
      result.dissipation_w = (springs - result.force_n) * at.tip_vt_m_s;
      return result;
    }
    const Real slipping = pressed(depth.value, stuck.xi);
    const Real share = slipping / pressed(depth.value, Real(0));
    result.force_n = springs - side_ * damper * share;
    result.dissipation_w =
        2.0 * shear_modulus_ * alpha_ * (side_ * at.tip_vt_m_s - alpha_ * depth.rate) * slipping +
        side_ * at.tip_vt_m_s * damper * share;
    return result;
  }

  int guards(const ContactPoint& at, Guards& values) const override {
    const Depth depth = depth_of(at);
    values.fill(Real(1));
    const int count = side_ == 0 || holding_ ? 2 : (gross_ ? 1 : 3);
    if (at.normal_n <= 0 && carries_all(at)) return count;  // the surface pulls
    if (side_ == 0) {
      values[0] = alpha_ * depth.rate - at.tip_vt_m_s;
      values[1] = alpha_ * depth.rate + at.tip_vt_m_s;
    } else if (holding_) {
      const Real held = held_by_damper(at, depth);
      values[0] = damper_friction(at) * share_at_rest(at, depth) - held;
      values[1] = held;
    } else {
      values[0] = side_ * at.tip_vt_m_s - alpha_ * depth.rate;
      if (gross_) return count;
      const SlipEdge<Real> edge = edge_at(at, depth.value);
      values[1] = -Memory::excess_at_corner(corner_, edge);
      values[2] = memory_.excess_at_rim(edge) + rim_tolerance_;
    }
    return count;
  }

  void cross(int guard, const ContactPoint& at) override {
    if (side_ == 0) {
      start_slip(guard == 0 ? 1 : -1, at);
    } else if (holding_) {
      holding_ = false;
      if (guard == 1) freeze(at);
    } else if (guard == 1) {
      next_corner(at);
    } else if (guard == 2) {
      // The annulus is gone; the other bound takes hold.
      memory_.follow(edge_at(at, depth_of(at).value));
      start_slip(-side_, at);
    } else {
      come_to_rest(at);
    }
  }

  bool asks_force_rate() const override { return !hertz_spring_ || damped_restitution_; }

  // Only the rate of the normal force jumps.
  void jump(const ContactPoint&, const ContactPoint& after) override {
    if (side_ != 0) return;
    memory_.break_trail();
    recorded_ = trail_point(after, time_s_);
  }

  const char* mode() const override {
    if (side_ == 0 || holding_) return "sticking";
    return gross_ ? "gross_slip" : "partial_slip";
  }

  void step(const ContactPoint& at, In<Real> time_s) override {
    time_s_ = time_s;
    if (side_ != 0) return;
    const TrailPoint<Real> point = trail_point(at, time_s);
    if (point.depth_m > recorded_.depth_m) memory_.append_trail(recorded_, point);
    recorded_ = point;
  }

  Real stored_j(const ContactPoint& at, In<Real> time_s) const override {
    const Real depth = depth_of(at).value;
    if (!(depth > 0)) return Real(0);
    if (side_ == 0) {
      Real sum = memory_.square_sum(at.tip_m);
      const TrailPoint<Real> point = trail_point(at, time_s);
      if (point.depth_m > recorded_.depth_m) sum += memory_.square_sum_of_trail(recorded_, point);
      return shear_modulus_ * sum;
    }
    const SlipEdge<Real> edge = edge_at(at, depth);
    const Real stuck = stuck_at(edge).xi;
    return shear_modulus_ * ((gross_ ? Real(0) : memory_.square_sum_to(edge)) +
                             alpha_ * alpha_ * pressed_squares(depth, stuck));
  }

 private:
  struct Depth {
    Real value{}, rate{}, acceleration{};
  };

  // Whether D is that of the whole normal force.
  static bool carries_all(const ContactPoint& at) {
    return !at.compressing && at.damping_n_s_per_m > 0;
  }

  // D and its derivatives.
  Depth depth_of(const ContactPoint& at) const {
    if (carries_all(at)) {
      return depth_under(at.normal_n, at.normal_rate_n_s, at.normal_turn_n_s2);
    }
    // Any law begins as Hertz's.
    if (hertz_spring_ || !(at.deflection_m > 0)) {
      return {at.deflection_m, at.rate_m_s, at.acceleration_m_s2};
    }
    return depth_under(at.spring_n, at.spring_rate_n_s, at.spring_turn_n_s2);
  }

  Depth depth_under(Real force, Real force_rate, Real force_turn) const {
    if (!(force > 0)) return {};
    const Real pressed = force / stiffness_, growth = force_rate / force;
    Depth depth;
    depth.value = cbrt(pressed * pressed);
    depth.rate = 2.0 / 3.0 * depth.value * growth;
    depth.acceleration =
        2.0 / 3.0 * (depth.rate * growth + depth.value * (force_turn / force - growth * growth));
    return depth;
  }

  SlipEdge<Real> edge_at(const ContactPoint& at, Real depth) const {
    return {side_, alpha_, depth, at.tip_m};
  }

  // What the damper's pressure adds to friction where all of the contact slips, N.
  Real damper_friction(const ContactPoint& at) const {
    return at.compressing ? friction_ * at.damping_n_s_per_m * at.rate_m_s : Real(0);
  }

  // The force that keeps an annulus at rest on a bound that moves: v = side alpha delta'.
  Real holding_force(const ContactPoint& at) const {
    return at.rolling_n() + side_ * alpha_ * at.acceleration_m_s2 / at.mobility_per_kg;
  }

  // The part of it that the springs do not give.
  Real held_by_damper(const ContactPoint& at, const Depth& depth) const {
    const SlipEdge<Real> edge = edge_at(at, depth.value);
    const Real springs = -2.0 * shear_modulus_ * slipping_sum(edge, stuck_at(edge));
    return side_ * (springs - holding_force(at));
  }

  Real share_at_rest(const ContactPoint& at, const Depth& depth) const {
    if (gross_) return Real(1);
    const Real stuck = stuck_at(edge_at(at, depth.value)).xi;
    return pressed(depth.value, stuck) / pressed(depth.value, Real(0));
  }

  // The slip of the annulus has ended. A damper that pushes loses its friction there; where the
  // springs alone would let the annulus slip again, it holds it (the Filippov solution).
  void come_to_rest(const ContactPoint& at) {
    const Depth depth = depth_of(at);
    if (at.compressing && depth.rate > 0 && depth.value > 0 && damper_friction(at) > 0) {
      const Real held = held_by_damper(at, depth);
      if (held > 0 && held < damper_friction(at) * share_at_rest(at, depth)) {
        holding_ = true;
        return;
      }
    }
    freeze(at);
  }

  // What has come to rest becomes memory. While the contact still grows all springs stick; while it
  // shrinks the opposite bound catches the outermost ones at once.
  void freeze(const ContactPoint& at) {
    const Depth depth = depth_of(at);
    const SlipEdge<Real> edge = edge_at(at, depth.value);
    const Real sum = slipping_sum(edge, stuck_at(edge));
    if (gross_) memory_.clear();
    memory_.follow(edge);
    if (depth.rate > 0) {
      start_sticking(at, sum);
    } else {
      start_slip(-side_, at);
    }
  }

  Real half_width(Real depth) const { return root(radius_ * at_least(depth, 0)); }

  // int (D - x^2/R) dx over the annulus outside xi = stuck.
  Real pressed(Real depth, Real stuck) const {
    return 2.0 / 3.0 * half_width(depth) * depth - half_width(stuck) * (depth - stuck / 3.0);
  }

  // int (D - x^2/R)^2 dx over the annulus outside xi = stuck.
  Real pressed_squares(Real depth, Real stuck) const {
    return 8.0 / 15.0 * half_width(depth) * depth * depth -
           half_width(stuck) * (depth * depth - 2.0 / 3.0 * depth * stuck + stuck * stuck / 5.0);
  }

  // int u dx while all springs stick: its rate is v a, since the outermost are at u = 0.
  Real sticking_force(const ContactPoint& at) const {
    return -2.0 * shear_modulus_ * (sticking_sum_ + at.springs_m2);
  }

  Stuck stuck_at(const SlipEdge<Real>& edge) const {
    return gross_ ? Stuck{} : memory_.stuck(edge);
  }

  // int u dx with an annulus outside the springs that stick.
  Real slipping_sum(const SlipEdge<Real>& edge, const Stuck& stuck) const {
    return edge.side * alpha_ * pressed(edge.depth_m, stuck.xi) +
           edge.way_m * half_width(stuck.xi) + stuck.sum;
  }

  TrailPoint<Real> trail_point(const ContactPoint& at, In<Real> time_s) const {
    const Depth depth = depth_of(at);
    return {time_s,
            depth.value,
            depth.rate,
            depth.acceleration,
            at.tip_m,
            at.tip_vt_m_s,
            at.mobility_per_kg * sticking_force(at) - at.drift_m_s2};
  }

  // `sum` is int u dx at this moment.
  void start_sticking(const ContactPoint& at, Real sum) {
    side_ = 0;
    holding_ = false;
    sticking_sum_ = sum - at.springs_m2;
    recorded_ = trail_point(at, time_s_);
  }

  void start_slip(double side, const ContactPoint& at) {
    side_ = side;
    holding_ = false;
    gross_ = memory_.empty();
    // Where nothing slips at all neither bound is the right one: rounding must not decide.
    rim_tolerance_ = 1e-13 * alpha_ * depth_of(at).value;
    if (!gross_) corner_ = memory_.corner_below(memory_.end());
  }

  // The annulus has reached a corner of the memory. A part of it that lies along the bound is taken
  // in one stroke.
  void next_corner(const ContactPoint& at) {
    const SlipEdge<Real> edge = edge_at(at, depth_of(at).value);
    const Real along_bound = 1e-10 * alpha_ * edge.depth_m;
    while (corner_.xi > 0) {
      corner_ = memory_.corner_below(corner_.xi);
      if (Memory::excess_at_corner(corner_, edge) < -along_bound) return;
    }
    gross_ = true;
  }

  Real radius_, friction_, stiffness_;
  bool hertz_spring_, damped_restitution_;
  Real shear_modulus_, alpha_;
  Memory memory_;
  TrailPoint<Real> recorded_;       // where the record of a sticking loading has come to
  Real time_s_{};                   // of the last accepted step
  double side_ = 0;                 // 0: all springs stick; +-1: an annulus slips at that bound
  bool holding_ = false;            // the annulus rests on its bound, held by the damper's friction
  bool gross_ = false;              // the annulus covers everything
  Real sticking_sum_{};             // int u dx less ContactPoint::springs_m2
  Real rim_tolerance_{};            // of guard 2
  typename Memory::Corner corner_;  // the next one that the annulus's inner edge will reach
};

}  // namespace

template <typename Real>
FrictionLawPtr<Real> make_maw_barber_fawcett(const ImpactJob& job, const JobNumbers<Real>& numbers,
                                             const Real& hertz_stiffness, bool hertz_spring) {
  return std::make_unique<MawBarberFawcett<Real>>(job, numbers, hertz_stiffness, hertz_spring);
}

template FrictionLawPtr<double> make_maw_barber_fawcett(const ImpactJob&, const JobNumbers<double>&,
                                                        const double&, bool);
template FrictionLawPtr<Sensitive> make_maw_barber_fawcett(const ImpactJob&,
                                                           const JobNumbers<Sensitive>&,
                                                           const Sensitive&, bool);

}  // namespace impactdic::sim::contact
