// `track` with files at its edge.
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "host/base/stopwatch.h"
#include "host/base/toml_text.h"
#include "host/clip/ball_by_hand.h"
#include "host/report/advice_json.h"
#include "host/report/impact_json.h"
#include "host/report/picture/key_frames.h"
#include "host/report/summary.h"
#include "host/run/folder.h"
#include "host/run/open_clip.h"
#include "host/run/results/kept_points.h"
#include "host/run/results/result_digests.h"
#include "host/run/session.h"
#include "host/run/settings/job_file.h"
#include "host/run/track/track_files.h"
#include "host/run/track/track_run.h"
#include "host/shake/camera_motion.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

std::string what_needs_the_rate(const TrackFolder& folder) {
  return folder.overlay.wanted && folder.overlay.slow_motion > 0 ? "--slow-motion" : "";
}

run::TrackFilesOptions files_options(const TrackRequest& request, const TrackFolder& folder,
                                     const TrackResult& result) {
  run::TrackFilesOptions options;
  options.scale = result.scale;
  options.window_px = request.field.window_px;
  options.compression = folder.compression;
  options.with_field = request.with_field;
  options.with_poses = request.with_field && request.estimator == Estimator::kBall;
  options.overlay = folder.overlay;
  options.roi = result.roi;
  options.camera = request.camera;
  return options;
}

// Where the scale comes from, and what its deviation is made of.
nlohmann::json describe_scale(const TrackRequest& request, const TrackResult& result) {
  if (!(result.scale.metre_per_px > 0)) return nullptr;
  nlohmann::json scale = {{"m_per_px", result.scale.metre_per_px},
                          {"sd_m_per_px", result.scale.metre_per_px_sd}};
  if (request.mm_per_px > 0) {
    scale["from"] = "--mm-per-px";
    return scale;
  }
  if (request.ball_diameter_mm == 0) {
    scale["from"] = "--camera";
    scale["sd_m_per_px"] = result.camera->metre_per_px.sd;
    return scale;
  }
  const double radius_px = request.ball_diameter_mm / 2e3 / result.scale.metre_per_px;
  const double given = request.ball_diameter_sd_mm / request.ball_diameter_mm;
  const double all = result.scale.metre_per_px_sd / result.scale.metre_per_px;
  const double by_radius = std::sqrt(std::max(0.0, all * all - given * given));
  scale["from"] = "--ball-diameter-mm";
  scale["radius_px"] = {{"value", radius_px}, {"sd", by_radius * radius_px}};
  scale["radius_frames"] = result.impact.radius_frames;
  scale["sd_parts_m_per_px"] = {{"radius", by_radius * result.scale.metre_per_px},
                                {"diameter", given * result.scale.metre_per_px}};
  return scale;
}

nlohmann::json describe_camera(const TrackRequest& request, const TrackResult& result) {
  if (!result.camera) return nullptr;
  const CameraFigures& camera = *result.camera;
  const auto measured = [](const Measured& m) -> nlohmann::json {
    if (!std::isfinite(m.value)) return nullptr;
    return {{"value", m.value}, {"sd", m.sd}};
  };
  return {{"file", request.camera},
          {"from", camera.from},
          {"m_per_px", measured(camera.metre_per_px)},
          {"tilt_deg", std::isfinite(camera.tilt_deg) ? nlohmann::json(camera.tilt_deg)
                                                      : nlohmann::json(nullptr)},
          {"ball_before_plane_m", measured(camera.before_plane_m)}};
}

// The whole calibration, so that fields can be put into metres where its file is not.
void describe_calibration(const TrackRequest& request, report::Attributes& attributes) {
  constexpr std::size_t kMostBytes = 60000;  // HDF5 takes attributes of less than 64 KB
  if (request.camera.empty()) return;
  std::string text = read_toml_text(request.camera);
  if (text.size() <= kMostBytes) attributes["camera_calibration"] = std::move(text);
}

nlohmann::json describe_times(const FrameTimes& times) {
  nlohmann::json described = {{"from_file", times.measured}, {"missing_frames", times.missing}};
  described["jitter_s"] = times.measured ? nlohmann::json(times.jitter_s) : nlohmann::json(nullptr);
  if (times.missing > 0) described["missing_after_frame"] = times.missing_after;
  return described;
}

nlohmann::json describe(const std::optional<Measured>& figure) {
  if (!figure) return nullptr;
  return {{"value", figure->value}, {"sd", figure->sd}};
}

nlohmann::json describe(const std::optional<CameraMotion>& motion) {
  if (!motion) return nullptr;
  const shake::MotionExtent extent = shake::extent_of(*motion);
  return {{"farthest_px", extent.farthest_px},
          {"largest_step_px", extent.largest_step_px},
          {"frames_unknown", extent.unknown},
          {"file", "camera_motion.csv"}};
}

nlohmann::json summarise(const TrackRequest& request, const TrackRows& rows,
                         const TrackResult& result, const Session& session) {
  nlohmann::json summary = report::summarise_track(rows, result);
  summary["analysed_fps_sd"] =
      result.scale.fps > 0 ? nlohmann::json(result.scale.fps_sd) : nlohmann::json(nullptr);
  summary["frame_times"] = describe_times(result.times);
  summary["scale"] = describe_scale(request, result);
  summary["camera"] = describe_camera(request, result);
  summary["camera_motion"] = describe(result.camera_motion);
  summary["impact"] = report::describe_impact(result.impact_si);
  summary["more_impacts"] = nlohmann::json::array();
  for (const ImpactFigures& other : result.more_impacts_si) {
    summary["more_impacts"].push_back(report::describe_impact(other));
  }
  summary["body"] = {{"kind", to_string(result.body)},
                     {"asked", to_string(request.body)},
                     {"reason", result.body_reason}};
  if (std::isfinite(result.sphere_radius_px.value)) {
    summary["body"]["radius_px"] = {{"value", result.sphere_radius_px.value},
                                    {"sd", result.sphere_radius_px.sd}};
    summary["body"]["radius_over_distance"] = {{"value", result.sphere_nearness.value},
                                               {"sd", result.sphere_nearness.sd},
                                               {"from", result.nearness_from}};
  }
  summary["device"] = request.with_field ? run::describe_device(session) : nlohmann::json(nullptr);
  summary["advice"] = report::describe_advice(result.advice);
  summary["warnings"] = result.warnings;
  if (result.seconds > 0) {
    summary["frames_per_s"] = result.frames_per_s;
  } else {
    summary["frames_per_s"] = nullptr;  // an earlier run had measured all of them
  }
  summary["gravity_angle_deg"] = request.gravity_angle_deg;
  if (result.cancelled) summary["cancelled"] = true;
  return summary;
}

// Of a run before, where they differ from those asked for.
using EarlierCorrections = std::optional<std::vector<BallByHand>>;
const EarlierCorrections kSame;

// Throws InvalidArgument where the earlier job differs in more.
EarlierCorrections earlier_corrections(const fs::path& folder, const run::SettingWriter& settings,
                                       const TrackRequest& request) {
  run::require_same_job(folder / "job.toml", settings);
  std::vector<BallByHand> balls = run::corrections_of(folder / "job.toml");
  if (!first_difference(balls, in_order(request.ball_at))) return std::nullopt;
  return balls;
}

// The first row that may differ from that of a run with other corrections; nullopt where none does.
std::optional<std::int64_t> first_row_changed(const run::TrackRun& run, const TrackRequest& request,
                                              const std::vector<BallByHand>& earlier) {
  const std::optional<double> found = run.scouted()->radius_px();
  // The radius is looked for from the first frame on.
  if (radius_by_hand(found, earlier) != radius_by_hand(found, request.ball_at)) return 0;
  const pipeline::TrackOptions& options = run.options();
  return first_difference(as_analysed(earlier, options.frames, options.roi), options.ball.by_hand);
}

// Takes the results in the folder back to where the corrections change nothing yet; false where all
// of them are to be measured anew.
bool go_back(const fs::path& folder, const run::TrackRun& run,
             const std::optional<std::int64_t>& row, bool overlay, run::Caller& caller) {
  if (!row) return true;
  // Pictures with the words of another ending are not painted over.
  const auto from = overlay ? std::nullopt : run::KeptPoints::go_back(folder, *row);
  caller.say(MessageKind::kNote, from ? "corrected by hand: measured again from frame " +
                                            std::to_string(run.options().frames.at(*from)) + " on"
                                      : "corrected by hand: all frames are measured again");
  return from.has_value();
}

// Whether the rows must be in the result.
bool needs_rows(const TrackRequest& request, const TrackFolder& folder) {
  return folder.keep_rows || folder.overlay.wanted || !request.camera.empty();
}

// Rows, fields and points into the files; rows to the sink as well, where there is one.
run::TrackRun::Outputs into(run::TrackFiles& files, int window_px, const TrackSink& sink) {
  run::TrackRun::Outputs outputs;
  outputs.from = files.resume_point();
  outputs.grid = [&files](std::span<const Window> grid, double radius_px) {
    files.set_grid(grid, radius_px);
  };
  outputs.frame = [&files, &sink, window_px](const pipeline::TrackedFrame& frame) {
    files.add(frame);
    if (sink) run::hand_on(frame, window_px, sink);
  };
  outputs.checkpoint = [&files](const pipeline::ResumePoint& point) { files.reach(point); };
  return outputs;
}

}  // namespace

void TrackFolder::validate() const {
  if (folder.empty()) throw InvalidArgument("the output folder has no name", "--output");
  run::check_compression(compression);
  if (!(overlay.slow_motion >= 0) || !std::isfinite(overlay.slow_motion)) {
    throw InvalidArgument("must be 0 or more, not " + shortest(overlay.slow_motion),
                          "--slow-motion");
  }
  if (!(overlay.arrow_scale >= 0) || !std::isfinite(overlay.arrow_scale)) {
    throw InvalidArgument("must be 0 or more, not " + shortest(overlay.arrow_scale),
                          "--arrow-scale");
  }
}

TrackResult track_to_folder(const TrackRequest& request, const TrackFolder& folder,
                            Session& session, const RunControl& control, const TrackSink& sink) {
  folder.validate();
  run::Caller caller(control);
  TrackResult result;
  run::TrackRun run(request, session, caller, result, what_needs_the_rate(folder));
  const run::OutputFolder output(folder.folder, folder.force || folder.resume);
  const fs::path& path = output.path();
  run::SettingWriter settings;
  run::visit_track(settings, request, folder);
  run::TrackFilesOptions options = files_options(request, folder, result);
  options.folder = path;
  settings.describe(options.attributes);
  describe_calibration(request, options.attributes);
  run::visit_session(settings, session.options());
  options.rows = result.frames.count();
  options.resume = folder.resume && run::TrackFiles::can_go_on(path, options.rows);
  const auto corrected = options.resume ? earlier_corrections(path, settings, request) : kSame;
  const bool goes_on = options.resume;
  run.look();
  options.attributes.merge(run::attributes_of(session, run.info()));
  if (goes_on && result.body == Body::kSphere) run::require_same_sight(path / "job.toml", settings);
  if (corrected) {
    options.resume = go_back(path, run, first_row_changed(run, request, *corrected),
                             folder.overlay.wanted, caller);
  }
  // Nothing earlier is given up before all that this run needs is there, a device as well.
  run::begin_results(path, "track", settings, options.resume);

  auto files = std::make_unique<run::TrackFiles>(std::move(options));
  run::DigestBeside digest(request.clip, run.info(), folder.checksum);
  RowStore store(path);
  if (!needs_rows(request, folder)) run.keep_rows_in(store);
  run.take_up(files->take_earlier_rows());
  const run::TrackRun::Outputs outputs = into(*files, request.field.window_px, sink);
  const auto finish = [&] {
    session.impl().close_beside();
    run.conclude();
    files->finish(run.rows(), result);
    nlohmann::json summary = summarise(request, run.rows(), result, session);
    summary["surface_in_picture_deg"] = describe(run.surface_in_picture());
    const Stopwatch waiting;
    const video::ClipDigest found = digest.get();
    if (digest.wanted()) files->set_source_digest(found);
    summary["checksum_wait_s"] = waiting.seconds();
    summary["input"] = report::describe_input(run.info(), found);
    summary["key_frames"] =
        report::write_key_frames(run.source(), run.rows(), result.impact_si, path);
    report::write_json(path / "summary.json", summary);
    files.reset();
    if (folder.checksum) run::write_digests(path);
  };
  try {
    if (!files->is_complete()) run.measure(outputs);
  } catch (...) {
    finish();  // what was measured is kept
    throw;
  }
  finish();
  return result;
}

}  // namespace impactdic
