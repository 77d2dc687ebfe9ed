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

double sign(double value) { return (value > 0) - (value < 0); }

class DryFriction final : public FrictionLaw {
 public:
  struct Load {
    bool spring_only = false;  // friction follows the spring's force, not the damper's
    double scale = 1;
  };

  DryFriction(Rule rule, ModelPreset preset, const ContactParameters& contact, Load load)
      : rule_(rule),
        published_(preset == ModelPreset::kPublished),
        kinetic_(contact.friction_kinetic),
        static_(std::max(contact.friction_static, contact.friction_kinetic)),
        fading_speed_(contact.friction_speed_m_s),
        load_(load) {}

  void begin(const ContactPoint& at, double) override {
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
    double force = 0;
    switch (mode_) {
      case Mode::kFrictionless:
      case Mode::kFreeRolling:
        break;
      case Mode::kFrozen:
        return {0, -at.holding_n * at.centre_vt_m_s, 0, at.holding_n};
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
    return {force, -force * at.tip_vt_m_s, 0, 0};
  }

  int guards(const ContactPoint& at, Guards& values) const override {
    switch (mode_) {
      case Mode::kSliding:
        values[0] = at.tip_vt_m_s * direction_;
        return 1;
      case Mode::kRolling:
        // Where rolling takes no force nothing ends it, not even a contact without load.
        values[0] = at.rolling_n() == 0 ? 1.0 : static_ * load(at) - std::abs(at.rolling_n());
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
  double load(const ContactPoint& at) const {
    return load_.scale * (load_.spring_only ? at.spring_n : at.normal_n);
  }

  // Oden and Martins 1985 among others: from the static to the kinetic coefficient, the faster it
  // slips.
  double sliding(const ContactPoint& at) const {
    if (rule_ != Rule::kFading) return kinetic_;
    return kinetic_ + (static_ - kinetic_) * std::exp(-std::abs(at.tip_vt_m_s) / fading_speed_);
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
    if (std::abs(at.rolling_n()) <= static_ * load(at)) {
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
  double kinetic_, static_;
  double fading_speed_;
  Load load_;
  Mode mode_ = Mode::kSliding;
  double direction_ = 1;  // of the slip; while sticking, of the centre
  double critical_n_ = 0;
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
std::unique_ptr<FrictionLaw> make_elastic_friction(const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  if (!slips_partially(job.friction)) {
    const bool grips = job.friction == FrictionModel::kGripSlip;
    return make_tangential_spring(contact.tangential_stiffness_n_per_m, contact.friction_kinetic,
                                  grips ? contact.friction_static : 0);
  }
  const double radius = job.contact_radius_m();
  if (has_hertz_spring(job.normal)) {
    return make_maw_barber_fawcett(contact, contact.stiffness, true, radius);
  }
  if (stiffness_key(job.normal).empty()) {
    return make_maw_barber_fawcett(contact, hertz_stiffness(contact.reduced_modulus_pa, radius),
                                   false, radius);
  }
  // The contact of a linear spring does not grow: it sticks or slips as a whole.
  const double ratio = 2 * (1 - contact.poisson) / (2 - contact.poisson);
  return make_tangential_spring(ratio * contact.stiffness, contact.friction_kinetic, 0);
}

}  // namespace

std::unique_ptr<FrictionLaw> make_friction_law(const ImpactJob& job, double speed_t_m_s,
                                               double speed_n_m_s) {
  if (remembers_slip(job.friction)) return make_elastic_friction(job);
  // The printed figures of chapter 4 follow only if friction takes the spring's force alone, scaled
  // by the sine of the angle of incidence.
  DryFriction::Load load;
  const bool chapter4 = job.friction == FrictionModel::kThreePhase ||
                        job.friction == FrictionModel::kFullSliding ||
                        job.friction == FrictionModel::kBrody;
  if (job.preset == ModelPreset::kPublished && chapter4) {
    load.spring_only = true;
    load.scale = std::abs(speed_t_m_s) / std::hypot(speed_t_m_s, speed_n_m_s);
  }
  ContactParameters contact = job.contact;
  const bool two_limits =
      job.friction == FrictionModel::kThreePhase || job.friction == FrictionModel::kSpeedDependent;
  if (!two_limits) contact.friction_static = 0;
  return std::make_unique<DryFriction>(rule_of(job), job.preset, contact, load);
}

}  // namespace impactdic::sim::contact
