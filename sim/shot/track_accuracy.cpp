#include "sim/shot/track_accuracy.h"

#include <impactdic/error.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace impactdic::sim::shot {
namespace {

using Json = nlohmann::json;

// The number at `pointer`; 0 where there is none.
double number_at(const Json& json, const char* pointer) {
  const Json::json_pointer place(pointer);
  if (!json.contains(place) || !json[place].is_number()) return 0;
  return json[place].get<double>();
}

}  // namespace

void read_accuracy(const std::filesystem::path& track_file, MeasuredTrack& track) {
  const std::filesystem::path file = track_file.parent_path() / "summary.json";
  std::ifstream in(file);
  if (!in) return;
  const Json summary = Json::parse(in, nullptr, false);
  if (summary.is_discarded() || !summary.is_object()) {
    throw FormatError(file.string(), -1, "the track's summary is damaged", "track again");
  }
  const double scale = number_at(summary, "/scale/m_per_px");
  const double rate = number_at(summary, "/analysed_fps");
  if (scale > 0) track.scale_sd = number_at(summary, "/scale/sd_m_per_px") / scale;
  if (rate > 0) track.rate_sd = number_at(summary, "/analysed_fps_sd") / rate;
}

}  // namespace impactdic::sim::shot
