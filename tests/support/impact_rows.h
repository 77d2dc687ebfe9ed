// Tracked rows of an integrated impact, and how they are analysed.
#pragma once

#include "host/impact/impact_phases.h"
#include "sim/verify/filmed_impact.h"

namespace impactdic::testing {

using sim::verify::film;
using sim::verify::FilmedTruth;
using sim::verify::turn_between;

struct FilmedImpact : sim::verify::FilmedImpact {
  impact::ImpactOptions options() const {
    impact::ImpactOptions o;
    o.surface_angle_rad = job.surface_angle_deg * kRadPerDeg;
    o.gravity = job.gravity_m_s2 / metre_per_px / (fps * fps);
    o.inertia_factor = job.body.inertia_factor();
    return o;
  }
};

inline FilmedImpact tennis_on_racket() { return {sim::verify::tennis_on_racket()}; }
inline FilmedImpact lacrosse_on_wood() { return {sim::verify::lacrosse_on_wood()}; }

}  // namespace impactdic::testing
