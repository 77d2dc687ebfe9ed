// What was given against what the clip shows.
#pragma once

#include <impactdic/track.h>

#include <string>
#include <vector>

namespace impactdic::run {

// Sets the surface's and gravity's direction as the clip shows them, and every contradiction
// between what `request` says and what was measured, with the slip that it looks like.
void find_contradictions(const TrackRequest& request, const ImpactAnalysis& analysis,
                         ImpactFigures& figures);

// Says that there is no impact on the surface that was given, but one on a surface at about
// `angle_deg`, by `other`.
void note_other_surface(const TrackRequest& request, const ImpactAnalysis& other, double angle_deg,
                        ImpactFigures& figures);

// The figures that go by the surface's direction.
std::vector<ImpactFigure> figures_of_surface();

// Whether there is one of this kind (Contradiction::what).
bool contradicts(const ImpactFigures& figures, const std::string& what);

}  // namespace impactdic::run
