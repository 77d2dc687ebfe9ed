#include "host/circle/device/rim_follower.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host/circle/describe_fit.h"
#include "host/circle/model_fit.h"
#include "host/circle/rim/line_estimate.h"
#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/levels.h"
#include "host/circle/settings/line_fit.h"
#include "host/opencl/arguments.h"

namespace impactdic::circle {
namespace {

constexpr int kGroup = 128;
// Of local memory there.
constexpr std::size_t kBytesOfLine = 11, kBytesOfDeepLine = 42, kOtherBytes = 10240;

static_assert(kDeep == RIM_DEEP && kLevelSectors == RIM_LEVEL_SECTORS);
static_assert(kRimSectors == RIM_SECTORS);

int deep_every(const CircleOptions& options) {
  return options.rays > kLine.deep_all_up_to ? kLine.deep_every : 1;
}

// Room for the lines of any rim: a stride of whole pixels makes as many as asked for at most, and
// each quarter rounds.
int most_lines(const CircleOptions& options) { return (options.rays + 16 + 31) / 32 * 32; }

RimNumbers numbers_of(const CircleOptions& options) {
  const auto f = [](auto value) { return static_cast<float>(value); };
  RimNumbers n = {};
  n.noise_per_median = kLevels.noise_per_median;
  n.rise_rank = kLineLevels.rise_rank;
  n.bright = f(kLevels.bright);
  n.bright_noise = kLineLevels.bright_noise;
  n.bright_least = kLineLevels.bright_least;
  n.ground_noise = kLineLevels.ground_noise;
  n.ground_least = kLineLevels.ground_least;
  n.ground_tolerance = kLineLevels.ground_tolerance;
  n.least_contrast = kLineLevels.least_contrast;
  n.noise_alike = kLineLevels.noise_alike;
  n.noise_even = kLineLevels.noise_even;
  n.below = f(kLevels.below);
  n.below_weight = f(kLevels.below_weight);
  for (int m = 0; m < 3; ++m) n.no_shading[m] = f(kLevels.no_shading[m]);
  n.window_first = kLevels.window_first;
  n.window_next = kLevels.window_next;
  n.window_noise = kLevels.window_noise;
  n.window_least = kLevels.window_least;
  n.held = f(kLevels.held);
  n.least_deep = static_cast<int>(kLineLevels.least_deep);
  n.noise_apart = static_cast<int>(kLineLevels.noise_apart);
  n.envelope_passes = kLevels.envelope_passes;
  n.clear_contrast = kClear.least_contrast;
  n.clear_contrast_noise = kClear.contrast_noise;
  n.clear_tolerance = kClear.ground_tolerance;
  n.clear_noise = kClear.ground_noise;
  n.nothing = kClear.nothing;
  n.nothing_noise = kClear.nothing_noise;
  n.gap_of_rim = kClear.gap_of_rim;
  n.beside = kClear.beside;
  n.beside_hidden = kClear.beside_hidden;
  n.last_turn = kLine.last_turn;
  n.narrow = f(std::cos(kJudge.gap_deg * kRadPerDeg));
  n.reach = f(kLineFit.reach);
  n.settled = f(kLineFit.settled);
  n.newton = f(kLineFit.newton);
  n.there = f(kLineFit.there);
  n.fine_from = f(kLineFit.fine_from);
  n.fine_over = f(kLineFit.fine_over);
  n.near = RimModel::kNear;
  n.relinearise = f(kLineFit.relinearise);
  n.share_worth = f(kLineFit.share_worth);
  n.common_px = f(kLineFit.common_px);
  n.transverse = f(kPrior.transverse);
  n.round_px = f(kPrior.round_px);
  n.axis_tilt = f(kPrior.axis_tilt);
  n.axis_px = f(kPrior.axis_px);
  n.least_radius_sd = f(kPrior.least_radius_sd_px);
  n.rounds = kLineFit.rounds;
  n.steps = kLineFit.steps;
  n.points_per_parameter = kLineFit.points_per_parameter;
  n.least_lines = static_cast<int>(kLineFit.least_lines);
  n.deep_every = deep_every(options);
  n.preview_every = kLineFit.preview_every;
  return n;
}

// As the device has it: its lines are cast about what floats can tell.
Rim rim_in_slot(const RimToFollow& rim) {
  const Rim at = rim_of(rim.prior);
  return {static_cast<float>(at.cx - rim.x), static_cast<float>(at.cy - rim.y),
          static_cast<float>(at.r), static_cast<float>(at.e1), static_cast<float>(at.e2)};
}

LineTrace trace_of(const RimTask& task, const RimFound& found) {
  LineTrace trace;
  trace.levels.noise = found.noise;
  trace.levels.usual = found.usual;
  std::copy_n(found.ground, kLevelSectors, trace.levels.ground.begin());
  std::copy_n(found.light, 5, trace.levels.light.begin());
  trace.cast = task.cast;
  for (const RimQuarter& quarter : task.quarter) trace.in_view += quarter.lines;
  trace.breaks = found.breaks;
  trace.noise = std::max(found.noise / found.usual, kLine.least_noise);
  return trace;
}

LineEstimate estimate_of(const RimShape& shape, Shape kind, int lines, const Rim& rim,
                         const CirclePrior& prior) {
  LineEstimate estimate;
  estimate.shape = kind;
  if (shape.ok == 0) return estimate;
  const RimModel& model = *prior.rim_model;
  SectorSums sectors;
  for (int b = 0; b < kRimSectors; ++b) {
    sectors.score[b] = shape.sector_score[b];
    sectors.information[b] = shape.sector_hessian[b];
    sectors.points[b] = shape.sector_points[b];
  }
  Vector5 before, delta;
  for (int i = 0; i < 5; ++i) before[i] = shape.before[i], delta[i] = shape.delta[i];
  const double shrink_px = model.edge_sigma_px() * model.edge_sigma_px() / (2 * rim.r);
  const Knowledge known = knowledge(rim, before, prior, kind, shrink_px);
  estimate.sums = in_px(shape, sectors, static_cast<float>(lines), model.step_px());
  std::copy_n(shape.shares, kKinds, estimate.shares.begin());
  describe(rim, delta, known, model.step_px(), estimate);
  estimate.points = estimate.sums.points;
  estimate.ok = estimate.covariance.diagonal().minCoeff() > 0;
  return estimate;
}

}  // namespace

RimFollower::RimFollower(opencl::Engine& engine, const CircleOptions& options)
    : engine_(engine), options_((options.validate(), options)) {
  model_numbers_ = opencl::Buffer<float>(engine, RIM_MODEL);
  numbers_ = opencl::Buffer<RimNumbers>(engine, 1);
  const RimNumbers numbers = numbers_of(options);
  numbers_.write(engine, std::span(&numbers, 1));
}

opencl::ProgramRequest RimFollower::program(const CircleOptions& options, PixelType type) {
  const int lines = most_lines(options), every = deep_every(options);
  return {"rim/follow.cl",
          {{"PIXEL", type == PixelType::kU8 ? "uchar" : "ushort"},
           {"GROUP", std::to_string(kGroup)},
           {"MAX_LINES", std::to_string(lines)},
           {"MAX_DEEP", std::to_string(lines / every + 4)}}};
}

bool RimFollower::serves(const opencl::Device& device, const CircleOptions& options) {
  const auto lines = static_cast<std::size_t>(most_lines(options));
  const std::size_t deep = lines / static_cast<std::size_t>(deep_every(options)) + 4;
  const std::size_t local = kBytesOfLine * lines + kBytesOfDeepLine * deep + kOtherBytes;
  return local <= device.local_memory_bytes && device.max_work_group >= kGroup;
}

bool RimFollower::takes(const CirclePrior& prior) {
  if (!prior.rim_model || !prior.bright || !prior.rim_sd_px) return false;
  const RimModel& model = *prior.rim_model;
  const double oval = std::hypot(prior.e1_px, prior.e2_px);
  return model.surface() == Surface::kFlat && oval < kJudge.followed_oval * prior.predicted.r_px &&
         std::hypot(prior.centre_sd_px, *prior.rim_sd_px) < kJudge.close_steps * model.step_px() &&
         prior.centre_sd_px < kJudge.near_steps * model.step_px();
}

// None where a part of the rim lies outside the slot's picture, or so near that its lines do.
std::optional<RimTask> RimFollower::task_of(const dic::DeviceFrames& frames,
                                            const RimToFollow& rim) const {
  const CirclePrior& prior = rim.prior;
  const RimModel& model = *prior.rim_model;
  const Rim at = rim_in_slot(rim);
  const Casting how = {polarity_of(*prior.bright), model.step_px(), options_.rays,
                       deep_every(options_)};
  const double reach = at.r + std::hypot(at.e1, at.e2) + (kOutside + 1) * model.step_px() + 3;
  if (!(at.cx > reach && at.cy > reach && at.cx + reach < frames.width() - 1 &&
        at.cy + reach < frames.height() - 1)) {
    return std::nullopt;
  }
  RimTask task = {};
  const auto quarters =
      quarters_of({frames.width(), frames.height(), frames.width()}, at, how, task.cast);
  std::copy(quarters.begin(), quarters.end(), task.quarter);
  int lines = 0;
  for (const RimQuarter& quarter : quarters) lines += quarter.lines;
  if (lines < kLine.least_lines || lines != task.cast || lines > most_lines(options_)) {
    return std::nullopt;
  }
  task.slot = rim.slot;
  task.sign = sign_of(how.polarity);
  task.step = static_cast<float>(model.step_px());
  task.deep_step = deep_step_px(at, how);
  task.r = static_cast<float>(at.r);
  task.e1 = static_cast<float>(at.e1);
  task.e2 = static_cast<float>(at.e2);
  task.oval = shapes_of(options_) == Shapes::kCircle ? 0 : 1;
  if (prior.radius_px && prior.radius_sd_px) {
    const double shrink_px = model.edge_sigma_px() * model.edge_sigma_px() / (2 * at.r);
    task.radius_off = static_cast<float>(*prior.radius_px - shrink_px - at.r);
    task.radius_sd = static_cast<float>(std::max(*prior.radius_sd_px, kPrior.least_radius_sd_px));
  }
  if (prior.compression_axis_rad) {
    task.axis1 = static_cast<float>(-std::cos(2 * *prior.compression_axis_rad));
    task.axis2 = static_cast<float>(-std::sin(2 * *prior.compression_axis_rad));
  }
  return task;
}

std::vector<RimFound> RimFollower::run(const dic::DeviceFrames& frames,
                                       const std::shared_ptr<const RimModel>& model,
                                       std::span<const RimTask> tasks) {
  if (kernel_() == nullptr) {
    kernel_ = engine_.kernel(program(options_, frames.pixel_type()), "follow_rims");
  }
  if (model != model_) model_numbers_.write(engine_, model->device_numbers());
  model_ = model;
  const std::size_t count = tasks.size();
  const auto row = static_cast<std::size_t>(most_lines(options_));
  tasks_.reserve(engine_, count);
  found_.reserve(engine_, count);
  room_.reserve(engine_, count * RIM_ROOM * row);
  tasks_.write(engine_, tasks);
  opencl::set_arguments(kernel_, frames.pixels().get(), frames.width(), frames.height(),
                        tasks_.get(), model_numbers_.get(), numbers_.get(), room_.get(),
                        found_.get());
  const double lines = static_cast<double>(count * row);
  engine_.launch(engine_.queue(), kernel_, cl::NDRange(count * kGroup), cl::NDRange(kGroup),
                 {4 * RIM_ROOM * lines, 4000 * lines});
  std::vector<RimFound> found(count);
  found_.read(engine_, found);
  return found;
}

std::optional<CircleFit> RimFollower::fit_of(const RimToFollow& rim, const RimTask& task,
                                             const RimFound& found) const {
  const CirclePrior& prior = rim.prior;
  const RimModel& model = *prior.rim_model;
  if (found.lines == 0 || found.circle.ok == 0) return std::nullopt;
  const LineTrace trace = trace_of(task, found);
  if (trace.noise > kJudge.noisier * model.noise()) return std::nullopt;
  const Rim from = rim_in_slot(rim);
  LineEstimate best;
  if (task.oval != 0) {
    best = estimate_of(found.oval, Shape::kEllipse, found.lines, from, prior);
    if (!best.ok) return std::nullopt;
  }
  if (task.oval == 0 || !is_plainly_oval(from, best, model)) {
    best = estimate_of(found.circle, Shape::kCircle, found.lines, from, prior);
  }
  if (!best.ok) return std::nullopt;
  ModelFit m{circle::fit_of(best, from), prior.rim_model, polarity_of(*prior.bright)};
  const double moved = distance(m.fit.rim, from) / model.step_px();
  if (!(moved < kJudge.retrace_steps) || !is_enough(m.fit)) return std::nullopt;
  if (m.fit.points < kJudge.followable * found.lines) return std::nullopt;
  m.fit.rim.cx += rim.x;
  m.fit.rim.cy += rim.y;
  const CircleFit fit =
      describe(*rim.frame, m, trace, static_cast<double>(found.widest_gap), prior, *prior.bright);
  if (fit.rim_fraction < kJudge.followed_rim * prior.rim_fraction) return std::nullopt;
  return accepted(fit, *rim.frame, options_);
}

std::vector<std::optional<CircleFit>> RimFollower::follow(const dic::DeviceFrames& frames,
                                                          std::span<const RimToFollow> rims) {
  std::vector<std::optional<CircleFit>> fits(rims.size());
  // One model at a time: of a clip there are few, one after the other.
  for (std::size_t next = 0; next < rims.size();) {
    const auto& model = rims[next].prior.rim_model;
    std::vector<RimTask> tasks;
    std::vector<std::size_t> which;
    for (; next < rims.size() && rims[next].prior.rim_model == model; ++next) {
      if (!takes(rims[next].prior)) continue;
      const auto task = task_of(frames, rims[next]);
      if (!task) continue;
      tasks.push_back(*task);
      which.push_back(next);
    }
    if (tasks.empty()) continue;
    const std::vector<RimFound> found = run(frames, model, tasks);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      fits[which[k]] = fit_of(rims[which[k]], tasks[k], found[k]);
    }
  }
  return fits;
}

}  // namespace impactdic::circle
