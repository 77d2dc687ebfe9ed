// Whether a path is broken by a contact, or smooth. Internal to the impact analysis; pixels,
// frames, axis n out of the surface.
#pragma once

#include <cstddef>

#include "host/impact/impact_series.h"

namespace impactdic::impact {

// Instants, all included: within which the surface may act, and of the part of the track that is
// looked at, which holds them.
struct PathSpan {
  std::size_t first = 0, last = 0;  // of the contact
  std::size_t begin = 0, end = 0;
};

// Natural logarithm of the odds that the path along n is broken in the contact: half the difference
// of the Bayesian information criteria (Schwarz 1978) of the best smooth path and the best broken
// one. Broken: an acceleration alike before and after, and any in the contact. Smooth: polynomials,
// a circle seen from its side with a second harmonic, cubic splines on even knots. The scatter is
// what the paths leave, not what the track states; frames that err alike count for fewer.
double odds_of_contact(const ImpactSeries& series, const PathSpan& span);

}  // namespace impactdic::impact
