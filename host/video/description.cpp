#include "host/video/description.h"

#include <impactdic/error.h>

#include "host/base/parse.h"

namespace impactdic::video {
namespace {
constexpr const char* kMark = "impactdic ";
}

std::string describe(const ClipInfo& info) {
  std::string text = kMark + std::string("bits=") + std::to_string(info.bits);
  if (info.fps) text += " fps=" + shortest(*info.fps);
  if (info.exposure_s) text += " exposure_s=" + shortest(*info.exposure_s);
  return text;
}

void read_description(const std::string& text, ClipInfo& info) {
  if (!text.starts_with(kMark)) return;
  for (const std::string& fact : split(text, ' ')) {
    const auto equals = fact.find('=');
    if (equals == std::string::npos) continue;
    const std::string key = fact.substr(0, equals);
    try {
      const double value = parse_double(fact.substr(equals + 1), key);
      if (key == "fps" && value > 0) info.fps = value;
      if (key == "exposure_s" && value > 0) info.exposure_s = value;
      if (key == "bits" && info.bits == 16 && value > 8 && value <= 16) {
        info.bits = static_cast<int>(value);
      }
    } catch (const InvalidArgument&) {
      info.warnings.push_back("a damaged description: " + fact.substr(0, 40));
    }
  }
}

}  // namespace impactdic::video
