#include <impactdic/error.h>
#include <impactdic/simulate.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/derivatives/derivatives.h"
#include "sim/contact/impact.h"
#include "sim/contact/rebound.h"
#include "sim/rod/rod_impact.h"

namespace impactdic {

namespace {

ImpactResult simulate_path(const SimulateRequest& request) {
  constexpr double kDefaultRows = 200;
  if (!request.times_s.empty()) {
    return sim::contact::simulate_impact(request.impact, {0, request.times_s});
  }
  double rate_hz = request.rate_hz;
  if (rate_hz == 0) {
    const ImpactResult first = sim::contact::simulate_impact(request.impact);
    const double span_s = first.separated ? first.contact_s : first.phases.back().end_s;
    rate_hz = kDefaultRows / span_s;
  }
  return sim::contact::simulate_impact(request.impact, {.rate_hz = rate_hz});
}

}  // namespace

ImpactResult simulate(const SimulateRequest& request) {
  request.validate();
  ImpactResult result = simulate_path(request);
  if (request.derivatives) {
    result.derivatives = sim::contact::derivatives_of(request.impact, result);
  }
  return result;
}

ReboundResult simulate(const ReboundJob& job) { return sim::contact::simulate_rebound(job); }

RodImpact simulate(const RodJob& job) { return sim::rod::simulate_rod(job); }

}  // namespace impactdic
