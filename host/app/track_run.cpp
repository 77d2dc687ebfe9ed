#include "host/app/track_run.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <set>

#include "host/app/advice_output.h"
#include "host/app/job.h"
#include "host/app/key_frames.h"
#include "host/app/track_output.h"
#include "host/base/parse.h"
#include "host/pipeline/track_clip.h"

namespace impactdic::app {
namespace {

// Options that --resume may be given otherwise: they say nothing of how a frame is measured.
const std::set<std::string> kMayChange = {
    "device",         "threads",           "ball-diameter-mm",
    "mm-per-px",      "surface-angle-deg", "gravity-angle-deg",
    "inertia-factor", "overlay",           "slow-motion",
    "arrow-scale",    "no-checksum",       "compress"};

std::optional<std::pair<double, double>> parse_radius(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto range = parse_doubles(text, ':', 2, "--radius-px");
  if (range[0] <= 0 || range[1] <= range[0]) {
    throw InvalidArgument("'" + text + "' is not LO:HI with 0 < LO < HI", "--radius-px");
  }
  return std::pair(range[0], range[1]);
}

pipeline::TrackOptions resolve_options(const TrackRequest& request, const ClipInfo& info) {
  pipeline::TrackOptions options;
  options.estimator.estimator = motion::parse_estimator(request.estimator);
  options.estimator.field = resolve(request.field);
  options.estimator.spacing_px = request.field.spacing_px;
  options.ball.circle.radius_range_px = parse_radius(request.radius);
  options.frames = parse_frame_range(request.frames, info.frame_count);
  options.roi = parse_roi(request.roi, info.width, info.height);
  options.with_field = !request.no_field;
  const bool si = request.ball_diameter_mm > 0 || request.mm_per_px > 0;
  const bool slowed = request.overlay.wanted && request.overlay.slow_motion > 0;
  options.fps = resolve_fps(request.video, info,
                            si       ? "a velocity in m/s"
                            : slowed ? "--slow-motion"
                                     : "");
  return options;
}

// Metres a pixel as far as they are known before the ball is: from --mm-per-px.
SiScale resolve_scale(const TrackRequest& request, const pipeline::TrackOptions& options,
                      const ClipInfo& info) {
  SiScale scale;
  scale.metre_per_px = request.mm_per_px * 1e-3;
  scale.fps = options.fps / static_cast<double>(options.frames.step);
  scale.surface_angle_rad = request.surface_angle_deg * kRadPerDeg;
  scale.image_height = info.height;
  return scale;
}

report::ImpactSetup impact_setup(const TrackRequest& request) {
  report::ImpactSetup setup;
  setup.gravity_angle_rad = request.gravity_angle_deg * kRadPerDeg;
  if (request.inertia_factor > 0) setup.inertia_factor = request.inertia_factor;
  return setup;
}

std::int64_t frames_ok(const std::vector<TrackRow>& rows) {
  return std::count_if(rows.begin(), rows.end(), [](const TrackRow& row) {
    return row.status == TrackStatus::ok || row.status == TrackStatus::last_frame;
  });
}

ClipAdvice look_at(FrameSource& source, const pipeline::TrackOptions& options) {
  advice::AdviceRequest request;
  request.frames = options.frames;
  request.roi = options.roi;
  request.circle = options.ball.circle;
  request.estimator = options.estimator.estimator;
  request.field = options.estimator.field;
  request.with_field = options.with_field;
  request.rim_margin_px = options.estimator.rim_margin_px;
  return advice::advise_clip(source, request);
}

std::vector<std::string> warnings_of(const TrackRequest& request, const ClipInfo& info,
                                     const ClipAdvice& advice) {
  std::vector<std::string> warnings = all_warnings(request.video, info, advice);
  if (request.ball_diameter_mm == 0 && request.mm_per_px == 0) {
    warnings.push_back(
        "no scale is given: results are in pixels only; --ball-diameter-mm or --mm-per-px gives "
        "metres");
  }
  return warnings;
}

}  // namespace

void check_settings(const TrackRequest& request) {
  resolve(request.field);
  parse_radius(request.radius);
  motion::parse_estimator(request.estimator);
  if (request.ball_diameter_mm > 0 && request.mm_per_px > 0) {
    throw InvalidArgument("give one of --ball-diameter-mm and --mm-per-px", "scale");
  }
}

TrackOutcome track_to_folder(const CLI::App& command, const TrackRequest& request,
                             RunContext& run) {
  check_settings(request);
  const auto source = open_requested(request.video);
  const ClipInfo& info = source->info();
  pipeline::TrackOptions options = resolve_options(request, info);
  const SiScale scale = resolve_scale(request, options, info);
  const auto folder =
      prepare_output_directory(request.output, request.common.force || request.resume);
  if (request.resume && std::filesystem::exists(folder / "resume.json")) {
    require_same_job(command, folder / "job.toml", kMayChange);
  }
  write_job(command, folder / "job.toml");

  const ClipAdvice advice = look_at(*source, options);
  if (advice.texture) options.estimator.field.noise = advice.texture->noise;
  const std::vector<std::string> warnings = warnings_of(request, info, advice);
  if (!request.common.quiet) print_advice(advice, warnings);

  OutputOptions output_options;
  output_options.folder = folder;
  output_options.scale = scale;
  output_options.ball_diameter_m = request.ball_diameter_mm * 1e-3;
  output_options.window_px = options.estimator.field.window_px;
  output_options.compression = request.field.compression;
  output_options.with_field = options.with_field;
  output_options.with_poses =
      options.with_field && options.estimator.estimator == motion::Estimator::ball;
  output_options.overlay = request.overlay;
  output_options.impact = impact_setup(request);
  output_options.resume = request.resume;
  output_options.roi = options.roi;
  output_options.attributes = run.attributes(info);
  describe(request.field, output_options.attributes);
  output_options.attributes["option_estimator"] = request.estimator;
  TrackOutput output(output_options);
  // Beside the run: a digest of a long clip takes longer than a fast device.
  std::future<video::ClipDigest> digest;
  if (!request.no_checksum)
    digest = std::async(std::launch::async, video::digest_of, std::cref(info), video::kDigestPiece);
  options.from = output.resume_point();
  options.checkpoint = [&](const pipeline::ResumePoint& point) { output.reach(point); };
  const std::int64_t to_do = options.frames.count() - (options.from ? options.from->next_row : 0);

  options.times = run.stage_times();
  Stopwatch watch;
  const auto finish = [&] {
    nlohmann::json summary = output.finish();
    summary["device"] = run.describe();
    summary["advice"] = describe_advice(advice);
    summary["warnings"] = warnings;
    const double rate = static_cast<double>(to_do) / watch.seconds();
    summary["frames_per_s"] = rate;
    const Stopwatch waiting;
    const video::ClipDigest found = digest.valid() ? digest.get() : video::ClipDigest{};
    if (!request.no_checksum) output.set_source_digest(found);
    summary["checksum_wait_s"] = waiting.seconds();
    summary["input"] = report::describe_input(info, found);
    summary["gravity_angle_deg"] = request.gravity_angle_deg;
    summary["key_frames"] = write_key_frames(*source, output.rows(), summary["impact"], folder);
    report::write_json(folder / "summary.json", summary);
    return rate;
  };
  try {
    TerminalProgress progress("track", request.common.quiet);
    pipeline::track_clip(
        *source, run.engines(), options,
        [&](std::span<const Window> grid, double radius) { output.set_grid(grid, radius); },
        [&](const pipeline::TrackedFrame& frame) { output.add(frame); }, std::ref(progress));
  } catch (...) {
    finish();  // what was measured is kept
    throw;
  }
  TrackOutcome outcome;
  outcome.frames_per_s = finish();
  outcome.frames = options.frames.count();
  run.print_stages(static_cast<double>(to_do) / outcome.frames_per_s, to_do);
  outcome.frames_ok = frames_ok(output.rows());
  outcome.impact = output.impact_line();
  return outcome;
}

void add_track_settings(CLI::App& command, TrackRequest& request) {
  command.add_option("--ball-diameter-mm", request.ball_diameter_mm, "Scale: the ball's diameter")
      ->check(positive_number());
  command.add_option("--mm-per-px", request.mm_per_px, "Scale: millimetres a pixel")
      ->check(positive_number());
  command
      .add_option("--surface-angle-deg", request.surface_angle_deg,
                  "Inclination of the surface, counter-clockwise from image-right")
      ->capture_default_str();
  command
      .add_option("--gravity-angle-deg", request.gravity_angle_deg,
                  "Direction of gravity, counter-clockwise from image-right")
      ->capture_default_str();
  command
      .add_option("--inertia-factor", request.inertia_factor,
                  "I / (m R^2) of the ball: 0.667 hollow, 0.4 solid; for rolling cap and closure")
      ->check(CLI::Range(0.01, 1.0));
  command.add_option("--frames", request.frames, "A:B[:STEP]: frames analysed, B excluded");
  command.add_option("--roi", request.roi, "X,Y,W,H: the rectangle that is looked at, px");
  command.add_option("--radius-px", request.radius, "LO:HI: range of the ball's radius, px");
  command
      .add_option(
          "--estimator", request.estimator,
          "How the motion is measured: ball (one registration of the whole ball, the most exact, "
          "and "
          "poses without drift), field (windows alone) or ring (rotation from rings, any angle)")
      ->capture_default_str();
  add_field_options(command, request.field);
  command.add_flag("--no-field", request.no_field, "Circle only: no displacement field");
  command.add_flag("--no-checksum", request.no_checksum,
                   "Leave out the clip's SHA-256 (it reads the whole clip once more)");
  command.add_flag("--overlay", request.overlay.wanted,
                   "Annotated frames as PNGs and as MP4: circle, path, arrows, phase, spin");
  command
      .add_option("--slow-motion", request.overlay.slow_motion,
                  "How many times slower than life the overlay's video plays; 0: every frame, 25 "
                  "a second")
      ->check(non_negative_number())
      ->capture_default_str();
  command
      .add_option("--arrow-scale", request.overlay.arrow_scale,
                  "Length of the overlay's arrows over the displacement to the next frame")
      ->check(positive_number())
      ->capture_default_str();
}

void add_track_options(CLI::App& command, TrackRequest& request) {
  add_video_options(command, request.video);
  command.add_option("-o,--output", request.output, "Folder for the results")->required();
  add_track_settings(command, request);
  command.add_flag("--resume", request.resume, "Go on where an earlier run into the folder ended");
  add_common_options(command, request.common);
}

}  // namespace impactdic::app
