// A ball whose only texture is a lamp's reflex.
#pragma once

#include <optional>
#include <span>

#include "host/circle/circle.h"

namespace impactdic::advice {

// Where all of a ball's texture lies, from its centre, in radii.
struct Spot {
  double x = 0, y = 0;
};

// The one spot that holds all that stands out of the ball's smooth shading by six deviations of the
// noise (`noise`: grey levels of 255); nullopt where texture lies in more places, or there is none.
std::optional<Spot> only_spot(const Frame& frame, const Circle& ball, double noise);

struct BallView {
  const Frame* frame;
  Circle ball;
};

// Whether all of these frames, which lie spread over the clip, show one spot at one place of the
// disc: a mark on a ball that turns would move. False where there are too few to tell.
bool is_reflex_alone(std::span<const BallView> views, double noise);

// What is said of it.
extern const char* const kReflexAlone;

}  // namespace impactdic::advice
