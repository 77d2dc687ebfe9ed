#include "sim/fit/rivals.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/fit/calibration.h"
#include "sim/fit/trajectory_fit.h"

namespace impactdic::sim::fit {
namespace {

// Laws so near by the criterion fit equally well (Burnham and Anderson 2002).
constexpr double kEqual = 2, kBetter = 6;

double aicc_of(const ShotFit& fit) {
  const auto n = static_cast<double>(fit.measurements);
  const auto p = static_cast<double>(fit.free_parameters);
  return fit.chi_square + 2 * p + 2 * p * (p + 1) / std::max(n - p - 1, 1.0);
}

RivalFit rival_of(const ShotFit& fit, const ImpactJob& laws, std::size_t parameters) {
  RivalFit rival{laws.normal, laws.friction, laws.contact.restitution_damping,
                 laws.shell.has_value()};
  rival.chi_square = fit.chi_square;
  rival.p_value = fit.p_value;
  rival.aicc = aicc_of(fit);
  rival.parameters.assign(fit.parameters.begin(),
                          fit.parameters.begin() + static_cast<std::ptrdiff_t>(parameters));
  return rival;
}

std::string words(const RivalFit& rival) {
  return std::string(name_of(rival.normal)) + ", " + std::string(name_of(rival.friction)) +
         ", restitution_damping " + std::string(name_of(rival.restitution_damping)) +
         (rival.shell ? ", of a shell" : "");
}

bool is_own(const RivalFit& rival, const ImpactJob& laws) {
  return rival.normal == laws.normal && rival.friction == laws.friction &&
         rival.restitution_damping == laws.contact.restitution_damping &&
         rival.shell == laws.shell.has_value();
}

bool fits(const FitRequest& request, FitParameter p) {
  return std::find(request.parameters.begin(), request.parameters.end(), p) !=
         request.parameters.end();
}

// The endings that a law's damper knows (RestitutionDamping).
std::vector<RestitutionDamping> dampings_of(NormalModel normal, RestitutionDamping own) {
  switch (normal) {
    case NormalModel::kLinearSpringDamper:
    case NormalModel::kHertzDamper:
      return {RestitutionDamping::kNone, RestitutionDamping::kToZeroForce,
              RestitutionDamping::kToZeroDeflection};
    case NormalModel::kTsuji:
    case NormalModel::kKuwabaraKono:
      return {RestitutionDamping::kToZeroForce, RestitutionDamping::kToZeroDeflection};
    default:
      return {own};
  }
}

// The laws compared: every spring with a damper, every damping, the friction of the request and,
// where it has one, none. Of a shell one spring.
std::vector<ImpactJob> rival_laws(const FitRequest& request) {
  if (request.impact.shell) return {one_spring(request.impact)};
  std::vector<NormalModel> normals{request.impact.normal};
  // Another spring has another unit: only its own fit gives it.
  if (fits(request, FitParameter::kStiffness) && fits(request, FitParameter::kDamping) &&
      request.impact.friction != FrictionModel::kMawBarberFawcett) {
    normals = {NormalModel::kLinearSpringDamper, NormalModel::kHertzDamper, NormalModel::kTsuji,
               NormalModel::kKuwabaraKono, NormalModel::kHuntCrossley};
  }
  std::vector<ImpactJob> laws;
  for (const NormalModel normal : normals) {
    for (const RestitutionDamping damping :
         dampings_of(normal, request.impact.contact.restitution_damping)) {
      ImpactJob rival = request.impact;
      rival.normal = normal;
      rival.contact.restitution_damping = damping;
      laws.push_back(rival);
    }
  }
  if (request.impact.friction == FrictionModel::kNone) {
    // How much friction there is does not matter to the question whether there is any.
    ImpactJob rough = request.impact;
    rough.friction = FrictionModel::kCoulomb;
    laws.push_back(rough);
  }
  return laws;
}

// After the rivals are ranked: the request's own laws in air. Where drag and Magnus' force describe
// the flights far better, the constants of the contact are those of a path that was bent otherwise.
void warn_of_air(ShotFit& fit, const MeasuredTrack& track, const MeasuredShot& shot,
                 const FitRequest& request) {
  if (request.impact.air.act() || fits(request, FitParameter::kDrag) ||
      fits(request, FitParameter::kLift) || request.impact.body.shape == BodyShape::kRod ||
      request.impact.shell) {
    return;
  }
  FitRequest in_air = request;
  in_air.parameters.push_back(FitParameter::kDrag);
  if (!std::isnan(shot.before.omega_rad_s.value)) in_air.parameters.push_back(FitParameter::kLift);
  const ShotFit found = fit_values(track, shot, in_air);
  // Better than every rival: another law of the contact may bend the flights' ends, too.
  const double better = fit.rivals.front().aicc - aicc_of(found);
  if (!(better > kBetter)) return;
  const double drag = found.parameters[request.parameters.size()].value;
  char text[240];
  std::snprintf(text, sizeof text,
                "the flights bend as in air (drag coefficient %.2g, AICc lower by %.3g): fit "
                "drag_coefficient and lift_coefficient, or give them in [air]",
                drag, better);
  fit.warnings.emplace_back(text);
}

// A shell whose path one spring describes as well.
void warn_of_one_spring(ShotFit& fit) {
  const auto of = [&](bool shell) {
    return std::find_if(fit.rivals.begin(), fit.rivals.end(),
                        [&](const RivalFit& rival) { return rival.shell == shell; });
  };
  if (of(true) == fit.rivals.end() || of(false) == fit.rivals.end()) return;
  if (of(false)->aicc > of(true)->aicc + kEqual) return;
  fit.warnings.emplace_back(
      "one spring describes the path as well: it does not tell the shell from the surface");
}

void warn(ShotFit& fit, const ImpactJob& own) {
  const RivalFit& best = fit.rivals.front();
  for (const RivalFit& rival : fit.rivals) {
    if (!is_own(rival, own) || rival.above_best <= kBetter) continue;
    char text[60];
    std::snprintf(text, sizeof text, " (AICc lower by %.3g)", rival.above_best);
    fit.warnings.push_back("another law describes the data better: " + words(best) + text);
  }
  for (const ParameterEstimate& p : best.parameters) {
    double low = p.value, high = p.value;
    for (const RivalFit& rival : fit.rivals) {
      if (rival.above_best > kEqual) continue;
      for (const ParameterEstimate& q : rival.parameters) {
        if (q.key == p.key) low = std::min(low, q.value), high = std::max(high, q.value);
      }
    }
    if (high - low <= 0.02 * std::abs(high)) continue;
    char text[160];
    std::snprintf(text, sizeof text, "laws that fit equally well give %s from %.4g to %.4g",
                  p.key.c_str(), low, high);
    fit.warnings.emplace_back(text);
  }
}

}  // namespace

void rank_rivals(ShotFit& fit, const MeasuredTrack& track, const MeasuredShot& shot,
                 const FitRequest& request) {
  const std::size_t parameters = request.parameters.size();
  fit.rivals.push_back(rival_of(fit, request.impact, parameters));
  for (const ImpactJob& laws : rival_laws(request)) {
    FitRequest other = request;
    other.impact = laws;
    if (laws.friction != request.impact.friction) {
      other.parameters.push_back(FitParameter::kFrictionKinetic);
    }
    if (!laws.shell) std::erase_if(other.parameters, is_of_shell);
    RivalFit own{laws.normal, laws.friction, laws.contact.restitution_damping,
                 laws.shell.has_value()};
    if (is_own(own, request.impact)) continue;
    try {
      fit.rivals.push_back(rival_of(fit_values(track, shot, other), laws, other.parameters.size()));
    } catch (const Error&) {
      // A law that has no impact at its start is no rival.
    }
  }
  std::sort(fit.rivals.begin(), fit.rivals.end(),
            [](const RivalFit& a, const RivalFit& b) { return a.aicc < b.aicc; });
  for (RivalFit& rival : fit.rivals) rival.above_best = rival.aicc - fit.rivals.front().aicc;
  warn(fit, request.impact);
  warn_of_one_spring(fit);
  warn_of_air(fit, track, shot, request);
}

}  // namespace impactdic::sim::fit
