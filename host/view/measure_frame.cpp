#include "host/view/measure_frame.h"

#include <impactdic/error.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/base/json_number.h"
#include "host/base/parse.h"
#include "host/base/stopwatch.h"
#include "host/report/advice_json.h"
#include "host/report/csv.h"
#include "host/run/control.h"
#include "host/run/settings/job_file.h"
#include "host/run/track/track_run.h"
#include "host/view/field_frames.h"

namespace impactdic::view {
namespace {

using Json = nlohmann::json;

// In the order of FieldFrames::kColumns.
void add_window(const WindowResult& window, std::array<Json, FieldFrames::kColumns.size()>& to) {
  const std::array values = {
      window.x_px,
      window.y_px,
      double{window.u_px},
      double{window.v_px},
      double{window.u_sd_px},
      double{window.v_sd_px},
      double{window.correlation},
      double{window.peak_ratio},
      double{window.ux},
      double{window.uy},
      double{window.vx},
      double{window.vy},
      static_cast<double>(window.status),
  };
  static_assert(std::tuple_size_v<decltype(values)> == FieldFrames::kColumns.size());
  for (std::size_t i = 0; i < values.size(); ++i) to[i].push_back(json_number(values[i]));
}

Json describe_field(const FieldView& field) {
  std::array<Json, FieldFrames::kColumns.size()> columns;
  columns.fill(Json::array());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const WindowResult window = field[i];
    if (window.status != WindowStatus::kMasked) add_window(window, columns);
  }
  return columns;
}

Json cells(const TrackRow& row, const SiScale& scale) {
  const std::vector<std::string> names = split(report::kTrackCsvHeader, ',');
  const std::vector<std::string> values = split(report::track_csv_line(row, scale), ',');
  Json named = Json::object();
  for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
    named[names[i]] = values[i];
  }
  return named;
}

// All that scouting goes by, so that it is done once while other settings change.
std::string scouting_of(const Shot& shot, const TrackRequest& request) {
  run::SettingWriter settings;
  settings(run::Setting{"frames"}, request.frames);
  settings(run::Setting{"roi"}, request.roi);
  settings(run::Setting{"polygon"}, request.polygon);
  settings(run::Setting{"radius-px"}, request.radius_px);
  return shot.folder().string() + run::job_text(shot.source()->info().path, settings.values());
}

}  // namespace

Json FrameMeasurer::measure(const Shot& shot, TrackJob job, std::int64_t frame, bool outline) {
  if (!shot.source()) throw FileError(shot.clip_error());
  const std::int64_t frames = shot.source()->info().frame_count;
  if (frame < 0 || frame >= frames) throw InvalidArgument("the clip has no such frame", "frame");
  const std::uint64_t mine = ++latest_;
  const auto overtaken = [&] { return latest_ != mine; };
  const std::lock_guard<std::mutex> lock(mutex_);
  if (overtaken()) throw Overtaken("another request has taken this one's place");
  const Stopwatch watch;
  job.request.clip.source = shot.source();
  const std::int64_t step = job.request.frames.step;
  job.request.frames = {frame, std::min(frames, frame + step + 1), step};
  if (outline) job.request.with_field = false;

  Json field = Json::array();
  const TrackSink sink = [&](const TrackedFrame& tracked) {
    if (tracked.row.frame == frame) field = describe_field(tracked.field);
  };
  std::vector<std::string> notes;
  RunControl control;
  control.cancelled = overtaken;
  control.message = [&](const Message& message) {
    if (message.kind == MessageKind::kNote) notes.push_back(message.text);
  };
  TrackResult result;
  run::Caller caller(control);
  run::TrackRun run(job.request, session_, caller, result);
  const std::string looked_at = scouting_of(shot, job.request);
  if (looked_at == looked_at_ && scouted_) run.know(*scouted_);
  outline ? run.look_for_ball() : run.look();
  looked_at_ = looked_at;
  scouted_ = run.scouted();
  run::TrackRun::Outputs outputs;
  outputs.frame = [&](const pipeline::TrackedFrame& tracked) {
    run::hand_on(tracked, job.request.field.window_px, sink);
  };
  run.measure(outputs);
  run.conclude();
  if (overtaken() || result.rows.empty()) {
    throw Overtaken("another request has taken this one's place");
  }
  Json answer = {{"frame", frame}, {"columns", FieldFrames::kColumns}};
  answer["row"] = cells(result.rows.front(), result.scale);
  answer["windows"] = std::move(field);
  answer["advice"] = report::describe_advice(result.advice);
  answer["notes"] = notes;
  answer["warnings"] = result.warnings;
  answer["m_per_px"] = result.scale.metre_per_px > 0 ? Json(result.scale.metre_per_px) : Json();
  answer["ms"] = 1e3 * watch.seconds();
  return answer;
}

}  // namespace impactdic::view
