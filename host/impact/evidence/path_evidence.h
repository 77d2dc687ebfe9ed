// Whether a path is broken by a contact, or smooth. Internal to the impact analysis; pixels,
// frames, axis n out of the surface.
#pragma once

#include <cstddef>

#include "host/impact/evidence/contact_guess.h"
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
// one. Broken: an acceleration alike before and after, and in the contact any, in even pieces, or a
// pulse between ends that are sought where the odds are not clear. Smooth: polynomials, a circle
// seen from its side with up to six harmonics, a release, cubic splines on even knots. The scatter
// is what the paths leave, at least `least_px`, not what the track states; frames that err alike
// count for fewer. Where centres and steps together leave it in doubt, steps alone may tell it.
double odds_of_contact(const ImpactSeries& series, const PathSpan& span, double least_px);

// `guess` with a contact as long as the pulse of force that describes the path best, where that is
// shorter: where noise hides the force, a guess is far longer than the contact.
ContactGuess sharpened(const ImpactSeries& series, ContactGuess guess);

}  // namespace impactdic::impact
