#include "sim/contact/rebound.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/parse.h"
#include "sim/contact/closed_form.h"

namespace impactdic::sim::contact {
namespace {

struct Arm {
  double t, n;
};

// The contact point seen from the mass centre.
Arm arm_of(const ReboundJob& job) {
  if (job.body.shape != BodyShape::kRod) return {0, -job.body.radius_m()};
  const double axis = job.initial.angle_deg * kRadPerDeg, half = job.body.length_m / 2;
  return {-half * std::cos(axis), -half * std::sin(axis) - job.body.radius_m()};
}

ImpactVelocities rebound(const ReboundJob& job, const ImpactVelocities& before) {
  const bool published = job.preset == ModelPreset::kPublished;
  switch (job.model) {
    case ReboundModel::kGarwin:
      if (published) return garwin_rebound(job.body, before);
      return walton_rebound(job.body, before, job.restitution, job.friction_kinetic, 1);
    case ReboundModel::kCross:
      if (published) {
        return cross_rebound(job.body, before, job.restitution, job.tangential_restitution);
      }
      return walton_rebound(job.body, before, job.restitution, job.friction_kinetic,
                            job.tangential_restitution);
    case ReboundModel::kWalton:
      return walton_rebound(job.body, before, job.restitution, job.friction_kinetic,
                            job.tangential_restitution);
    case ReboundModel::kStronge: {
      const Arm arm = arm_of(job);
      return stronge_rebound(job.body, arm.t, arm.n, before, job.restitution, job.friction_kinetic);
    }
  }
  return before;
}

}  // namespace

ReboundResult simulate_rebound(const ReboundJob& job) {
  job.validate();
  ReboundResult result;
  result.before = {job.initial.vt_m_s, job.initial.vn_m_s, job.initial.omega_rad_s};
  result.after = rebound(job, result.before);
  const double arm = arm_of(job).t;
  const auto tip_vn = [arm](const ImpactVelocities& v) { return v.vn_m_s + v.omega_rad_s * arm; };
  result.restitution = -tip_vn(result.after) / tip_vn(result.before);
  const auto kinetic = [&job](const ImpactVelocities& v) {
    return 0.5 * job.body.mass_kg * (v.vt_m_s * v.vt_m_s + v.vn_m_s * v.vn_m_s) +
           0.5 * job.body.inertia() * v.omega_rad_s * v.omega_rad_s;
  };
  result.kinetic_before_j = kinetic(result.before);
  result.kinetic_after_j = kinetic(result.after);
  const double gain = result.kinetic_after_j - result.kinetic_before_j;
  if (gain > 1e-12 * result.kinetic_before_j) {
    result.warnings.push_back("the rule creates " + shortest(gain) + " J");
  }
  return result;
}

}  // namespace impactdic::sim::contact

namespace impactdic {
namespace {

constexpr std::array<std::pair<ReboundModel, std::string_view>, 4> kNames{
    {{ReboundModel::kGarwin, "garwin"},
     {ReboundModel::kCross, "cross"},
     {ReboundModel::kWalton, "walton"},
     {ReboundModel::kStronge, "stronge"}}};

}  // namespace

std::string_view name_of(ReboundModel model) {
  for (const auto& [value, name] : kNames) {
    if (value == model) return name;
  }
  return "";
}

bool is_rebound_model(std::string_view name) {
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](const auto& entry) { return entry.second == name; });
}

ReboundModel parse_rebound_model(std::string_view name) {
  for (const auto& [value, text] : kNames) {
    if (text == name) return value;
  }
  throw InvalidArgument("'" + std::string(name) + "' is not known", "model",
                        "one of garwin, cross, walton, stronge");
}

void ReboundJob::validate() const {
  body.validate();
  const auto require = [](bool good, const char* what, const char* key,
                          const std::string& hint = "") {
    if (!good) throw InvalidArgument(what, key, hint);
  };
  require(restitution >= 0 && restitution <= 1, "must be from 0 to 1", "contact.restitution");
  require(tangential_restitution >= -1 && tangential_restitution <= 1, "must be from -1 to 1",
          "contact.tangential_restitution");
  require(friction_kinetic >= 0 && std::isfinite(friction_kinetic), "must not be negative",
          "contact.friction_kinetic");
  const bool rod = body.shape == BodyShape::kRod;
  require(!rod || model == ReboundModel::kStronge, "only stronge knows rods", "body.shape");
  require(!rod || (initial.angle_deg > 0 && initial.angle_deg < 180),
          "the striking end must be the lower one: between 0 and 180", "initial.angle_deg");
  require(initial.vn_m_s + initial.omega_rad_s * sim::contact::arm_of(*this).t < 0,
          "the body does not approach the surface", "initial.vn_m_s",
          "the normal points out of the surface: vn_m_s must be negative");
}

}  // namespace impactdic
