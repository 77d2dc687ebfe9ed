#include "host/run/track/track_run.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host/advice/clip_advice.h"
#include "host/base/stopwatch.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/pipeline/rows/fill_row.h"
#include "host/pipeline/track_round.h"
#include "host/report/words.h"
#include "host/run/expected_programs.h"
#include "host/run/metres/camera_part.h"
#include "host/run/metres/frame_clock.h"
#include "host/run/metres/impact_figures.h"
#include "host/run/metres/lens/lens_check.h"
#include "host/run/metres/lens/oval_outline.h"
#include "host/run/metres/lost_frames.h"
#include "host/run/metres/scale.h"
#include "host/run/metres/sphere_sight.h"
#include "host/run/metres/surface_edge.h"
#include "host/run/open_clip.h"
#include "host/run/session.h"
#include "host/run/track/rough_path.h"
#include "host/run/track/step_scatter.h"
#include "host/shake/camera_motion.h"
#include "host/shake/shared_motion.h"

namespace impactdic {
namespace run {

TrackRun::TrackRun(const TrackRequest& request, Session& session, Caller& caller,
                   TrackResult& result, const std::string& needs_rate)
    : request_(request), session_(session), caller_(caller), result_(result) {
  request.validate();
  std::promise<ClipInfo> clip;
  if (request.with_field) {
    session.impl().open_beside(expected_programs(request, clip.get_future().share()));
  }
  source_ = open_requested(request.clip);
  clip.set_value(info());
  result_ = {};
  result_.clip = info();
  if (!request.camera.empty()) {
    camera_ = read_camera(request.camera);
    check_camera_fits(*camera_, info(), request.camera);
  }
  options_.estimator.estimator = request.estimator;
  options_.estimator.field = request.field;
  options_.estimator.field.noise = 0;
  options_.estimator.spacing_px = request.spacing_px;
  if (request.radius_px) {
    options_.ball.circle.radius_range_px = {request.radius_px->low_px, request.radius_px->high_px};
  }
  if (request.body != Body::kAuto) options_.ball.circle.sphere = request.body == Body::kSphere;
  options_.frames = result_.frames = resolve(request.frames, info().frame_count);
  options_.roi = request.roi.value_or(Roi{0, 0, info().width, info().height});
  check_roi(options_.roi, info().width, info().height);
  result_.roi = options_.roi;
  take_limits();
  options_.with_field = request.with_field;
  const bool si = request.ball_diameter_mm > 0 || request.mm_per_px > 0 || camera_;
  options_.fps = resolve_fps(request.clip, info(), si ? "a velocity in m/s" : needs_rate);
  options_.cancelled = [this] { return caller_.cancelled(); };
  // As far as it is known before the ball is.
  result_.scale.metre_per_px = request.mm_per_px * 1e-3;
  FrameClock clock = read_clock(*source_, options_.frames, request.clip.fps > 0, options_.fps);
  result_.times = clock.times;
  result_.scale.fps = clock.fps;
  result_.scale.fps_sd = clock.fps_sd;
  options_.fps = clock.fps * static_cast<double>(options_.frames.step);
  options_.periods = std::move(clock.periods);
  clock_warnings_ = std::move(clock.warnings);
  result_.scale.surface_angle_rad = request.surface_angle_deg * kRadPerDeg;
  result_.scale.image_height = info().height;
}

void TrackRun::take_limits() {
  check_balls_by_hand(request_.ball_at, info());
  options_.ball.by_hand = as_analysed(request_.ball_at, options_.frames, options_.roi);
  if (request_.polygon.empty()) return;
  options_.ball.circle.region = std::make_shared<Image<std::uint8_t>>(
      cut(polygon_mask(request_.polygon, info().width, info().height), options_.roi));
}

void TrackRun::look() {
  advice::AdviceRequest request;
  request.frames = options_.frames;
  request.roi = options_.roi;
  request.circle = options_.ball.circle;
  request.estimator = options_.estimator.estimator;
  request.field = options_.estimator.field;
  request.with_field = options_.with_field;
  request.rim_margin_px = options_.estimator.rim_margin_px;
  scout(request);
  const std::string uneven = even_out_sensor(request);
  std::vector<advice::BallPair> pairs;
  result_.advice = advice::advise_clip(*source_, request, registers_ball() ? &pairs : nullptr);
  if (result_.advice.reflex_alone) {
    options_.with_field = false;  // it would be the reflex that is measured
    pairs.clear();
  }
  if (result_.advice.texture) options_.estimator.field.noise = result_.advice.texture->noise;
  if (options_.with_field) session_.open();
  choose_body(pairs, request);
  result_.warnings = all_warnings(request_.clip, info(), result_.advice);
  result_.warnings.insert(result_.warnings.end(), clock_warnings_.begin(), clock_warnings_.end());
  if (!uneven.empty()) result_.warnings.push_back(uneven);
  if (!second_ball_warning_.empty()) result_.warnings.push_back(second_ball_warning_);
  if (request_.ball_diameter_mm == 0 && request_.mm_per_px == 0 && !camera_) {
    result_.warnings.push_back(
        "no scale is given: results are in pixels only; --ball-diameter-mm or --mm-per-px gives "
        "metres");
  }
  if (perspective_.is_unknown()) result_.warnings.emplace_back(kDistanceUnknown);
  if (round_body_) result_.warnings.push_back(result_.body_reason);
  if (edges_cover_ball_) {
    result_.warnings.push_back(
        "edges that stand still cover the ball, as columns of a sensor do: too little of it is "
        "left to "
        "be registered; let the camera correct its black level and gains");
  }
  if (result_.advice.texture) {
    caller_.say(MessageKind::kNote, "texture: " + report::in_words(result_.advice.texture->asked));
  }
  for (const std::string& warning : result_.warnings) caller_.say(MessageKind::kWarning, warning);
}

void TrackRun::look_for_ball() {
  advice::AdviceRequest request;
  scout(request);
}

void TrackRun::keep(const TrackRow& row) {
  if (store_ != nullptr) {
    store_->push_back(row);
  } else {
    result_.rows.push_back(row);
  }
}

void TrackRun::take_up(std::vector<TrackRow> rows) {
  const std::vector<std::int64_t>& periods = options_.periods;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // The table does not hold the periods, and its times may count frames that are missing.
    const TrackRow timed = pipeline::row_without_ball(options_.frames, options_.fps, periods,
                                                      static_cast<std::int64_t>(i));
    rows[i].periods = timed.periods;
    rows[i].time_s = timed.time_s;
    keep(rows[i]);
  }
}

void TrackRun::measure(const Outputs& outputs) {
  std::vector<opencl::Engine*> engines;
  if (options_.with_field) engines = session_.impl().open_engines();
  StageTimes times;
  if (session_.options().profile) options_.times = &times;
  options_.from = outputs.from;
  options_.checkpoint = outputs.checkpoint;
  if (outputs.from && outputs.from->grid_radius_px) {
    result_.grid_radius_px = *outputs.from->grid_radius_px;
  }
  const std::size_t before = rows().size();
  const Stopwatch watch;
  const auto note_speed = [&] {
    result_.seconds = watch.seconds();
    result_.frames_per_s = static_cast<double>(rows().size() - before) / result_.seconds;
    result_.cancelled =
        caller_.cancelled() && static_cast<std::int64_t>(rows().size()) < options_.frames.count();
  };
  const pipeline::TrackSink take = [&](const pipeline::TrackedFrame& frame) {
    keep(frame.row);
    if (outputs.frame) outputs.frame(frame);
  };
  const ProgressFn progress = [&](std::int64_t done, std::int64_t total) {
    caller_.progress("track", done, total);
  };
  try {
    if (round_body_) {
      pipeline::track_round(*source_, *engines.front(), options_, *round_body_, take, progress);
      return note_speed();
    }
    pipeline::track_clip(
        *source_, engines, options_,
        [&](std::span<const Window> grid, double radius_px) {
          result_.windows = grid.size();
          result_.grid_radius_px = radius_px;
          if (outputs.grid) outputs.grid(grid, radius_px);
        },
        take, progress);
  } catch (...) {
    note_speed();
    throw;
  }
  note_speed();
  const auto measured = static_cast<std::int64_t>(rows().size() - before);
  if (options_.times != nullptr && !times.rows().empty()) {
    caller_.say(MessageKind::kTiming, times.table(result_.seconds, measured));
  }
}

void TrackRun::count_rows() {
  result_.frames_measured = result_.frames_with_ball = result_.frames_ok = 0;
  for (const TrackRow& row : rows()) {
    ++result_.frames_measured;
    result_.frames_with_ball += row.circle_ok;
    result_.frames_ok += row.status == TrackStatus::kOk || row.status == TrackStatus::kLastFrame;
  }
}

void TrackRun::conclude() {
  count_rows();
  const auto warn = [&](const std::string& text) {
    if (text.empty()) return;
    result_.warnings.push_back(text);
    caller_.say(MessageKind::kWarning, text);
  };
  warn(repeats_warning(rows()));
  warn(count_missing_frames());
  warn(look_at_camera_motion());
  const TrackRows measured = steady_ ? TrackRows(*steady_) : rows();
  std::optional<Measured> sphere;
  if (options_.estimator.sphere && options_.estimator.sphere_radius_px > 0) {
    sphere = {options_.estimator.sphere_radius_px, options_.estimator.sphere_radius_sd_px};
  }
  if (camera_) {
    conclude_through_camera(*camera_, request_, {measured.begin(), measured.end()}, sphere, result_,
                            perspective_);
  } else {
    conclude_metres(request_, sphere, measured, result_, perspective_);
    warn(light_warning(request_, result_.clip));
  }
  look_for_surface();
  const EvenRows seen(camera_ ? TrackRows(result_.camera->rows) : measured);
  std::optional<FallInPicture> gravity;
  const SiScale& scale = result_.scale;
  if (scale.metre_per_px > 0 && scale.fps > 0) {
    const double strength = kGravity_m_s2 / scale.metre_per_px / (scale.fps * scale.fps);
    const double angle = request_.gravity_angle_deg * kRadPerDeg;
    gravity = {strength * std::cos(angle), -strength * std::sin(angle)};
  }
  const int width = info().width, height = info().height;
  std::string bend = lens_warning(bend_of_flights(seen, result_.impact, width, height, gravity),
                                  camera_.has_value());
  if (bend.empty()) {
    bend = outline_warning(corner_by_outline(seen, result_.impact, width, height), width, height,
                           camera_.has_value());
  }
  warn(bend);
  if (bend.empty() && !camera_) {
    warn(oval_warning(oval_of_flights(seen, result_.impact, width, height)));
  }
  for (const Contradiction& found : result_.impact_si.contradictions) warn(found.message);
  restate_motions(seen);
  const bool explained = result_.impact_si.found() || result_.impact.flight.last > 0;
  if (!explained && !round_body_) warn(rough_path_warning(seen));
}

void TrackRun::change_rows(const RowChange& change) {
  if (store_ != nullptr) {
    changed_.push_back(std::make_unique<ChangedRows>(rows(), change));
    return;
  }
  for (std::size_t i = 0; i < result_.rows.size(); ++i) change(i, result_.rows[i]);
}

std::string TrackRun::count_missing_frames() {
  const std::vector<MissingFrames> missing = missing_frames(rows());
  if (missing.empty()) return "";
  const double rate = result_.scale.fps > 0 ? result_.scale.fps : kNotMeasured;
  change_rows([missing, rate](std::size_t i, TrackRow& row) { count(missing, rate, i, row); });
  return missing_warning(missing, rows());
}

std::string TrackRun::look_at_camera_motion() {
  const bool wanted = request_.camera_motion == CameraMotionUse::kCorrect && !round_body_;
  if (!wanted || info().sizes_differ) return "";
  std::optional<CameraMotion> motion =
      shake::measure_camera_motion(*source_, rows(), [this] { return caller_.cancelled(); });
  if (!motion) return "";
  if (!shake::moves_with_ball(*motion, rows())) return shake::by_itself_in_words(*motion);
  result_.camera_motion = std::move(motion);
  steady_.emplace(rows(), *result_.camera_motion);
  return shake::in_words(*result_.camera_motion);
}

void TrackRun::restate_motions(const TrackRows& even) {
  const StepScatter scatter =
      scatter_of_steps(even, result_.impact, result_.scale.surface_angle_rad);
  if (!scatter.is_more()) return;
  result_.warnings.push_back(scatter.warning());
  caller_.say(MessageKind::kWarning, result_.warnings.back());
  change_rows([scatter](std::size_t, TrackRow& row) { scatter.widen(row); });
  if (result_.camera) {
    for (TrackRow& row : result_.camera->rows) scatter.widen(row);
  }
}

void TrackRun::look_for_surface() {
  if (!result_.impact_si.found() || camera_) return;
  surface_in_picture_ = run::surface_in_picture(*source_, EvenRows(rows()), result_.impact);
  if (!surface_in_picture_) return;
  char text[120];
  std::snprintf(text, sizeof text, "surface: an edge at %.2f +- %.2f degrees in the picture",
                surface_in_picture_->value, surface_in_picture_->sd);
  caller_.say(MessageKind::kNote, text);
  compare_with_edge(request_, *surface_in_picture_, result_.impact_si);
}

void hand_on(const pipeline::TrackedFrame& frame, int window_px, const TrackSink& sink) {
  FieldView field;
  if (frame.pair != nullptr) field = FieldView(frame.pair->windows, frame.pair->field, window_px);
  sink({frame.row, frame.frame, field});
}

}  // namespace run

void track(const TrackRequest& request, Session& session, const RunControl& control,
           const TrackSink& sink, TrackResult& result) {
  run::Caller caller(control);
  run::TrackRun run(request, session, caller, result);
  run.look();
  run::TrackRun::Outputs outputs;
  if (sink) {
    outputs.frame = [&](const pipeline::TrackedFrame& frame) {
      run::hand_on(frame, request.field.window_px, sink);
    };
  }
  try {
    run.measure(outputs);
  } catch (...) {
    run.conclude();
    throw;
  }
  run.conclude();
}

TrackResult track(const TrackRequest& request, Session& session, const RunControl& control,
                  const TrackSink& sink) {
  TrackResult result;
  track(request, session, control, sink, result);
  return result;
}

}  // namespace impactdic
