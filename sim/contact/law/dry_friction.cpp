// Dry friction without tangential compliance: Coulomb with rolling, with a coefficient that falls
// with the speed, the source's three phases, full sliding, Brody.
#include <algorithm>
#include <cmath>

#include "sim/contact/law/friction_law.h"

namespace impactdic::sim::contact {

namespace {

enum class Rule { kFrictionless, kCoulomb, kThreePhases, kFullSliding, kBrody, kFading };
enum class Mode {
  kFrictionless,
  kSliding,
  kReversed,     // full sliding: the contact point has turned, the force has not
  kRolling,      // the contact point rests, held by what friction that takes
  kFreeRolling,  // Brody: no tangential force
  kFrozen,       // Brody as published: neither velocity changes
  kSticking,     // published three phases, Eq. 4.11
  kHeld          // the same, with the centre at rest
};

template <typename Real>
double sign(const Real& value) {
  return (value > 0) - (value < 0);
}

template <typename Real>
class DryFriction final : public FrictionLawOf<Real> {
 public:
  using ContactPoint = ContactPointOf<Real>;
  using Traction = TractionOf<Real>;
  using Guards = typename FrictionLawOf<Real>::Guards;

  struct Load {
    bool spring_only = false;  // friction follows the spring's force, not the damper's
    Real scale{1};
  };

  DryFriction(Rule rule, ModelPreset preset, const ContactNumbers<Real>& contact, const Load& load)
      : rule_(rule),
        published_(preset == ModelPreset::kPublished),
        kinetic_(contact.friction_kinetic),
        static_(std::max(contact.friction_static, contact.friction_kinetic)),
        fading_speed_(contact.friction_speed_m_s),
        load_(load) {}

  void begin(const ContactPoint& at, In<Real>) override {
    stuck_before_ = false;
    if (rule_ == Rule::kFrictionless) {
      mode_ = Mode::kFrictionless;
    } else if (at.tip_vt_m_s != 0) {
      slide(sign(at.tip_vt_m_s));
    } else if (rule_ == Rule::kFullSliding) {
      slide(-sign(at.rolling_n()));  // as the weight would drive it
      if (direction_ == 0) mode_ = Mode::kFrictionless;
    } else if (rule_ == Rule::kBrody) {
      roll_freely();
    } else {
      roll_or_slide(at);
    }
  }

  Traction traction(const ContactPoint& at) const override {
    Real force{};
    switch (mode_) {
      case Mode::kFrictionless:
      case Mode::kFreeRolling:
        break;
      case Mode::kFrozen:
        return {Real(0), -at.holding_n * at.centre_vt_m_s, Real(0), at.holding_n};
      case Mode::kSliding:
      case Mode::kReversed:
        force = -sliding(at) * load(at) * direction_;
        break;
      case Mode::kRolling:
        force = at.rolling_n();
        break;
      case Mode::kSticking:
        force = -static_ * load(at) * direction_;
        break;
      case Mode::kHeld:
        force = at.holding_n;
        break;
    }
    return {force, -force * at.tip_vt_m_s, Real(0), Real(0)};
  }

  int guards(const ContactPoint& at, Guards& values) const override {
    switch (mode_) {
      case Mode::kSliding:
        values[0] = at.tip_vt_m_s * direction_;
        return 1;
      case Mode::kRolling:
        // Where rolling takes no force nothing ends it, not even a contact without load.
        values[0] = at.rolling_n() == 0 ? Real(1) : Real(static_ * load(at) - abs(at.rolling_n()));
        return 1;
      case Mode::kSticking:
        values[0] = load(at) - critical_n_;
        values[1] = at.centre_vt_m_s * direction_;
        return 2;
      case Mode::kHeld:
        values[0] = load(at) - critical_n_;
        return 1;
      default:
        return 0;
    }
  }

  void cross(int guard, const ContactPoint& at) override {
    switch (mode_) {
      case Mode::kSliding:
        stop_sliding(at);
        break;
      case Mode::kRolling:
        slide(-sign(at.rolling_n()));
        break;
      case Mode::kSticking:
        if (guard == 0) {
          leave_sticking(at);
        } else {
          // Eq. 4.11's sign would chatter once the centre has stopped: its Filippov solution holds
          // the centre, which takes less than the available friction.
          mode_ = Mode::kHeld;
        }
        break;
      case Mode::kHeld:
        leave_sticking(at);
        break;
      default:
        break;
    }
  }

  const char* mode() const override {
    switch (mode_) {
      case Mode::kFrictionless:
        return "frictionless";
      case Mode::kSliding:
        return stuck_before_ ? "post_sliding" : "sliding";
      case Mode::kReversed:
        return "reversed_sliding";
      case Mode::kRolling:
      case Mode::kFreeRolling:
      case Mode::kFrozen:
        return "rolling";
      case Mode::kSticking:
      case Mode::kHeld:
        return "sticking";
    }
    return "";
  }

 private:
  Real load(const ContactPoint& at) const {
    return load_.scale * (load_.spring_only ? at.spring_n : at.normal_n);
  }

  // Oden and Martins 1985 among others: from the static to the kinetic coefficient, the faster it
  // slips.
  Real sliding(const ContactPoint& at) const {
    if (rule_ != Rule::kFading) return kinetic_;
    return kinetic_ + (static_ - kinetic_) * exp(-abs(at.tip_vt_m_s) / fading_speed_);
  }

  void slide(double direction) {
    mode_ = Mode::kSliding;
    direction_ = direction;
  }

  // "There will not be any change in the tangential and angular velocities" (section 4.4): as
  // published, not even by gravity.
  void roll_freely() { mode_ = published_ ? Mode::kFrozen : Mode::kFreeRolling; }

  // The contact point is at rest. It stays so while friction can hold it; otherwise the force that
  // is missing drives it (the Filippov solution of Coulomb's law).
  void roll_or_slide(const ContactPoint& at) {
    if (abs(at.rolling_n()) <= static_ * load(at)) {
      mode_ = Mode::kRolling;
    } else {
      slide(-sign(at.rolling_n()));
    }
  }

  void stop_sliding(const ContactPoint& at) {
    switch (rule_) {
      case Rule::kFullSliding:
        mode_ = Mode::kReversed;  // Eq. 4.12: the force keeps its direction
        break;
      case Rule::kBrody:
        roll_freely();
        break;
      case Rule::kThreePhases:
        critical_n_ = load(at);  // F_c, the normal force when the contact point stops
        // F > F_c can only follow while the force still grows.
        if (!stuck_before_ && at.rate_m_s > 0 && at.centre_vt_m_s != 0) {
          mode_ = Mode::kSticking;
          direction_ = sign(at.centre_vt_m_s);
          stuck_before_ = true;
        } else {
          roll_or_slide(at);
        }
        break;
      default:
        roll_or_slide(at);
    }
  }

  void leave_sticking(const ContactPoint& at) {
    if (at.tip_vt_m_s != 0) {
      slide(sign(at.tip_vt_m_s));
    } else {
      roll_or_slide(at);
    }
  }

  Rule rule_;
  bool published_;
  Real kinetic_, static_;
  Real fading_speed_;
  Load load_;
  Mode mode_ = Mode::kSliding;
  double direction_ = 1;  // of the slip; while sticking, of the centre
  Real critical_n_{};
  bool stuck_before_ = false;  // the sticking phase comes once
};

Rule rule_of(const ImpactJob& job) {
  switch (job.friction) {
    case FrictionModel::kNone:
      return Rule::kFrictionless;
    case FrictionModel::kThreePhase:
      // True sticking is Coulomb's law with a static limit.
      return job.preset == ModelPreset::kPublished ? Rule::kThreePhases : Rule::kCoulomb;
    case FrictionModel::kFullSliding:
      return Rule::kFullSliding;
    case FrictionModel::kBrody:
      return Rule::kBrody;
    case FrictionModel::kSpeedDependent:
      return Rule::kFading;
    default:
      return Rule::kCoulomb;
  }
}

// A contact that gives way along the surface.
template <typename Real>
FrictionLawPtr<Real> make_elastic_friction(const ImpactJob& job, const JobNumbers<Real>& numbers) {
  const ContactNumbers<Real>& contact = numbers.contact;
  if (!slips_partially(job.friction)) {
    const bool grips = job.friction == FrictionModel::kGripSlip;
    return make_tangential_spring(contact.tangential_stiffness_n_per_m, contact.friction_kinetic,
                                  grips ? contact.friction_static : Real(0));
  }
  if (has_hertz_spring(job.normal)) {
    return make_maw_barber_fawcett(job, numbers, contact.stiffness, true);
  }
  if (stiffness_key(job.normal).empty()) {
    const Real hertz = 4.0 / 3.0 * contact.reduced_modulus_pa * sqrt(numbers.contact_radius_m());
    return make_maw_barber_fawcett(job, numbers, hertz, false);
  }
  // The contact of a linear spring does not grow: it sticks or slips as a whole.
  const Real ratio = 2.0 * (1.0 - contact.poisson) / (2.0 - contact.poisson);
  return make_tangential_spring<Real>(ratio * contact.stiffness, contact.friction_kinetic, Real(0));
}

}  // namespace

template <typename Real>
FrictionLawPtr<Real> make_friction_law(const ImpactJob& job, const JobNumbers<Real>& numbers,
                                       const Real& speed_t_m_s, const Real& speed_n_m_s) {
  if (remembers_slip(job.friction)) return make_elastic_friction(job, numbers);
  // The printed figures of chapter 4 follow only if friction takes the spring's force alone, scaled
  // by the sine of the angle of incidence.
  typename DryFriction<Real>::Load load;
  const bool chapter4 = job.friction == FrictionModel::kThreePhase ||
                        job.friction == FrictionModel::kFullSliding ||
                        job.friction == FrictionModel::kBrody;
  if (job.preset == ModelPreset::kPublished && chapter4) {
    load.spring_only = true;
    load.scale = abs(speed_t_m_s) / hypot(speed_t_m_s, speed_n_m_s);
  }
  ContactNumbers<Real> contact = numbers.contact;
  const bool two_limits =
      job.friction == FrictionModel::kThreePhase || job.friction == FrictionModel::kSpeedDependent;
  if (!two_limits) contact.friction_static = Real(0);
  return std::make_unique<DryFriction<Real>>(rule_of(job), job.preset, contact, load);
}

template FrictionLawPtr<double> make_friction_law(const ImpactJob&, const JobNumbers<double>&,
                                                  const double&, const double&);
template FrictionLawPtr<Sensitive> make_friction_law(const ImpactJob&, const JobNumbers<Sensitive>&,
                                                     const Sensitive&, const Sensitive&);

}  // namespace impactdic::sim::contact
