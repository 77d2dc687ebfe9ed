#include "host/advice/looks.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "host/advice/frames/frame_checks.h"
#include "host/base/parallel/parallel_for.h"

namespace impactdic::advice {
namespace {

// Half the size, each pixel the mean of four: where a ball is found at an eighth of the cost.
Frame halved(const Frame& frame) {
  Frame half;
  half.reset(frame.width() / 2, frame.height() / 2, frame.bits);
  const auto shrink = [&](const auto& from, auto& to) {
    for (int y = 0; y < to.height(); ++y) {
      const auto *a = from.row(2 * y), *b = from.row(2 * y + 1);
      for (int x = 0; x < to.width(); ++x) {
        const int sum = a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1];
        to(x, y) = static_cast<std::remove_reference_t<decltype(to(x, y))>>((sum + 2) / 4);
      }
    }
  };
  frame.type == PixelType::kU8 ? shrink(frame.u8, half.u8) : shrink(frame.u16, half.u16);
  return half;
}

std::optional<FoundBall> measured(const Frame& frame, const Circle& near, double centre_sd_px,
                                  const AdviceRequest& request) {
  circle::CirclePrior prior;
  prior.predicted = near;
  prior.centre_sd_px = centre_sd_px;
  const circle::CircleFit fit =
      circle::measure_circle(frame, prior, request.circle, request.backdrop.get());
  if (fit.status != circle::CircleStatus::kOk) return std::nullopt;
  const double oval = fit.ellipse ? std::hypot(fit.e1_px, fit.e2_px) / fit.circle.r_px : 0;
  return FoundBall{fit.circle, std::hypot(fit.cx_sd_px, fit.cy_sd_px) / std::numbers::sqrt2, oval};
}

// Whether the circle may be the ball, as far as scouts tell.
bool is_plausible(const Frame& frame, std::int64_t index, const Circle& found,
                  const AdviceRequest& request) {
  constexpr double kTolerance = 0.2;  // of the radius, as in tracking
  if (request.radius_px &&
      std::abs(found.r_px - *request.radius_px) > kTolerance * *request.radius_px) {
    return false;
  }
  return !circle::stands_still(request.scene.get(), frame, found) &&
         !circle::is_another_ball(request.choice.get(), index, found);
}

// In frame `index` among the analysed ones.
std::optional<FoundBall> find(const Frame& frame, std::int64_t index,
                              const AdviceRequest& request) {
  constexpr int kLarge = 200;  // px; smaller pictures are searched as they are
  const circle::CircleOptions& options = request.circle;
  if (std::min(frame.width(), frame.height()) >= kLarge) {
    circle::CircleOptions of_half = options;
    if (auto& range = of_half.radius_range_px) range = {range->first / 2, range->second / 2};
    if (const auto half = circle::find_ball(halved(frame), of_half)) {
      const Circle whole{2 * half->cx_px + 0.5, 2 * half->cy_px + 0.5, 2 * half->r_px};
      const auto ball = measured(frame, whole, 3, request);
      if (ball && is_plausible(frame, index, *ball, request)) return ball;
    }
  }
  const auto found =
      circle::find_chosen_ball(frame, index, options, request.scene.get(), request.choice.get());
  const auto ball = found ? measured(frame, *found, 2, request) : std::nullopt;
  return ball && is_plausible(frame, index, *ball, request) ? ball : std::nullopt;
}

std::optional<FoundBall> find_known(const Frame& frame, std::int64_t index,
                                    const AdviceRequest& request) {
  for (const circle::BallCandidate::Sighting& seen : request.sightings) {
    if (seen.index != index) continue;
    const auto ball = measured(frame, seen.ball.circle, 2, request);
    if (ball && is_plausible(frame, index, *ball, request)) return ball;
  }
  return std::nullopt;
}

// In a frame that should show it near `guess`.
std::optional<FoundBall> find_near(const Frame& frame, const Circle& guess,
                                   const AdviceRequest& request) {
  constexpr double kMovedPx = 6;
  const auto near = measured(frame, guess, kMovedPx, request);
  if (near && std::abs(near->r_px - guess.r_px) < 0.03 * guess.r_px) return near;
  return std::nullopt;
}

// In the frame after one with the ball at `before`.
std::optional<FoundBall> find_next(const Frame& frame, std::int64_t index, const Circle& before,
                                   const AdviceRequest& request) {
  const auto near = find_near(frame, before, request);
  return near ? near : find(frame, index, request);
}

// The rectangle about the ball, within the frame; all of the frame without one.
Roi about(const Frame& frame, const std::optional<Circle>& ball) {
  if (!ball) return {0, 0, frame.width(), frame.height()};
  const int left = std::max(0, static_cast<int>(ball->cx_px - ball->r_px));
  const int top = std::max(0, static_cast<int>(ball->cy_px - ball->r_px));
  const int right = std::min(frame.width(), static_cast<int>(ball->cx_px + ball->r_px) + 1);
  const int bottom = std::min(frame.height(), static_cast<int>(ball->cy_px + ball->r_px) + 1);
  return {left, top, std::max(0, right - left), std::max(0, bottom - top)};
}

// With the frame before the two, or behind them. A coder's pictures hold those before them by
// design.
std::optional<NoiseMemory> memory_of(FrameSource& source, const AdviceRequest& request,
                                     const Look& look) {
  if (source.info().lossy) return std::nullopt;
  const bool behind = look.index == 0;
  if (behind && request.frames.count() < 3) return std::nullopt;
  const auto third = read_picture(source, request, behind ? 2 : look.index - 1);
  if (!third) return std::nullopt;
  std::vector<Circle> balls;
  for (const auto& ball : {look.first_ball, look.second_ball}) {
    if (ball) balls.push_back(*ball);
  }
  return behind ? noise_memory(look.first, look.second, *third, balls)
                : noise_memory(*third, look.first, look.second, balls);
}

Look look_at(FrameSource& source, const AdviceRequest& request, std::int64_t index, bool two) {
  Look look;
  look.index = index;
  Frame whole;
  try {
    source.read(request.frames.at(index), whole);
    crop(whole, request.roi, look.first);
    if (two) {
      source.read(request.frames.at(index + 1), whole);
      crop(whole, request.roi, look.second);
    }
    look.read = true;
  } catch (const Error&) {
    return look;
  }
  if (request.ball) {
    look.first_ball = find_known(look.first, index, request);
    if (!look.first_ball) look.first_ball = find(look.first, index, request);
    if (two && look.first_ball) {
      look.second_ball = find_next(look.second, index + 1, *look.first_ball, request);
    }
  }
  const Roi region = about(look.first, look.first_ball);
  look.interlaced = is_interlaced(look.first, region);
  look.repeats_pixels = repeats_pixels(look.first, region);
  if (two) look.memory = memory_of(source, request, look);
  if (!request.ball || look.first_ball) {
    look.saturated = saturated_share(look.first, region, look.first_ball);
  }
  if (look.first_ball) look.edge_px = edge_width_px(look.first, *look.first_ball);
  if (look.second_ball) {
    look.turn_deg = turn_between_deg(look.first, *look.first_ball, look.second, *look.second_ball);
  }
  if (!request.ball && two) look.shift_px = shift_between_px(look.first, look.second, region);
  return look;
}

std::vector<Look> look_at_usual_frames(FrameSource& source, const AdviceRequest& request) {
  const std::int64_t count = last_looked_at(source, request.frames) + 1;
  std::vector<std::int64_t> starts = {0};
  if (count >= 4) starts = {0, count - 2};
  if (count >= 6) starts = {0, count / 2, count - 2};
  std::vector<Look> looks(starts.size());
  parallel_for(looks.size(),
               [&](std::size_t k) { looks[k] = look_at(source, request, starts[k], count >= 2); });
  std::erase_if(looks, [](const Look& look) { return !look.read; });
  return looks;
}

// Before a background with a texture a search may find the ball in none of these frames, where
// scouts have seen it in others: then some of those are looked at too.
void look_where_scouts_saw_it(FrameSource& source, const AdviceRequest& request,
                              std::vector<Look>& looks) {
  constexpr std::size_t kMost = 3;
  const auto shows_it_twice = [](const Look& look) { return look.second_ball.has_value(); };
  if (!request.ball || std::ranges::any_of(looks, shows_it_twice)) return;
  AdviceRequest told = request;
  told.sightings = request.spare_sightings;
  const std::int64_t last = last_looked_at(source, request.frames);
  const std::size_t apart = std::max<std::size_t>(1, told.sightings.size() / kMost);
  for (std::size_t k = 0; k < told.sightings.size(); k += apart) {
    if (told.sightings[k].index >= last) continue;
    Look look = look_at(source, told, told.sightings[k].index, true);
    if (look.read && shows_it_twice(look)) looks.push_back(std::move(look));
  }
}

}  // namespace

std::vector<Look> look_around(FrameSource& source, const AdviceRequest& request) {
  std::vector<Look> looks = look_at_usual_frames(source, request);
  look_where_scouts_saw_it(source, request, looks);
  return looks;
}

std::int64_t last_looked_at(FrameSource& source, const FrameRange& frames) {
  constexpr std::int64_t kOfContainer = 48;
  const std::string& format = source.info().format;
  const bool container = format == "AVI" || format == "video container";
  return (container ? std::min(frames.count(), kOfContainer) : frames.count()) - 1;
}

std::optional<Frame> read_picture(FrameSource& source, const AdviceRequest& request,
                                  std::int64_t index) {
  Frame whole, picture;
  try {
    source.read(request.frames.at(index), whole);
    crop(whole, request.roi, picture);
  } catch (const Error&) {
    return std::nullopt;
  }
  return picture;
}

std::optional<FoundBall> look_near(FrameSource& source, const AdviceRequest& request,
                                   std::int64_t index, const Circle& guess) {
  const std::optional<Frame> picture = read_picture(source, request, index);
  return picture ? find_near(*picture, guess, request) : std::nullopt;
}

std::optional<BallPicture> look_for_ball(FrameSource& source, const AdviceRequest& request,
                                         std::int64_t index, const Circle& near) {
  std::optional<Frame> picture = read_picture(source, request, index);
  if (!picture) return std::nullopt;
  const std::optional<FoundBall> ball = find_next(*picture, index, near, request);
  if (!ball) return std::nullopt;
  return BallPicture{std::move(*picture), *ball};
}

}  // namespace impactdic::advice
