#include "host/run/correlate_run.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>

#include "host/advice/clip_advice.h"
#include "host/base/stage_times.h"
#include "host/base/stopwatch.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/report/words.h"
#include "host/run/metres/camera_part.h"
#include "host/run/open_clip.h"
#include "host/run/session.h"

namespace impactdic {
namespace {

constexpr std::array kReferences = {"first", "previous"};
constexpr std::array kMotions = {"windows", "region"};

Image<std::uint8_t> read_mask(const std::string& path, const OpenOptions& open) {
  OpenOptions options = open;
  options.raw.reset();
  const auto source = open_clip({path}, options);
  Frame frame;
  source->read(0, frame);
  Image<std::uint8_t> mask(frame.width(), frame.height());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask.data()[i] =
        frame.type == PixelType::kU8 ? frame.u8.data()[i] != 0 : frame.u16.data()[i] != 0;
  }
  return mask;
}

// What all leave: the mask's picture, the one in memory and the polygon.
Image<std::uint8_t> resolve_mask(const CorrelateRequest& request, const ClipInfo& clip) {
  Image<std::uint8_t> all;
  const auto leave = [&](Image<std::uint8_t> mask, const std::string& from) {
    if (mask.width() != clip.width || mask.height() != clip.height) {
      throw InvalidArgument("the mask has another size than the clip", from);
    }
    if (all.size() == 0) {
      all = std::move(mask);
    } else {
      for (std::size_t i = 0; i < all.size(); ++i) {
        all.data()[i] = all.data()[i] != 0 && mask.data()[i] != 0;
      }
    }
  };
  if (!request.mask.empty()) leave(read_mask(request.mask, request.clip.open), request.mask);
  if (request.mask_picture) leave(*request.mask_picture, "--mask");
  if (!request.polygon.empty()) {
    leave(polygon_mask(request.polygon, clip.width, clip.height), "--polygon");
  }
  return all;
}

// The rectangle asked for; without one, all of the picture in which every window's search area lies
// inside too, so that no window is lost at the picture's edge.
Roi resolve_roi(const CorrelateRequest& request, const ClipInfo& info,
                const Image<std::uint8_t>& mask) {
  if (request.roi) {
    check_roi(*request.roi, info.width, info.height);
    return *request.roi;
  }
  if (!request.polygon.empty()) return extent(mask);
  const int margin =
      std::min({request.field.search_px, (info.width - 1) / 2, (info.height - 1) / 2});
  return {margin, margin, info.width - 2 * margin, info.height - 2 * margin};
}

MotionRow row_of(const pipeline::CorrelatedFrame& frame) {
  const dic::RigidMotion& m = frame.motion;
  MotionRow row;
  row.frame = frame.frame;
  row.time_s = frame.time_s;
  row.is_reference = frame.is_reference;
  row.status = frame.status;
  row.motion_ok = m.ok;
  row.windows = m.used;
  if (!m.ok) return row;
  row.dx_px = m.dx_px;
  row.dy_px = m.dy_px;
  row.rot_deg = m.rot_rad * kDegPerRad;
  row.dx_sd_px = m.dx_sd_px;
  row.dy_sd_px = m.dy_sd_px;
  row.rot_sd_deg = m.rot_sd_rad * kDegPerRad;
  return row;
}

}  // namespace

const char* to_string(ReferenceFrame reference) {
  return kReferences[static_cast<std::size_t>(reference)];
}

ReferenceFrame parse_reference(const std::string& word) {
  for (const auto reference : {ReferenceFrame::kFirst, ReferenceFrame::kPrevious}) {
    if (word == to_string(reference)) return reference;
  }
  throw InvalidArgument("'" + word + "' is not a reference", "--reference", "first or previous");
}

const char* to_string(RegionMotion motion) { return kMotions[static_cast<std::size_t>(motion)]; }

RegionMotion parse_region_motion(const std::string& word) {
  for (const auto motion : {RegionMotion::kWindows, RegionMotion::kRegion}) {
    if (word == to_string(motion)) return motion;
  }
  throw InvalidArgument("'" + word + "' is no way to measure the motion", "--motion",
                        "windows or region");
}

void CorrelateRequest::validate() const {
  clip.validate();
  field.validate();
  run::check_spacing(spacing_px);
  run::check_frames(frames);
  if (static_cast<std::size_t>(reference) >= kReferences.size()) {
    throw InvalidArgument("this is no reference", "--reference", "first or previous");
  }
  if (static_cast<std::size_t>(motion) >= kMotions.size()) {
    throw InvalidArgument("this is no way to measure the motion", "--motion", "windows or region");
  }
  if (roi) run::check_rectangle(*roi);
  run::check_polygon(polygon);
}

namespace run {

CorrelateRun::CorrelateRun(const CorrelateRequest& request, Session& session, Caller& caller,
                           CorrelateResult& result)
    : request_(request), session_(session), caller_(caller), result_(result) {
  request.validate();
  source_ = open_requested(request.clip);
  result_ = {};
  result_.clip = info();
  options_.field = request.field;
  options_.field.noise = 0;
  options_.spacing_px = request.spacing_px;
  options_.frames = result_.frames = resolve(request.frames, info().frame_count);
  options_.mask = resolve_mask(request, info());
  options_.roi = result_.roi = resolve_roi(request, info(), options_.mask);
  options_.reference = request.reference;
  options_.motion = request.motion;
  options_.fps = result_.fps = resolve_fps(request.clip, info(), "");
  options_.cancelled = [this] { return caller_.cancelled(); };
  if (options_.frames.count() < 2) {
    throw InvalidArgument("a displacement needs two frames", info().path,
                          "several pictures form a sequence");
  }
  windows_ = pipeline::region_grid(options_);
  result_.windows = windows_.size();
  if (!request.camera.empty()) {
    const Camera camera = read_camera(request.camera);
    check_camera_fits(camera, info(), request.camera);
    result_.camera = figures_of(camera);
    plane_.emplace(camera, windows_, request, options_.roi, options_.effective_spacing_px());
  }
  session.open();
}

void CorrelateRun::look() {
  advice::AdviceRequest request;
  request.ball = false;
  request.frames = options_.frames;
  request.roi = options_.roi;
  request.field = options_.field;
  result_.advice = advice::advise_clip(*source_, request);
  if (result_.advice.texture) options_.field.noise = result_.advice.texture->noise;
  result_.warnings = all_warnings(request_.clip, info(), result_.advice);
  if (result_.advice.texture) {
    caller_.say(MessageKind::kNote, "texture: " + report::in_words(result_.advice.texture->asked));
  }
  for (const std::string& warning : result_.warnings) caller_.say(MessageKind::kWarning, warning);
}

void CorrelateRun::go_on(const pipeline::CorrelatePoint& from, std::vector<MotionRow> rows) {
  if (from.next_row > options_.frames.count()) {
    throw InvalidArgument("an earlier run has gone beyond the end of this clip", "--resume",
                          "give the clip and the frames of that run");
  }
  options_.from = from;
  result_.rows = std::move(rows);
  result_.frames_measured = std::count_if(
      result_.rows.begin(), result_.rows.end(),
      [](const MotionRow& row) { return !row.is_reference && row.status == TrackStatus::kOk; });
}

void CorrelateRun::measure(const Sink& sink, const Checkpoint& checkpoint) {
  StageTimes times;
  if (session_.options().profile) options_.times = &times;
  // On a queue of this run's own: the session's engine may serve others.
  const auto engine = session_.impl().open_engines().front()->beside();
  const std::size_t before = result_.rows.size();
  StillFrames still(request_.reference, std::hypot(options_.roi.width, options_.roi.height) / 2);
  const Stopwatch watch;
  const auto note_speed = [&] {
    result_.seconds = watch.seconds();
    result_.frames_per_s = static_cast<double>(result_.rows.size() - before) / result_.seconds;
    result_.cancelled = caller_.cancelled() &&
                        static_cast<std::int64_t>(result_.rows.size()) < options_.frames.count();
    if (before == 0) result_.noise_floor = still.floor();
  };
  try {
    pipeline::correlate_clip(
        *source_, *engine, options_,
        [&](const pipeline::CorrelatedFrame& frame) {
          result_.rows.push_back(row_of(frame));
          MotionRow& row = result_.rows.back();
          if (!frame.is_reference && frame.status == TrackStatus::kOk) ++result_.frames_measured;
          if (before == 0) still.add(row, frame.field);
          std::span<const PlaneResult> plane;
          if (plane_) plane = plane_->correct(frame.field, row);
          if (sink) sink(row, frame.field, plane);
          if (checkpoint) checkpoint(frame.after);
        },
        [&](std::int64_t done, std::int64_t total) { caller_.progress("correlate", done, total); });
  } catch (...) {
    note_speed();
    throw;
  }
  note_speed();
  if (options_.times != nullptr && !times.rows().empty()) {
    caller_.say(
        MessageKind::kTiming,
        times.table(result_.seconds, static_cast<std::int64_t>(result_.rows.size() - before)));
  }
}

}  // namespace run

void correlate(const CorrelateRequest& request, Session& session, const RunControl& control,
               const CorrelateSink& sink, CorrelateResult& result) {
  run::Caller caller(control);
  run::CorrelateRun run(request, session, caller, result);
  run.look();
  run.measure([&](const MotionRow& row, std::span<const WindowMotion> field,
                  std::span<const PlaneResult> plane) {
    if (!sink) return;
    const FieldView view =
        field.empty() ? FieldView() : FieldView(run.windows(), field, request.field.window_px);
    sink({row, view, plane});
  });
}

CorrelateResult correlate(const CorrelateRequest& request, Session& session,
                          const RunControl& control, const CorrelateSink& sink) {
  CorrelateResult result;
  correlate(request, session, control, sink, result);
  return result;
}

}  // namespace impactdic
