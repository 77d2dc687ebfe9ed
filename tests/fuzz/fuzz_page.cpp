#include "tests/fuzz/fuzz_page.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "host/video/frame_sink.h"
#include "host/view/address_check.h"
#include "host/view/answers.h"
#include "host/view/field_frames.h"
#include "host/view/target.h"
#include "host/view/track_job.h"

namespace impactdic::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 48, kHeight = 36;

// A page that shows a clip of three frames.
struct Page {
  std::unique_ptr<view::Target> target;
  Session session;
  view::RunJob run{session};
  std::unique_ptr<view::Answers> answers;

  explicit Page(const fs::path& scratch) {
    const std::string path = (scratch / "clip.tif").string();
    ClipInfo info;
    info.width = kWidth;
    info.height = kHeight;
    const auto sink = video::open_sink(path, video::SinkFormat::kTiff, info);
    Frame frame;
    frame.reset(kWidth, kHeight, 8);
    for (int i = 0; i < 3; ++i) sink->write(frame);
    sink->finish();
    ClipRequest clip;
    clip.paths = {path};
    target = std::make_unique<view::Target>(clip);
    answers = std::make_unique<view::Answers>(*target, session, run);
  }
};

}  // namespace

void ask_page(const std::string& text, const fs::path& scratch) {
  static Page page(scratch);
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string line = text.substr(0, end);
  view::is_own_host(line);
  view::is_own_origin(line);
  view::behind_token(line, "00112233445566778899aabbccddeeff");
  view::PageRequest request;
  request.changes = line.starts_with("POST ");
  line.erase(0, std::min(line.find(' '), line.size()));
  if (!line.empty()) line.erase(0, 1);
  const std::size_t query = std::min(line.find('?'), line.size());
  request.name = line.substr(0, query);
  if (request.changes && (request.name == "api/measure" || request.name == "api/run")) return;
  for (const std::string& part : split(line.substr(std::min(query + 1, line.size())), '&')) {
    const std::size_t equal = std::min(part.find('='), part.size());
    request.query[part.substr(0, equal)] = part.substr(std::min(equal + 1, part.size()));
  }
  request.body = text.substr(std::min(end + 1, text.size()));
  (*page.answers)(request);
}

void show_fields(const fs::path& path) {
  const view::FieldFrames fields(path);
  if (fields.rows() == 0 || fields.windows() == 0) return;
  fields.frame(fields.rows() - 1);
  fields.history(fields.windows() - 1);
}

void show_job(const fs::path& path) {
  view::settings_of_results(path.parent_path());
  view::clip_of_results(path.parent_path());
}

}  // namespace impactdic::fuzz
