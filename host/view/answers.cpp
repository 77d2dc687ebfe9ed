#include "host/view/answers.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "host/run/settings/job_file.h"
#include "host/video/codec_module.h"
#include "host/view/film.h"
#include "host/view/page_files.h"

namespace impactdic::view {
namespace {

using Json = nlohmann::json;

PageAnswer as_json(const Json& value) {
  return {200, "application/json", value.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

PageAnswer as_bytes(std::string bytes) {
  return {200, "application/octet-stream", std::move(bytes)};
}

PageAnswer as_floats(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return as_bytes(std::move(bytes));
}

bool ends_with(const std::string& name, const char* end) {
  return std::string_view(name).ends_with(end);
}

PageAnswer page_file(const std::string& name) {
  const auto found = page_files().find(name.empty() ? "index.html" : name);
  if (found == page_files().end()) throw NotThere("there is nothing of that name");
  const PageFile& file = found->second;
  std::string type = "text/html; charset=utf-8";
  if (ends_with(found->first, ".js")) type = "text/javascript; charset=utf-8";
  if (ends_with(found->first, ".css")) type = "text/css; charset=utf-8";
  if (ends_with(found->first, ".svg")) type = "image/svg+xml";
  return {200, type, std::string(file.bytes), file.gzipped};
}

Json describe_clip(const Shot& shot) {
  if (!shot.source()) return nullptr;
  const ClipInfo& info = shot.source()->info();
  const double fps = shot.clip().fps > 0 ? shot.clip().fps : info.fps.value_or(0);
  return {{"path", info.path},
          {"format", info.format},
          {"width", info.width},
          {"height", info.height},
          {"bits", info.bits},
          {"frames", info.frame_count},
          {"fps", fps > 0 ? Json(fps) : Json(nullptr)},
          {"warnings", info.warnings},
          {"black", shot.contrast().black},
          {"white", shot.contrast().white}};
}

Json describe_fields(Shot& shot) {
  const auto fields = shot.fields();
  if (!fields) return nullptr;
  return {{"columns", FieldFrames::kColumns},
          {"rows", fields->rows()},
          {"windows", fields->windows()},
          {"frames", fields->frames()}};
}

std::size_t whole(const PageRequest& request, const std::string& key) {
  const std::int64_t value = parse_int(request.text(key), key);
  if (value < 0) throw InvalidArgument("must be 0 or more", key);
  return static_cast<std::size_t>(value);
}

// As the request asks, else as the shot's first picture has it.
Contrast contrast_of(const PageRequest& request, const Shot& shot) {
  if (request.text("black").empty()) return shot.contrast();
  return {parse_double(request.text("black"), "black"),
          parse_double(request.text("white"), "white")};
}

namespace fs = std::filesystem;

// A run that did not come to its end has left no summary, or one that says so.
bool can_go_on(const fs::path& folder) {
  if (!fs::exists(folder / "resume.json")) return false;
  std::ifstream file(folder / "summary.json");
  const Json summary = Json::parse(file, nullptr, false);
  return !summary.is_object() || summary.value("cancelled", false);
}

// Where the next run may write: the folder of results that are not complete, else a new one beside
// where the program was started.
std::string propose_folder(const Shot& shot) {
  const fs::path folder = shot.folder();
  if (!folder.empty() && can_go_on(folder)) return folder.string();
  const std::string clip = shot.clip().paths.empty() ? "clip" : shot.clip().paths.front();
  const std::string stem = fs::path(clip).stem().string() + "_results";
  std::string name = stem;
  for (int k = 2; fs::exists(name); ++k) name = stem + "_" + std::to_string(k);
  return name;
}

Json read_body(const PageRequest& request) {
  Json body = Json::parse(request.body, nullptr, false);
  if (!body.is_object()) throw InvalidArgument("the request is no JSON object");
  return body;
}

// A member of the body; what it is not there for is as `absent`.
template <typename T>
T member(const Json& body, const char* key, const T& absent) {
  const auto found = body.find(key);
  if (found == body.end()) return absent;
  try {
    return found->get<T>();
  } catch (const Json::exception&) {
    throw InvalidArgument("the value has another type", key);
  }
}

}  // namespace

PageAnswer Answers::operator()(const PageRequest& request) {
  if (request.changes) return change(request);
  if (request.name == "api/state") return state(request);
  if (request.name == "api/frame") return picture(request);
  if (request.name == "api/file") return file(request);
  if (request.name == "api/field") return field(request);
  if (request.name == "api/history") return history(request);
  if (request.name == "api/film") return film(request);
  if (request.name == "api/run") return as_json(run_.status(whole(request, "from")));
  return page_file(request.name);
}

// All that the page must know at first of a shot.
PageAnswer Answers::state(const PageRequest& request) {
  Json state = {{"title", target_.title()}, {"version", IMPACTDIC_VERSION}};
  state["plots"] = page_files().count("plotly.js") > 0;
  state["films"] = video::has_codecs();
  state["shots"] = target_.shots();
  state["shots_table"] = target_.shots_table();
  state["excluded"] = target_.excluded();
  state["parameters"] = Json::parse(target_.parameters());
  const std::string name = request.text("shot");
  state["files"] = Json::array();
  for (const char* key : {"clip", "fields", "given"}) state[key] = nullptr;
  for (const char* key : {"clip_error", "folder", "proposed"}) state[key] = "";
  state["settings"] = describe_settings();
  const bool several = !target_.shots().empty() || !target_.shots_table().empty();
  if (name.empty() && several) return as_json(state);
  const auto shot = target_.shot(name);
  state["clip"] = describe_clip(*shot);
  state["clip_error"] = shot->clip_error();
  state["folder"] = shot->folder().string();
  state["files"] = shot->text_files();
  state["fields"] = describe_fields(*shot);
  state["given"] = settings_of_results(shot->folder());
  state["proposed"] = propose_folder(*shot);
  return as_json(state);
}

PageAnswer Answers::picture(const PageRequest& request) {
  const auto shot = target_.shot(request.text("shot"));
  const Contrast contrast = contrast_of(request, *shot);
  const int shrink = request.text("shrink").empty()
                         ? 1
                         : static_cast<int>(std::min<std::size_t>(whole(request, "shrink"), 1000));
  const auto frame = static_cast<std::int64_t>(whole(request, "frame"));
  return as_bytes(shot->picture(frame, contrast, shrink));
}

PageAnswer Answers::file(const PageRequest& request) {
  return {200, "text/plain; charset=utf-8",
          target_.shot(request.text("shot"))->text(request.text("name"))};
}

PageAnswer Answers::field(const PageRequest& request) {
  const auto fields = target_.shot(request.text("shot"))->fields();
  if (!fields) throw NotThere("there are no fields");
  return as_floats(fields->frame(whole(request, "row")));
}

PageAnswer Answers::history(const PageRequest& request) {
  const auto fields = target_.shot(request.text("shot"))->fields();
  if (!fields) throw NotThere("there are no fields");
  return as_floats(fields->history(whole(request, "window")));
}

PageAnswer Answers::film(const PageRequest& request) {
  const auto shot = target_.shot(request.text("shot"));
  FilmRequest asked;
  asked.first = static_cast<std::int64_t>(whole(request, "first"));
  asked.end = static_cast<std::int64_t>(whole(request, "end"));
  asked.step = static_cast<std::int64_t>(whole(request, "step"));
  asked.rate = parse_double(request.text("rate"), "rate");
  asked.contrast = contrast_of(request, *shot);
  const std::lock_guard<std::mutex> one_at_a_time(filming_);
  return {200, "video/mp4", film_of(*shot, asked)};
}

PageAnswer Answers::change(const PageRequest& request) {
  const bool known = request.name == "api/measure" || request.name == "api/job" ||
                     request.name == "api/run" || request.name == "api/stop" ||
                     request.name == "api/exclude";
  if (!known) throw NotThere("there is nothing of that name");
  const Json body = read_body(request);
  if (request.name == "api/stop") {
    run_.stop();
    return as_json(Json::object());
  }
  if (request.name == "api/exclude") {
    target_.exclude(member(body, "shot", std::string()), member(body, "reason", std::string()));
    return as_json({{"excluded", target_.excluded()}});
  }
  const auto shot = target_.shot(member(body, "shot", std::string()));
  TrackJob job = read_job(member(body, "settings", Json::object()), shot->clip());
  if (request.name == "api/measure") {
    return as_json(measurer_.measure(*shot, job, member(body, "frame", std::int64_t{-1}),
                                     member(body, "outline", false)));
  }
  job.folder.folder = member(body, "folder", std::string());
  job.folder.force = member(body, "force", false);
  job.folder.resume = member(body, "resume", false);
  if (request.name == "api/job") return describe_job(job);
  run_.start(shot, job);
  return as_json(Json::object());
}

// As a command and as the job.toml that a run of it writes.
PageAnswer Answers::describe_job(const TrackJob& job) const {
  run::SettingWriter settings;
  run::visit_track(settings, job.request, job.folder);
  run::visit_session(settings, session_.options());
  return as_json(
      {{"command", command_line(job)}, {"toml", run::job_text("track", settings.values())}});
}

}  // namespace impactdic::view
