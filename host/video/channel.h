// What of a colour picture is measured.
#pragma once

#include <impactdic/clip.h>

#include <cstdint>
#include <string>

namespace impactdic::video {

// ITU-R BT.601 luminance, rounded (weights in 1/65536, which sum to one exactly), or one of the
// three.
template <typename T>
T grey_of(Channel channel, std::uint32_t red, std::uint32_t green, std::uint32_t blue) {
  if (channel == Channel::kRed) return static_cast<T>(red);
  if (channel == Channel::kGreen) return static_cast<T>(green);
  if (channel == Channel::kBlue) return static_cast<T>(blue);
  const std::uint64_t sum = std::uint64_t{19595} * red + std::uint64_t{38470} * green +
                            std::uint64_t{7471} * blue + 32768;
  return static_cast<T>(sum >> 16);
}

// What a reader says of a clip in colour.
std::string colour_warning(Channel channel);

}  // namespace impactdic::video
