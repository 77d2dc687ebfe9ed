#include "host/video/channel.h"

#include <impactdic/error.h>

#include <array>
#include <cstddef>

namespace impactdic {
namespace {
constexpr std::array kNames = {"luminance", "red", "green", "blue"};
}  // namespace

const char* to_string(Channel channel) { return kNames[static_cast<std::size_t>(channel)]; }

Channel parse_channel(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Channel>(i);
  }
  throw InvalidArgument("'" + name + "' is no part of a colour picture", "--channel",
                        "there are luminance, red, green and blue");
}

namespace video {

std::string colour_warning(Channel channel) {
  if (channel == Channel::kLuminance) return "colour pictures: read as luminance";
  return std::string("colour pictures: their ") + to_string(channel) + " is read";
}

}  // namespace video
}  // namespace impactdic
