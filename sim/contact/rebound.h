// Impact models that are a formula: the motion after from the motion before, without a path, phases
// or a duration.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/contact/closed_form.h"
#include "sim/contact/model.h"

namespace impactdic::sim::contact {

enum class ReboundModel { kGarwin, kCross, kWalton, kStronge };
std::string_view name_of(ReboundModel model);
// Throws InvalidArgument.
ReboundModel parse_rebound_model(std::string_view name);
bool is_rebound_model(std::string_view name);

struct ReboundJob {
  ReboundModel model = ReboundModel::kWalton;
  // kPublished: the authors' own rule (Garwin 1969: nothing is lost; Cross 2002: friction grips
  // without limit). kSound: the surface's restitution also for Garwin, and neither grips harder
  // than friction_kinetic allows. Walton (1993) and Stronge (1990) know that limit themselves.
  Preset preset = Preset::kSound;
  Body body;
  double restitution = 1;             // normal; Stronge: energetic
  double tangential_restitution = 0;  // e_x of Cross, beta_0 of Walton; -1 to 1
  double friction_kinetic = 0;
  double surface_angle_deg = 0;
  // Rods: angle_deg is the axis above the surface, the centre seen from the striking end.
  InitialMotion initial;

  // Throws InvalidArgument naming the key, as it stands in a job file.
  void validate() const;
};

struct ReboundResult {
  ImpactVelocities before, after;
  double restitution = 0;  // of the contact point's normal velocity
  double kinetic_before_j = 0, kinetic_after_j = 0;
  std::vector<std::string> warnings;  // energy that the rule creates
};

// Throws InvalidArgument (job.validate()).
ReboundResult simulate_rebound(const ReboundJob& job);

}  // namespace impactdic::sim::contact
