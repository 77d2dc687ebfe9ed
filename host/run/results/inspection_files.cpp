#include "host/run/results/inspection_files.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "host/base/parse.h"
#include "host/report/advice_json.h"
#include "host/report/picture/overlay.h"
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

// The picture of frame `index` as an entry of key_frames; null where the frame is damaged.
Json key_frame(FrameSource& source, std::int64_t index, const std::string& moment,
               const std::filesystem::path& folder) {
  Frame frame;
  try {
    source.read(index, frame);
  } catch (const Error&) {
    return {};
  }
  char name[48];
  std::snprintf(name, sizeof name, "key_frames/frame_%06lld.png", static_cast<long long>(index));
  write_picture(frame, folder / name);
  return {{"moment", moment}, {"frame", index}, {"picture", name}, {"x_px", 0}, {"y_px", 0}};
}

Json describe(const BallSeen& seen) {
  return {{"radius_px", seen.radius_px}, {"rim_fraction", seen.rim_fraction},
          {"moved_px", seen.moved_px},   {"frames", seen.frames},
          {"frame", seen.frame},         {"cx_px", seen.place.cx_px},
          {"cy_px", seen.place.cy_px}};
}

Json write_pictures(const InspectRequest& request, const Inspection& found,
                    const std::filesystem::path& folder) {
  constexpr std::size_t kMostCandidates = 6;
  const auto source = open_requested(request.clip);
  const std::int64_t last = source->info().frame_count - 1;
  std::filesystem::create_directories(folder / "key_frames");
  Json list = Json::array();
  for (const std::int64_t index : std::set<std::int64_t>{0, last / 2, last}) {
    const char* moment = index == 0 ? "first" : index == last ? "last" : "middle";
    const Json entry = key_frame(*source, index, moment, folder);
    if (!entry.is_null()) list.push_back(entry);
  }
  for (std::size_t i = 0; i < std::min(found.candidates.size(), kMostCandidates); ++i) {
    const BallSeen& seen = found.candidates[i];
    Json entry = key_frame(*source, seen.frame, "candidate " + std::to_string(i + 1), folder);
    if (entry.is_null()) continue;
    entry["outline"] = describe(seen);
    list.push_back(entry);
  }
  if (!found.candidates.empty()) {
    Frame frame;
    const std::int64_t index = found.candidates.front().frame;
    source->read(index, frame);
    report::write_candidates(folder / "key_frames/candidates.png", frame, index, found.candidates);
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
  if (request.candidates) settings(Setting{"candidates"}, request.candidates);
  begin_results(output.path(), "info", settings, false);
  Json summary = {{"input", report::describe_input(found.clip, {})},
                  {"advice", report::describe_advice(found.advice)},
                  {"warnings", found.warnings}};
  summary["words"] = split(report::in_words(found, error_px), '\n');
  if (const auto& ball = found.advice.ball) {
    summary["ball"] = {{"cx_px", ball->cx_px}, {"cy_px", ball->cy_px}, {"radius_px", ball->r_px}};
  }
  for (const BallSeen& seen : found.candidates) summary["candidates"].push_back(describe(seen));
  summary["key_frames"] = write_pictures(request, found, output.path());
  report::write_json(output.path() / "summary.json", summary);
  write_digests(output.path());
}

}  // namespace impactdic::run
