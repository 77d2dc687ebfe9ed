// The impact of a track, in the units that people read.
#pragma once

#include <impactdic/track.h>

#include <array>
#include <optional>
#include <vector>

#include "host/clip/track_rows.h"
#include "host/motion/perspective.h"

namespace impactdic::run {

inline constexpr double kGravity_m_s2 = 9.81;

// The free ball's radius, where its rim is not what tells it, how a sphere was seen, and whether
// through a coder of video.
struct FilmedBall {
  std::optional<Measured> radius_px;
  motion::Perspective perspective;
  bool lossy = false;
};

// Whether there are impacts at all is asked of the rows, or known: then one is measured, what else
// there may be is left alone.
enum class Impacts { kLookedFor, kKnown };

// The analysis of the impact in `rows`, which are evenly spaced in time (frame_clock.h). Gravity's
// strength is known where scale and rate are.
ImpactAnalysis analyse_impact(const TrackRequest& request, const TrackRows& rows,
                              const SiScale& scale, const FilmedBall& ball,
                              Impacts impacts = Impacts::kLookedFor);

// The other impacts in `rows`, beside the one that was `found` with the same arguments, in order of
// time.
std::vector<ImpactAnalysis> other_impacts(const TrackRequest& request, const TrackRows& rows,
                                          const SiScale& scale, const FilmedBall& ball,
                                          const ImpactAnalysis& found);

// The figures that have a budget, indexed by ImpactFigure.
std::array<Measured*, kImpactFigures> figures_with_budget(ImpactFigures& figures);

// What was found, in frames of the stored file, seconds and metres as far as `scale` knows them;
// its deviations are part of theirs.
ImpactFigures convert_impact(const TrackRequest& request, const TrackRows& rows,
                             const SiScale& scale, const ImpactAnalysis& analysis);

}  // namespace impactdic::run
