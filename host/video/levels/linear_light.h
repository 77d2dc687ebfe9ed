// Pictures whose grey levels go as the light.
#pragma once

#include <impactdic/clip.h>

#include <memory>

namespace impactdic::video {

// The clip with grey levels g turned into full · (g / full)^gamma, of 16 bits, which is the light
// where a camera or a coder had raised that to 1 / gamma (Poynton, Digital Video and HDTV, 2003,
// chapter 23). Throws InvalidArgument for a gamma outside 0.2 … 5.
std::unique_ptr<FrameSource> in_linear_light(std::unique_ptr<FrameSource> source, double gamma);

}  // namespace impactdic::video
