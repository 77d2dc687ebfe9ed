// What lies behind the ball, from some frames spread over the clip. Internal to host/circle.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/scene/backdrop.h"

namespace impactdic::circle {

struct ScoutedBackdrop {
  std::shared_ptr<const Backdrop> backdrop;     // nullptr where nothing is learnt
  std::vector<std::optional<FoundBall>> plain;  // of each view the ball, where it is plainly one
  // Of their rims, the shares that show, in sum.
  double shown() const;
};

// Learns it from the views in which balls are seen, roughly; measures these before what is learnt,
// looks for those that were not seen, of radius `radius_px`, and learns anew. Nothing as
// Backdrop::learn says, and where the balls are discs, whose rims show before any texture.
ScoutedBackdrop scout_backdrop(std::vector<Backdrop::View> views, double radius_px,
                               const CircleOptions& options);

// Nothing is learnt: which of the views' balls are plain before what lies behind them as it is.
ScoutedBackdrop scout_without_backdrop(const std::vector<Backdrop::View>& views,
                                       const CircleOptions& options);

// As scout_backdrop where no ball is seen before the texture. The views' circles are the discs that
// moved (StillScene::moved_disc).
ScoutedBackdrop scout_moved_backdrop(std::vector<Backdrop::View> views,
                                     const CircleOptions& options);

}  // namespace impactdic::circle
