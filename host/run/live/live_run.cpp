// `track` on frames as they come; see api/impactdic/live/track_live.h.
#include <impactdic/error.h>
#include <impactdic/live/track_live.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <exception>
#include <thread>
#include <utility>

#include "host/base/parse.h"
#include "host/circle/scout_ball.h"
#include "host/clip/roi.h"
#include "host/pipeline/track_clip.h"
#include "host/run/control.h"
#include "host/run/expected_programs.h"
#include "host/run/live/first_frames.h"
#include "host/run/session.h"
#include "host/run/track/track_run.h"
#include "host/video/live/frame_queue.h"

namespace impactdic {
namespace {

using SteadyClock = std::chrono::steady_clock;
using video::ArrivedFrame;

constexpr int kLongestBatch = 64;
constexpr std::chrono::duration<double> kPatience{0.1};  // until it looks whether it is cancelled
constexpr std::int64_t kEndless = std::int64_t{1} << 40;

double seconds_since(SteadyClock::time_point begin) {
  return std::chrono::duration<double>(SteadyClock::now() - begin).count();
}

// Frames that may wait: those of the time that they may lag, and a batch in any case.
std::size_t most_waiting(const LiveRequest& request, int batch) {
  const double lag = request.lag_s * request.track.clip.fps;
  return static_cast<std::size_t>(std::max(lag, 2.0 * batch));
}

int batch_of(const LiveRequest& request) {
  return static_cast<int>(
      std::clamp(0.5 * request.wait_s * request.track.clip.fps, 1.0, double{kLongestBatch}));
}

class LiveRun {
 public:
  LiveRun(const LiveRequest& request, Session& session, run::Caller& caller, const LiveSink& sink)
      : request_(request),
        session_(session),
        caller_(caller),
        sink_(sink),
        fps_(request.track.clip.fps),
        batch_(batch_of(request)),
        // The next frames come while the first ones are looked at.
        queue_(std::max(most_waiting(request, batch_), static_cast<std::size_t>(request.look)),
               request.lag_s == 0) {
    const ClipInfo& info = request.stream->info();
    roi_ = request.track.roi.value_or(Roi{0, 0, info.width, info.height});
    check_roi(roi_, info.width, info.height);
    scale_.metre_per_px = request.track.mm_per_px * 1e-3;
    scale_.metre_per_px_sd = request.track.mm_per_px_sd * 1e-3;
    scale_.fps = fps_;
    scale_.surface_angle_rad = request.track.surface_angle_deg * kRadPerDeg;
    scale_.image_height = info.height;
  }
  LiveResult run();

 private:
  struct Measured {
    std::int64_t number;
    SteadyClock::time_point at;
  };
  void receive();
  bool find_ball();
  void measure();
  std::vector<ArrivedFrame> next(std::size_t count, std::chrono::duration<double> wait);
  std::shared_ptr<pipeline::FrameBatch> feed();
  void emit(TrackRow row);
  void emit_dropped(std::int64_t until);
  void hand_out(TrackRow row, bool dropped, double delay_s);

  const LiveRequest& request_;
  Session& session_;
  run::Caller& caller_;
  const LiveSink& sink_;
  double fps_;
  int batch_;
  Roi roi_;
  SiScale scale_;
  video::FrameQueue queue_;
  std::vector<ArrivedFrame> first_;  // that were looked at, and are still to be measured
  std::deque<Measured> measured_;    // whose rows are to come
  std::int64_t fed_ = 0, given_ = 0;
  std::optional<SteadyClock::time_point> begin_;
  LiveResult result_;
};

void LiveRun::receive() {
  try {
    Frame frame = queue_.spare();
    while (request_.stream->next(frame)) {
      queue_.push(std::move(frame));
      frame = queue_.spare();
    }
    queue_.close();
  } catch (...) {
    queue_.close(std::current_exception());
  }
}

LiveResult LiveRun::run() {
  if (request_.track.with_field) {
    session_.impl().open_engines(run::expected_programs(request_.track));
  }
  std::jthread receiver([this] { receive(); });
  const auto end = [this] {
    request_.stream->stop();
    queue_.abandon();
  };
  try {
    if (find_ball()) measure();
  } catch (...) {
    end();
    throw;
  }
  end();
  receiver.join();
  result_.cancelled = caller_.cancelled();
  result_.frames = given_;
  if (begin_) result_.seconds = seconds_since(*begin_);
  return std::move(result_);
}

// Empty at the end, and where the run is cancelled.
std::vector<ArrivedFrame> LiveRun::next(std::size_t count, std::chrono::duration<double> wait) {
  while (!caller_.cancelled()) {
    std::vector<ArrivedFrame> frames = queue_.pop(count, wait, kPatience);
    if (!frames.empty() && !begin_) begin_ = frames.front().at;
    if (!frames.empty() || queue_.is_over()) return frames;
  }
  return {};
}

// Waits for frames that show a ball. False where none does before the end.
bool LiveRun::find_ball() {
  for (;;) {
    first_ = next(static_cast<std::size_t>(request_.look), std::chrono::duration<double>(0));
    if (first_.empty()) return false;
    run::FirstFrames source(request_.stream->info(), first_, fps_);
    const FrameRange all{0, source.info().frame_count, 1};
    circle::CircleOptions options;
    if (request_.track.radius_px) {
      options.radius_range_px = {request_.track.radius_px->low_px,
                                 request_.track.radius_px->high_px};
    }
    if (circle::scout_ball(source, all, roi_, options).radius_px()) return true;
    for (ArrivedFrame& frame : first_) {
      measured_.push_back({frame.number, frame.at});
      emit({});
      queue_.give_back(std::move(frame.frame));
    }
  }
}

void LiveRun::measure() {
  TrackRequest looked = request_.track;
  looked.clip.paths.clear();
  looked.frames = {0, kToTheEnd, 1};
  const auto source = std::make_shared<run::FirstFrames>(request_.stream->info(), first_, fps_);
  looked.clip.source = source;
  TrackResult about;
  run::TrackRun run(looked, session_, caller_, about);
  run.leave_grey_levels();
  run.look();
  result_.body = about.body;
  result_.body_reason = about.body_reason;
  result_.warnings = about.warnings;
  queue_.limit(most_waiting(request_, batch_));
  pipeline::TrackOptions options = run.options();
  // The stream may go on for hours, the light change.
  options.ball.scene = nullptr;
  options.ball.backdrop = nullptr;
  options.frames = {0, kEndless, 1};
  options.batch = kLongestBatch;
  options.feed = [this] { return feed(); };
  std::vector<opencl::Engine*> engines;
  if (options.with_field) engines = session_.impl().open_engines();
  pipeline::track_clip(
      *source, engines, options, [](std::span<const Window>, double) {},
      [this](const pipeline::TrackedFrame& frame) { emit(frame.row); },
      [](std::int64_t, std::int64_t) {});
}

std::shared_ptr<pipeline::FrameBatch> LiveRun::feed() {
  const auto count = static_cast<std::size_t>(batch_);
  std::vector<ArrivedFrame> frames;
  if (!first_.empty()) {
    const std::size_t some = std::min(count, first_.size());
    std::move(first_.begin(), first_.begin() + static_cast<std::ptrdiff_t>(some),
              std::back_inserter(frames));
    first_.erase(first_.begin(), first_.begin() + static_cast<std::ptrdiff_t>(some));
  } else {
    const double wait_s = request_.lag_s > 0 ? request_.wait_s : 0;
    frames = next(count, std::chrono::duration<double>(wait_s));
    result_.short_batches += !frames.empty() && frames.size() < count && !queue_.is_over();
  }
  if (frames.empty()) return nullptr;
  auto batch = std::make_shared<pipeline::FrameBatch>();
  batch->first_index = fed_;
  for (ArrivedFrame& arrived : frames) {
    measured_.push_back({arrived.number, arrived.at});
    crop(arrived.frame, roi_, batch->frames.emplace_back());
    queue_.give_back(std::move(arrived.frame));
  }
  note_repeats(*batch);
  fed_ += static_cast<std::int64_t>(frames.size());
  return batch;
}

void LiveRun::emit(TrackRow row) {
  const Measured frame = measured_.front();
  measured_.pop_front();
  emit_dropped(frame.number);
  row.frame = frame.number;
  if (!measured_.empty()) row.periods = static_cast<int>(measured_.front().number - frame.number);
  result_.ok += row.status == TrackStatus::kOk || row.status == TrackStatus::kLastFrame;
  hand_out(std::move(row), false, seconds_since(frame.at));
}

void LiveRun::emit_dropped(std::int64_t until) {
  while (given_ < until) {
    TrackRow row;
    row.frame = given_;
    ++result_.dropped;
    hand_out(std::move(row), true, 0);
  }
}

void LiveRun::hand_out(TrackRow row, bool dropped, double delay_s) {
  row.time_s = fps_ > 0 ? static_cast<double>(row.frame) / fps_ : kNotMeasured;
  given_ = row.frame + 1;
  result_.longest_delay_s = std::max(result_.longest_delay_s, delay_s);
  sink_({row, scale_, dropped, delay_s});
}

}  // namespace

void LiveRequest::validate() const {
  TrackRequest measured = track;
  measured.clip.source = nullptr;
  measured.clip.paths = {"stream"};
  measured.validate();
  const auto check = [](bool good, double value, const char* setting, const char* must) {
    if (!good)
      throw InvalidArgument("must be " + std::string(must) + ", not " + shortest(value), setting);
  };
  if (!stream && !(track.clip.open.raw && track.clip.paths.size() == 1)) {
    throw InvalidArgument("a stream is bare pixels from one place", "--live",
                          "track - --raw WIDTHxHEIGHTxBITS --fps F --live");
  }
  if (!track.polygon.empty()) {
    throw InvalidArgument("a stream is looked at in rectangles", "--polygon", "give --roi");
  }
  if (!track.ball_at.empty()) {
    throw InvalidArgument("nobody has seen a stream's frames before", "--ball-at",
                          "only a clip's frames can be corrected");
  }
  if (!(track.clip.fps > 0)) {
    throw InvalidArgument("a stream does not say its frame rate", "--fps", "give the camera's");
  }
  if (track.ball > 0) {
    throw InvalidArgument("a stream is not known before it comes", "--ball",
                          "--roi or --radius-px keep to one ball");
  }
  check(look >= 2 && look <= 1000, look, "--look", "between 2 and 1000");
  check(wait_s >= 0.0005 && wait_s <= 1, wait_s, "--wait", "between 0.0005 and 1 s");
  check(lag_s >= 0 && lag_s <= 60, lag_s, "--lag", "between 0 and 60 s");
}

LiveResult track_live(const LiveRequest& request, Session& session, const RunControl& control,
                      const LiveSink& sink) {
  request.validate();
  run::Caller caller(control);
  LiveRequest opened = request;
  if (!opened.stream) {
    opened.stream = open_raw_stream(request.track.clip.paths[0], *request.track.clip.open.raw);
  }
  return LiveRun(opened, session, caller, sink).run();
}

}  // namespace impactdic
