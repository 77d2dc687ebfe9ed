// What shows of a ball outside a rim: nothing, if the rim is the ball's. Internal to host/circle.
#pragma once

#include "host/circle/rim/rim.h"

namespace impactdic::circle {

struct Beyond {
  // Of the directions in which it can be told: in how many something that is not the background
  // adjoins the rim from outside and ends there. What goes on outwards is an obstacle and tells
  // nothing.
  double share = 0;
  double farthest_px = 0;  // how far it reaches
};

// `edge_sigma_px`: width of the ball's edge, which reaches beyond the rim too.
Beyond beyond_rim(const Frame& frame, const Rim& rim, double edge_sigma_px);

}  // namespace impactdic::circle
