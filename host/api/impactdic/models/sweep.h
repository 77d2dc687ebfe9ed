// Many impacts of one model: every combination of speeds, angles, spins and constants.
//
// Axes and signs are those of impact_model.h. The motion before is written as a speed and an
// incidence where these are swept: vt = v sin(incidence), vn = -v cos(incidence), so that 0 degrees
// is along the normal.
#pragma once

#include <impactdic/control.h>
#include <impactdic/export.h>
#include <impactdic/impact_model.h>
#include <impactdic/rod_model.h>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// What varies. The first group is the motion before, the second the constants of the laws. What
// depends on another one is set after it, whatever their order in the request.
enum class SweepAxis {
  kSpeed,         // m/s, of the mass centre; the direction stays
  kIncidence,     // degrees from the normal, towards t; the speed stays
  kDropAngle,     // degrees: the surface's angle, and the ball falls upon it vertically
  kSurfaceAngle,  // degrees; the motion stays as it is along the surface's axes
  kRodAngle,      // degrees, of a rod's axis from the surface
  kSpin,          // rad/s about b
  kSpinRatio,     // R omega over the speed
  kStiffness,
  kDamping,
  kFrictionKinetic,
  kFrictionStatic,
  kPoisson,
  kYieldStrength,
  kRestitution,  // of the formulas
  kTangentialRestitution
};

struct SweepValues {
  SweepAxis axis{};
  std::vector<double> values;
};

// The model that every shot starts from.
using SweepModel = std::variant<ImpactJob, ReboundJob, RodModel>;

// The key as it stands in a job and in sweep.csv, with its unit; the stiffness's depends on the
// law.
std::string key_of(SweepAxis axis, const SweepModel& model);
// Whether shots of the model have it.
bool has_axis(const SweepModel& model, SweepAxis axis);

struct SweepRequest {
  SweepModel model;
  std::vector<SweepValues> axes;  // the first varies slowest
  int threads = 0;                // shots at a time; 0: as many as the machine has cores

  // The number of shots: the product of the axes' lengths.
  std::size_t size() const;
  // The values of shot `index`, one an axis.
  std::vector<double> values_of(std::size_t index) const;
  // The model of shot `index`.
  SweepModel shot(std::size_t index) const;
  // Throws InvalidArgument naming the key, as it stands in a job file: no axis, an empty one, one
  // that stands twice or that the model does not have, more than a million shots. Values that are
  // impossible are those shots' own failures.
  void validate() const;
};

enum class SweepStatus {
  kSeparated,
  kHeld,   // the weight holds the body on the surface: there is no motion after
  kFailed  // `reason` says why
};

// NaN where the model does not say it, or the shot failed.
struct SweepShot {
  SweepStatus status = SweepStatus::kFailed;
  std::string reason;
  BodyState before, after;  // velocities and spins
  double restitution = 0;
  // -(velocity of the contact point after) / (before), along the surface; NaN where it did not
  // move.
  double tangential_restitution = 0;
  double friction = 0, rolling_cap = 0;  // EffectiveFriction::sound, rolling_cap; balls only
  double contact_s = 0, max_deflection_m = 0, max_force_n = 0;
  double dent_m = 0;      // that the blow leaves (rods)
  int micro_impacts = 0;  // of a rod
  double kinetic_before_j = 0;
  double lost = 0;  // share of the kinetic energy that the body does not take along
  // Tangential phases in their order, such as "sticking+partial_slip"; empty for formulas.
  std::string phases;
  std::vector<std::string> warnings;
};

struct SweepResult {
  // Shot i has SweepRequest::values_of(i). Of a cancelled run those not begun are kFailed.
  std::vector<SweepShot> shots;
  bool cancelled = false;
};

// Runs every shot, in parallel; the result does not depend on the number of threads. Throws
// InvalidArgument (validate).
SweepResult sweep(const SweepRequest& request, const RunControl& control = {});

}  // namespace impactdic
