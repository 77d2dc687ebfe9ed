// The ball at further places of its path.
#pragma once

#include <span>
#include <vector>

#include "host/advice/still_edges.h"

namespace impactdic::advice {

// Of a ball whose motion is known at some places of its path: itself and it at others, so that what
// it passes shows before it at one of them. `seen`: frames in which scouts saw it. Between those
// the ball is looked for along a straight line; it turns as it does at the place that is nearest in
// time. Nothing where `moved` is nothing.
std::vector<MovedBall> along_path(const std::vector<MovedBall>& moved,
                                  std::span<const circle::BallCandidate::Sighting> seen,
                                  const FarFrames& frames);

}  // namespace impactdic::advice
