#include "host/report/picture/key_frames.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/clip/roi.h"
#include "host/report/picture/png.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

constexpr double kBoxMargin = 1.4;  // half side of the box over the radius

struct KeyFrame {
  const char* moment;
  TrackRow row;
  Frame frame;
};

// The row with a ball whose frame is nearest to `frame`; there is one.
TrackRow nearest(const TrackRows& rows, double frame) {
  TrackRow best;
  double least = std::numeric_limits<double>::infinity();
  for (const TrackRow& row : rows) {
    const double off = std::abs(static_cast<double>(row.frame) - frame);
    if (row.circle_ok && off < least) best = row, least = off;
  }
  return best;
}

// The row with a ball that so many such rows lie before; there is one.
TrackRow with_ball(const TrackRows& rows, std::int64_t before) {
  for (const TrackRow& row : rows) {
    if (row.circle_ok && before-- == 0) return row;
  }
  return {};
}

std::vector<KeyFrame> choose(const TrackRows& rows, const ImpactFigures& impact) {
  const std::int64_t balls =
      std::count_if(rows.begin(), rows.end(), [](const TrackRow& row) { return row.circle_ok; });
  if (balls == 0) return {};
  if (impact.t0.known() && impact.t_max_compression.known() && impact.t_end.known()) {
    return {{"before", nearest(rows, std::floor(impact.t0.frame)), {}},
            {"during", nearest(rows, impact.t_max_compression.frame), {}},
            {"after", nearest(rows, std::ceil(impact.t_end.frame)), {}}};
  }
  return {{"first", with_ball(rows, 0), {}},
          {"middle", with_ball(rows, balls / 2), {}},
          {"last", with_ball(rows, balls - 1), {}}};
}

Roi box_around(const std::vector<KeyFrame>& frames, int width, int height) {
  double left = width, right = 0, top = height, bottom = 0;
  for (const KeyFrame& key : frames) {
    const double half = kBoxMargin * key.row.r_px;
    left = std::min(left, key.row.cx_px - half);
    right = std::max(right, key.row.cx_px + half);
    top = std::min(top, key.row.cy_px - half);
    bottom = std::max(bottom, key.row.cy_px + half);
  }
  Roi box;
  box.x = static_cast<int>(std::clamp(left, 0.0, width - 1.0));
  box.y = static_cast<int>(std::clamp(top, 0.0, height - 1.0));
  box.width = static_cast<int>(std::clamp(right, box.x + 1.0, double(width))) - box.x;
  box.height = static_cast<int>(std::clamp(bottom, box.y + 1.0, double(height))) - box.y;
  return box;
}

float brightest(const Image<float>& picture) {
  return *std::max_element(picture.data(), picture.data() + picture.size());
}

}  // namespace

json write_key_frames(FrameSource& source, const TrackRows& rows, const ImpactFigures& impact,
                      const std::filesystem::path& folder) {
  json list = json::array();
  std::vector<KeyFrame> frames = choose(rows, impact);
  std::erase_if(frames, [&](KeyFrame& key) {
    try {
      source.read(key.row.frame, key.frame);
      return false;
    } catch (const FileError&) {
      return true;
    }
  });
  if (frames.empty()) return list;
  const Roi box = box_around(frames, frames[0].frame.width(), frames[0].frame.height());
  std::vector<Image<float>> pictures;
  float white = 1;
  for (const KeyFrame& key : frames) {
    Frame cut;
    crop(key.frame, box, cut);
    pictures.push_back(cut.to_float());
    white = std::max(white, brightest(pictures.back()));
  }
  std::filesystem::create_directories(folder / "key_frames");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::vector<std::uint8_t> grey(pictures[i].size());
    std::transform(pictures[i].data(), pictures[i].data() + grey.size(), grey.begin(),
                   [&](float v) { return static_cast<std::uint8_t>(255 * v / white); });
    char name[48];
    std::snprintf(name, sizeof name, "key_frames/frame_%06lld.png",
                  static_cast<long long>(frames[i].row.frame));
    write_png_grey(folder / name, box.width, box.height, grey);
    list.push_back({{"moment", frames[i].moment},
                    {"frame", frames[i].row.frame},
                    {"picture", name},
                    {"x_px", box.x},
                    {"y_px", box.y}});
  }
  return list;
}

}  // namespace impactdic::report
