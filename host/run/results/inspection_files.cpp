#include "host/run/results/inspection_files.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "host/base/parse.h"
#include "host/report/advice_json.h"
#include "host/report/picture/png.h"
#include "host/report/summary.h"
#include "host/report/words/clip_words.h"
#include "host/run/folder.h"
#include "host/run/open_clip.h"
#include "host/run/results/result_digests.h"

namespace impactdic::run {
namespace {

using Json = nlohmann::json;

// As bright as its brightest pixel lets it be.
void write_picture(const Frame& frame, const std::filesystem::path& path) {
  const Image<float> levels = frame.to_float();
  const float* const end = levels.data() + levels.size();
  const float white = std::max(1.0F, *std::max_element(levels.data(), end));
  std::vector<std::uint8_t> grey(levels.size());
  std::transform(levels.data(), end, grey.begin(),
                 [&](float level) { return static_cast<std::uint8_t>(255 * level / white); });
  report::write_png_grey(path, levels.width(), levels.height(), grey);
}

Json write_pictures(const InspectRequest& request, const std::filesystem::path& folder) {
  const auto source = open_requested(request.clip);
  const std::int64_t last = source->info().frame_count - 1;
  std::filesystem::create_directories(folder / "key_frames");
  Json list = Json::array();
  for (const std::int64_t index : std::set<std::int64_t>{0, last / 2, last}) {
    Frame frame;
    try {
      source->read(index, frame);
    } catch (const Error&) {
      continue;  // a damaged frame has no picture
    }
    char name[48];
    std::snprintf(name, sizeof name, "key_frames/frame_%06lld.png", static_cast<long long>(index));
    write_picture(frame, folder / name);
    list.push_back({{"moment", index == 0      ? "first"
                               : index == last ? "last"
                                               : "middle"},
                    {"frame", index},
                    {"picture", name},
                    {"x_px", 0},
                    {"y_px", 0}});
  }
  return list;
}

}  // namespace

void write_inspection(const InspectRequest& request, const Inspection& found, double error_px,
                      const std::string& folder, bool force) {
  const OutputFolder output(folder, force);
  SettingWriter settings;
  visit_clip(settings, request.clip);
  settings(Setting{"window"}, request.field.window_px);
  settings(Setting{"error-px"}, error_px);
  settings(Setting{"camera", kEmptyUnset | kPath}, request.camera);
  begin_results(output.path(), "info", settings, false);
  Json summary = {{"input", report::describe_input(found.clip, {})},
                  {"advice", report::describe_advice(found.advice)},
                  {"warnings", found.warnings}};
  summary["words"] = split(report::in_words(found, error_px), '\n');
  if (const auto& ball = found.advice.ball) {
    summary["ball"] = {{"cx_px", ball->cx_px}, {"cy_px", ball->cy_px}, {"radius_px", ball->r_px}};
  }
  summary["key_frames"] = write_pictures(request, output.path());
  report::write_json(output.path() / "summary.json", summary);
  write_digests(output.path());
}

}  // namespace impactdic::run
