// The facts of a clip in a line of text: our TIFF files carry it as ImageDescription, so that a
// clip keeps its rate and depth. "impactdic fps=10000 bits=12 exposure_s=2e-05".
#pragma once

#include <string>

#include "host/video/frame_source.h"

namespace impactdic::video {

std::string describe(const ClipInfo& info);
// Takes the facts over into `info`; text that is not ours changes nothing.
void read_description(const std::string& text, ClipInfo& info);

}  // namespace impactdic::video
