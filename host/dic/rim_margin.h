#pragma once

namespace impactdic::dic {

// How far within a ball's rim the disc ends that is registered: nearer, background shines through.
inline constexpr double kRimMarginPx = 4;

}  // namespace impactdic::dic
