#include <impactdic/error.h>
#include <impactdic/models/sweep.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace impactdic {
namespace {

constexpr std::size_t kMostShots = 1'000'000;

// One shot's motion before, of whichever model, as the axes change it.
struct Motion {
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;

  double speed() const { return std::hypot(vt_m_s, vn_m_s); }
  double incidence() const { return std::atan2(vt_m_s, -vn_m_s); }
  void set(double speed, double incidence) {
    vt_m_s = speed * std::sin(incidence);
    vn_m_s = -speed * std::cos(incidence);
  }
};

Motion motion_of(const SweepModel& model) {
  return std::visit(
      [](const auto& job) -> Motion {
        if constexpr (requires { job.rod; }) {
          return {job.rod.vt_m_s, job.rod.vn_m_s, job.rod.omega_rad_s};
        } else {
          return {job.initial.vt_m_s, job.initial.vn_m_s, job.initial.omega_rad_s};
        }
      },
      model);
}

void set_motion(SweepModel& model, const Motion& motion) {
  const auto into = [&](auto& job) {
    job.vt_m_s = motion.vt_m_s, job.vn_m_s = motion.vn_m_s, job.omega_rad_s = motion.omega_rad_s;
  };
  std::visit(
      [&](auto& job) {
        if constexpr (requires { job.rod; }) {
          into(job.rod);
        } else {
          into(job.initial);
        }
      },
      model);
}

double radius_of(const SweepModel& model) {
  return std::visit(
      [](const auto& job) {
        if constexpr (requires { job.rod; }) {
          return job.rod.body.radius_m;
        } else {
          return job.body.radius_m();
        }
      },
      model);
}

bool is_elastic_plastic(NormalModel law) {
  return law == NormalModel::kJacksonGreen || law == NormalModel::kKogutEtsion ||
         law == NormalModel::kThornton || law == NormalModel::kStronge;
}

double* damping_of(ImpactJob& job) {
  switch (job.normal) {
    case NormalModel::kTsuji:
      return &job.contact.damping_factor;
    case NormalModel::kKuwabaraKono:
      return &job.contact.dissipation_s;
    case NormalModel::kHuntCrossley:
      return &job.contact.damping_s_per_m;
    default:
      return damping_key(job.normal).empty() ? nullptr : &job.contact.damping_n_s_per_m;
  }
}

// Where the model keeps a constant; nullptr where it has none.
double* place_of(ImpactJob& job, SweepAxis axis) {
  ContactParameters& c = job.contact;
  switch (axis) {
    case SweepAxis::kStiffness:
      return stiffness_key(job.normal).empty() ? nullptr : &c.stiffness;
    case SweepAxis::kDamping:
      return damping_of(job);
    case SweepAxis::kFrictionKinetic:
      return job.friction == FrictionModel::kNone ? nullptr : &c.friction_kinetic;
    case SweepAxis::kFrictionStatic:
      return job.friction == FrictionModel::kThreePhase ||
                     job.friction == FrictionModel::kGripSlip ||
                     job.friction == FrictionModel::kSpeedDependent
                 ? &c.friction_static
                 : nullptr;
    case SweepAxis::kPoisson:
      return slips_partially(job.friction) || is_elastic_plastic(job.normal) ? &c.poisson : nullptr;
    case SweepAxis::kYieldStrength:
      return is_elastic_plastic(job.normal) ? &c.yield_strength_pa : nullptr;
    case SweepAxis::kSurfaceAngle:
      return &job.surface_angle_deg;
    case SweepAxis::kRodAngle:
      return job.body.shape == BodyShape::kRod ? &job.initial.angle_deg : nullptr;
    default:
      return nullptr;
  }
}

double* place_of(ReboundJob& job, SweepAxis axis) {
  switch (axis) {
    case SweepAxis::kFrictionKinetic:
      return &job.friction_kinetic;
    case SweepAxis::kRestitution:
      return &job.restitution;
    case SweepAxis::kTangentialRestitution:
      return job.model == ReboundModel::kCross || job.model == ReboundModel::kWalton
                 ? &job.tangential_restitution
                 : nullptr;
    case SweepAxis::kRodAngle:
      return job.body.shape == BodyShape::kRod ? &job.initial.angle_deg : nullptr;
    default:
      return nullptr;
  }
}

double* place_of(RodModel& job, SweepAxis axis) {
  switch (axis) {
    case SweepAxis::kFrictionKinetic:
      return &job.rod.friction_kinetic;
    case SweepAxis::kPoisson:
      return &job.rod.surface.poisson;
    case SweepAxis::kYieldStrength:
      return &job.rod.surface.yield_strength_pa;
    default:
      return nullptr;
  }
}

bool is_motion(SweepAxis axis) {
  return axis == SweepAxis::kSpeed || axis == SweepAxis::kIncidence || axis == SweepAxis::kSpin ||
         axis == SweepAxis::kSpinRatio;
}

constexpr std::array<std::pair<SweepAxis, const char*>, 15> kKeys{
    {{SweepAxis::kSpeed, "speed_m_s"},
     {SweepAxis::kIncidence, "incidence_deg"},
     {SweepAxis::kDropAngle, "drop_angle_deg"},
     {SweepAxis::kSurfaceAngle, "surface_angle_deg"},
     {SweepAxis::kRodAngle, "rod_angle_deg"},
     {SweepAxis::kSpin, "omega_rad_s"},
     {SweepAxis::kSpinRatio, "spin_ratio"},
     {SweepAxis::kStiffness, "stiffness_n_per_m"},
     {SweepAxis::kDamping, "damping_n_s_per_m"},
     {SweepAxis::kFrictionKinetic, "friction_kinetic"},
     {SweepAxis::kFrictionStatic, "friction_static"},
     {SweepAxis::kPoisson, "poisson"},
     {SweepAxis::kYieldStrength, "yield_strength_pa"},
     {SweepAxis::kRestitution, "restitution"},
     {SweepAxis::kTangentialRestitution, "tangential_restitution"}}};

// The motion first: a drop's direction needs its speed, and a spin ratio both.
void set_axis(SweepModel& model, SweepAxis axis, double value) {
  Motion motion = motion_of(model);
  switch (axis) {
    case SweepAxis::kSpeed:
      motion.set(value, motion.incidence());
      break;
    case SweepAxis::kIncidence:
      motion.set(motion.speed(), value * kRadPerDeg);
      break;
    case SweepAxis::kDropAngle:
      // Downhill is -t where the surface rises towards t.
      motion.set(motion.speed(), -value * kRadPerDeg);
      std::get<ImpactJob>(model).surface_angle_deg = value;
      break;
    case SweepAxis::kSpin:
      motion.omega_rad_s = value;
      break;
    case SweepAxis::kSpinRatio:
      motion.omega_rad_s = value * motion.speed() / radius_of(model);
      break;
    case SweepAxis::kRodAngle:
      if (auto* rod = std::get_if<RodModel>(&model)) {
        rod->rod.angle_rad = value * kRadPerDeg;
        return;
      }
      [[fallthrough]];
    default:
      *std::visit([&](auto& job) { return place_of(job, axis); }, model) = value;
      return;
  }
  set_motion(model, motion);
}

}  // namespace

std::string key_of(SweepAxis axis, const SweepModel& model) {
  const auto* impact = std::get_if<ImpactJob>(&model);
  if (impact && axis == SweepAxis::kStiffness && !stiffness_key(impact->normal).empty()) {
    return std::string(stiffness_key(impact->normal));
  }
  if (impact && axis == SweepAxis::kDamping && !damping_key(impact->normal).empty()) {
    return std::string(damping_key(impact->normal));
  }
  for (const auto& [known, key] : kKeys) {
    if (known == axis) return key;
  }
  return "";
}

bool has_axis(const SweepModel& model, SweepAxis axis) {
  if (is_motion(axis)) return true;
  if (axis == SweepAxis::kDropAngle) return std::holds_alternative<ImpactJob>(model);
  if (axis == SweepAxis::kRodAngle && std::holds_alternative<RodModel>(model)) return true;
  SweepModel probe = model;
  return std::visit([&](auto& job) { return place_of(job, axis); }, probe) != nullptr;
}

std::size_t SweepRequest::size() const {
  std::size_t count = axes.empty() ? 0 : 1;
  for (const SweepValues& axis : axes) {
    if (axis.values.empty()) return 0;
    // Saturates: a product that wraps around could pass for a small one.
    count = count > kMostShots ? count : count * axis.values.size();
  }
  return count;
}

std::vector<double> SweepRequest::values_of(std::size_t index) const {
  std::vector<double> values(axes.size());
  for (std::size_t i = axes.size(); i-- > 0;) {
    const std::size_t length = axes[i].values.size();
    values[i] = axes[i].values[index % length];
    index /= length;
  }
  return values;
}

SweepModel SweepRequest::shot(std::size_t index) const {
  SweepModel made = model;
  const std::vector<double> values = values_of(index);
  for (const auto& [axis, key] : kKeys) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (axes[i].axis == axis) set_axis(made, axis, values[i]);
    }
  }
  return made;
}

void SweepRequest::validate() const {
  const auto require = [](bool good, const char* what, const std::string& key,
                          const char* hint = "") {
    if (!good) throw InvalidArgument(what, key, hint);
  };
  require(!axes.empty(), "nothing is swept", "sweep", "such as speed_m_s = [1.0, 2.0, 3.0]");
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string key = "sweep." + key_of(axes[i].axis, model);
    require(has_axis(model, axes[i].axis), "the model has no such quantity", key);
    require(!axes[i].values.empty(), "has no values", key);
    require(std::all_of(axes[i].values.begin(), axes[i].values.end(),
                        [](double v) { return std::isfinite(v); }),
            "must be finite numbers", key);
    for (std::size_t j = 0; j < i; ++j) {
      const auto both = [&](SweepAxis a, SweepAxis b) {
        return (axes[i].axis == a && axes[j].axis == b) || (axes[i].axis == b && axes[j].axis == a);
      };
      require(axes[i].axis != axes[j].axis, "stands twice", key);
      require(!both(SweepAxis::kSpin, SweepAxis::kSpinRatio), "the spin is swept twice", key);
      require(!both(SweepAxis::kDropAngle, SweepAxis::kSurfaceAngle) &&
                  !both(SweepAxis::kDropAngle, SweepAxis::kIncidence),
              "the drop's angle says it already", key);
    }
  }
  require(size() <= kMostShots, "more than a million shots", "sweep");
  require(threads >= 0, "must not be negative", "threads");
}

}  // namespace impactdic
