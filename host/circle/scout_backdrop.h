// What lies behind the ball, from some frames spread over the clip. Internal to host/circle.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/scene/backdrop.h"

namespace impactdic::circle {

// Learns it from the views in which balls are seen, roughly; measures these before what is learnt,
// looks for those that were not seen, of radius `radius_px`, and learns anew. nullptr as
// Backdrop::learn says, and where the balls are discs, whose rims show before any texture.
std::shared_ptr<const Backdrop> scout_backdrop(std::vector<Backdrop::View> views, double radius_px,
                                               const CircleOptions& options);

// The same where no ball is seen before the texture. The views' circles are the discs that moved
// (StillScene::moved_disc). `found`: the balls that are plain before
// what is learnt, view by view; left alone where nothing is.
std::shared_ptr<const Backdrop> scout_moved_backdrop(std::vector<Backdrop::View> views,
                                                     const CircleOptions& options,
                                                     std::vector<std::optional<FoundBall>>& found);

}  // namespace impactdic::circle
