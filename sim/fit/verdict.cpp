#include "sim/fit/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/contact/impact.h"

namespace impactdic::sim::fit {
namespace {

constexpr const char* kSeries =
    "the shell's spring and the surface's lie in series, and the path shows little more than both "
    "together (series_stiffness_n_per_m); the force at the surface, the surface's own deflection, "
    "or a test of the ball or of the surface alone would determine it";

bool slides_throughout(const ImpactResult& impact) {
  return std::none_of(impact.phases.begin(), impact.phases.end(), [](const ContactPhase& phase) {
    const std::string name = phase.name;
    return name == "sticking" || name == "rolling" || name == "partial_slip";
  });
}

std::string friction_words(const ImpactJob& job, const ImpactResult& impact) {
  const double tip = std::abs(impact.tip_vt_start_m_s);
  if (tip < 0.02 * std::abs(job.initial.vn_m_s)) {
    return "the ball arrives without tangential motion, so friction has nothing to act on; an "
           "oblique impact would determine it";
  }
  if (!slides_throughout(impact)) {
    return "the ball stops sliding before it leaves, and from then on the friction no longer "
           "shows: only a lower bound is known; an impact at a more grazing angle, where it slides "
           "throughout, would determine it";
  }
  return "the rotation or the tangential velocity is not measured well enough; more frames of "
         "flight on both sides, or a track with rotation, would determine it";
}

std::string words(FitParameter parameter, const ImpactJob& job, const ImpactResult& impact) {
  switch (parameter) {
    case FitParameter::kStiffness:
      if (job.shell) return kSeries;
      return "the motion during contact does not show it; more frames within the contact (a higher "
             "frame rate) or less noise would determine it";
    case FitParameter::kShellStiffness:
    case FitParameter::kFlatFraction:
      return kSeries;
    case FitParameter::kShellDamping:
      return "the ball's own swing has died down or is within the noise; more frames within the "
             "contact would determine it";
    case FitParameter::kDamping:
      return "the loss of normal velocity is within the noise; more frames of flight on both sides "
             "or a faster impact would determine it";
    case FitParameter::kFrictionKinetic:
      return friction_words(job, impact);
    case FitParameter::kFrictionStatic:
      return "the sticking phase is too short or absent; an impact at a steeper angle, with "
             "rotation measured during contact, would determine it";
    case FitParameter::kPoisson:
      return "only the tangential stiffness during contact shows it; an oblique impact that grips "
             "the surface, with rotation measured during contact, would determine it";
    case FitParameter::kYieldStrength:
      return "the impact stays elastic; a faster impact, or the depth of the permanent dent, would "
             "determine it";
    case FitParameter::kContactTime:
      return "the onset of the contact is hidden by noise; a higher frame rate would determine it";
    case FitParameter::kSurfaceAngle:
      return "friction and a tilt of the surface look alike in one impact; the surface measured in "
             "the picture, or impacts at two speeds or spins, would determine it";
    case FitParameter::kScale:
      return "only the fall under gravity shows it here; a longer flight or a known diameter would "
             "determine it";
    case FitParameter::kRate:
      return "only the fall under gravity shows it here; the camera's own clock would determine it";
    case FitParameter::kDrag:
      return "the flights are too short or too slow to show it; longer flights would determine it";
    case FitParameter::kLift:
      return "the flights do not bend beyond the noise; more spin or longer flights would "
             "determine "
             "it";
  }
  return "";
}

}  // namespace

void add_verdicts(ShotFit& fit, const ImpactJob& solution) {
  const ImpactResult impact = contact::simulate_impact(solution);
  for (ParameterEstimate& p : fit.parameters) {
    if (!p.determined) {
      p.verdict = words(p.parameter, solution, impact);
    } else if (fit.adequacy == Adequacy::kInadequate) {
      p.verdict = "determined, but of a model that does not describe the data";
    } else {
      p.verdict = "determined by the data";
    }
  }
}

}  // namespace impactdic::sim::fit
