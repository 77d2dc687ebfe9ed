// What a device worker makes of a batch: circles, pairs, poses.
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/stopwatch.h"
#include "host/motion/measure_pairs.h"
#include "host/pipeline/device_worker.h"
#include "host/pipeline/rows/place_by_turns.h"

namespace impactdic::pipeline {
namespace {

// A ball this far from where it was expected may leave the part of its frame about that.
constexpr double kAsExpected_px = 2;

// Whether one of the outlines of pair `i`, or of the frames beside it, is an ellipse, lost, or
// smaller than that of the free ball, as an ellipse's is that does not show.
bool near_contact(const TrackBatch& batch, std::size_t i, double radius_px) {
  constexpr double kSmaller = 0.985;
  const std::size_t end = std::min(i + 3, batch.frames.size());
  for (std::size_t k = i > 0 ? i - 1 : 0; k < end; ++k) {
    if (!batch.rows[k].circle_ok || !batch.shapes[k].is_circle()) return true;
    if (batch.circles[k].r_px < kSmaller * radius_px) return true;
  }
  return false;
}

}  // namespace

bool DeviceWorkers::measure_parts(Worker& worker, TrackBatch& batch, Turn& planning,
                                  Turn& placing) {
  Origins origins;
  if (batch.circles_left) origins = complete_circles(worker, batch);
  const bool is_there = !origins.empty();
  const std::size_t count = batch.frames.size();
  for (std::size_t i = origins.size(); i < count; ++i) {
    origins.push_back(crop_.about(ball(batch.circles[i])));
  }
  batch.pairs.resize(count);
  batch.measured.assign(count, false);
  const auto slots = static_cast<std::size_t>(worker.slots);
  std::vector<motion::TurnedCentre> told;
  // A part begins with the last frame of the one before.
  for (std::size_t first = 0; first + 1 < count; first += slots - 1) {
    const std::size_t frames = std::min(slots, count - first);
    if (is_cancelled()) return false;
    const auto cut = std::span(origins).subspan(first, frames);
    measure_part(worker, batch, first, cut, is_there);
    if (!keyframes_) continue;
    if (is_cancelled()) return false;
    motion::Keyframes::Ahead ahead;
    ahead.frames = chained(batch, first, cut);
    if (ahead_ > 1) register_ahead(worker, batch, ahead, planning, placing);
    if (worker.centres) {
      for (motion::TurnedCentre centre : worker.centres->measure(ahead.frames)) {
        centre.frame += first;
        told.push_back(centre);
      }
    }
    placing.wait();
    if (is_cancelled()) return false;
    place_part(worker, batch, first, ahead);
  }
  if (keyframes_) placing.end();  // its turn has come by now
  place_by_turns(batch.rows, batch.pairs, told, options_);
  return true;
}

void DeviceWorkers::register_ahead(Worker& worker, const TrackBatch& batch,
                                   motion::Keyframes::Ahead& ahead, Turn& planning, Turn& placing) {
  planning.wait();
  if (is_cancelled()) return;  // the batch before may have left no forecast
  if (place_in_group(batch) == 0) {
    placing.wait();
    forecast_->begin(keyframes_->memory());
  }
  const StageTimes::Scope timed(times_, stages_.ahead);
  forecast_->plan(ahead);
  planning.end();
  ahead.motions =
      aim_.measure(std::span(ahead.frames).subspan(1), ahead.near, ahead.plan, *worker.keyframes);
}

Circle DeviceWorkers::ball(const Circle& circle) const {
  return motion::about_centre(circle, options_.perspective);
}

void DeviceWorkers::upload(Worker& worker, std::span<const Frame* const> frames,
                           std::span<const motion::CropOrigin> origins) {
  const StageTimes::Scope timed(times_, stages_.upload);
  std::vector<dic::FramePart> parts;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    parts.push_back({frames[k], origins[k].x, origins[k].y});
  }
  worker.frames.set(0, parts, crop_.width(), crop_.height());
}

DeviceWorkers::Origins DeviceWorkers::complete_circles(Worker& worker, TrackBatch& batch) {
  batch.circles_left = false;
  std::vector<const Frame*> frames = batch.frames;  // that of the batch before, where there is one
  const std::size_t before = frames.size();
  for (const Frame& frame : batch.own->frames) frames.push_back(&frame);
  if (frames.size() > static_cast<std::size_t>(worker.slots)) {
    circles_.complete(batch, {});
    return {};
  }
  const std::vector<circle::CirclePrior> expected = circles_.expected(batch);
  std::vector<Circle> circles = batch.circles;
  for (const circle::CircleFit& fit : batch.fits) circles.push_back(fit.circle);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    circles[before + batch.plan.left[k].frame] = expected[k].predicted;
  }
  Origins origins;
  for (const Circle& circle : circles) origins.push_back(crop_.about(ball(circle)));
  upload(worker, frames, origins);
  {
    const StageTimes::Scope timed(times_, stages_.circles);
    std::vector<circle::RimToFollow> rims;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const std::size_t i = before + batch.plan.left[k].frame;
      const auto [x, y] = origins[i];
      rims.push_back({frames[i], static_cast<int>(i), x, y, expected[k]});
    }
    if (!worker.rims) worker.rims.emplace(*worker.engine, circles_.options);
    circles_.complete(batch, worker.rims->follow(worker.frames, rims));
  }
  // One that is elsewhere, as behind an impact, may be cut by its part.
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Circle& found = batch.circles[i];
    const double off_px =
        std::hypot(found.cx_px - circles[i].cx_px, found.cy_px - circles[i].cy_px);
    if (off_px > kAsExpected_px) return {};
  }
  return origins;
}

void DeviceWorkers::measure_part(Worker& worker, TrackBatch& batch, std::size_t first,
                                 std::span<const motion::CropOrigin> origins, bool is_there) {
  const std::size_t count = origins.size();
  std::vector<motion::PairMotion> pairs;
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t i = first + k;
    if (!batch.rows[i].circle_ok || !batch.rows[i + 1].circle_ok) continue;
    motion::PairMotion& pair = pairs.emplace_back();
    pair.first_slot = static_cast<int>(k);
    pair.second_slot = static_cast<int>(k + 1);
    pair.first = ball(batch.circles[i]);
    pair.second = ball(batch.circles[i + 1]);
    pair.shape = batch.shapes[i];
    pair.second_shape = batch.shapes[i + 1];
    pair.near_contact = near_contact(batch, i, radius_px_);
    motion::into_crops(pair, origins[k], origins[k + 1]);
    which.push_back(k);
  }
  // A ball without a neighbour may still be placed against a keyframe.
  const auto rows = std::span(batch.rows).subspan(first, count);
  const bool any_ball =
      std::any_of(rows.begin(), rows.end(), [](const TrackRow& row) { return row.circle_ok; });
  if (which.empty() && !(keyframes_ && any_ball)) return;
  if (!is_there) upload(worker, std::span(batch.frames).subspan(first, count), origins);
  const double fits_before = worker.estimator->fit_seconds();
  const Stopwatch watch;
  measure_pairs(*worker.estimator, radius_px_, pairs);
  if (times_ != nullptr) {
    const double fits = worker.estimator->fit_seconds() - fits_before;
    times_->add(stages_.fit, fits);
    times_->add(stages_.device, watch.seconds() - fits);
  }
  for (std::size_t k = 0; k < which.size(); ++k) {
    motion::out_of_crops(pairs[k], origins[which[k]], origins[which[k] + 1]);
    batch.pairs[first + which[k]] = std::move(pairs[k]);
    batch.measured[first + which[k]] = true;
  }
}

std::vector<motion::ChainedFrame> DeviceWorkers::chained(
    const TrackBatch& batch, std::size_t first, std::span<const motion::CropOrigin> origins) const {
  std::vector<motion::ChainedFrame> frames;
  for (std::size_t k = 0; k < origins.size(); ++k) {
    const std::size_t i = first + k;
    motion::ChainedFrame& frame = frames.emplace_back();
    frame.index = batch.first_index + static_cast<std::int64_t>(i);
    frame.circle_ok = batch.rows[i].circle_ok;
    frame.circle = ball(batch.circles[i]);
    const double circle_sd_px = std::hypot(batch.rows[i].cx_sd_px, batch.rows[i].cy_sd_px);
    if (circle_sd_px > 0) frame.circle_sd_px = circle_sd_px / std::sqrt(2.0);
    frame.shape = batch.shapes[i];
    frame.frame = batch.frames[i];
    if (batch.measured[i]) frame.next = &batch.pairs[i].motion;
    frame.slot = static_cast<int>(k);
    frame.origin = origins[k];
  }
  return frames;
}

void DeviceWorkers::place_part(Worker& worker, TrackBatch& batch, std::size_t first,
                               const motion::Keyframes::Ahead& ahead) {
  const StageTimes::Scope timed(times_, stages_.poses);
  const std::vector<BodyPose> poses = keyframes_->follow(ahead, *worker.keyframes);
  for (std::size_t k = 0; k < poses.size(); ++k) batch.rows[first + k].pose = poses[k];
  batch.keyframes = keyframes_->memory();
}

}  // namespace impactdic::pipeline
