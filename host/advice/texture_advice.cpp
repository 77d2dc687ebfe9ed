#include "host/advice/texture_advice.h"

#include <impactdic/units.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/dic/device/ball.h"
#include "host/dic/field.h"
#include "host/dic/frame_noise.h"

namespace impactdic::advice {
namespace {

constexpr int kSizes[] = {9, 11, 15, 21, 31, 41};

// The part of the frame that is looked at.
Roi extent(const TextureRequest& request, const Frame& frame) {
  if (!request.circle) return request.region;
  const Circle& c = *request.circle;
  const int left = std::max(0, static_cast<int>(std::floor(c.cx_px - c.r_px)));
  const int top = std::max(0, static_cast<int>(std::floor(c.cy_px - c.r_px)));
  const int right = std::min(frame.width(), static_cast<int>(std::ceil(c.cx_px + c.r_px)) + 1);
  const int bottom = std::min(frame.height(), static_cast<int>(std::ceil(c.cy_px + c.r_px)) + 1);
  return {left, top, std::max(0, right - left), std::max(0, bottom - top)};
}

std::vector<Window> windows_on(const TextureRequest& request, const Roi& part, int window_px) {
  const int spacing = (window_px + 1) / 2;
  if (!request.circle) {
    return dic::rectangle_grid(0, 0, part.width, part.height, window_px, spacing);
  }
  const Circle& c = *request.circle;
  return dic::disc_grid(c.cx_px - part.x, c.cy_px - part.y, c.r_px - request.rim_margin_px,
                        window_px, spacing);
}

SizeAdvice advise_size(const dic::PictureSlopes& slopes, const TextureRequest& request,
                       const Roi& part, int window_px, double noise, double level) {
  SizeAdvice advice;
  advice.window_px = window_px;
  std::vector<double> errors, contrasts;
  for (const Window& window : windows_on(request, part, window_px)) {
    if (window.x0 < 0 || window.y0 < 0 || window.x0 + window_px > slopes.width() ||
        window.y0 + window_px > slopes.height()) {
      continue;
    }
    ++advice.windows;
    const dic::WindowBound bound = slopes.affine_window(window.x0, window.y0, window_px, noise);
    contrasts.push_back(bound.contrast / level);
    const double error = std::hypot(bound.u_sd_px, bound.v_sd_px) / std::sqrt(2.0);
    if (!(bound.expected_sd_px <= request.max_sd_px) || contrasts.back() < request.min_texture) {
      continue;
    }
    ++advice.usable;
    errors.push_back(error);
  }
  advice.error_px = upper_median(std::move(errors));
  advice.contrast = upper_median(std::move(contrasts));
  return advice;
}

}  // namespace

TextureAdvice advise_texture(const Frame& frame, const TextureRequest& request) {
  TextureAdvice advice;
  const Image<float> whole = frame.to_float();
  const Roi part = extent(request, frame);
  if (part.width < 1 || part.height < 1) return advice;
  const ImageView<const float> picture{whole.row(part.y) + part.x, part.width, part.height,
                                       whole.width()};
  const double level = frame.full_scale() / 255;
  const double noise = dic::estimate_noise(whole.view(), frame.full_scale());
  advice.noise = noise / level;
  const dic::PictureSlopes slopes(picture, noise);
  const auto size = [&](int window_px) {
    return advise_size(slopes, request, part, window_px, noise, level);
  };
  std::vector<int> sizes = {request.window_px};
  for (const int window_px : kSizes) {
    if (request.asked_alone) break;
    if (window_px <= std::min(part.width, part.height)) sizes.push_back(window_px);
  }
  advice.sizes.resize(sizes.size());
  // The size that is asked for may be one of the others, too: judged once.
  const auto is_asked_again = [&](std::size_t k) { return k > 0 && sizes[k] == sizes[0]; };
  tbb::this_task_arena::isolate([&] {
    parallel_for(sizes.size(), [&](std::size_t k) {
      if (!is_asked_again(k)) advice.sizes[k] = size(sizes[k]);
    });
  });
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    if (is_asked_again(k)) advice.sizes[k] = advice.sizes.front();
  }
  advice.asked = advice.sizes.front();
  advice.sizes.erase(advice.sizes.begin());
  if (request.circle && !request.asked_alone) {
    advice.ball = slopes.disc(request.circle->cx_px - part.x, request.circle->cy_px - part.y,
                              request.circle->r_px - dic::kRimMarginPx, noise);
  }
  return advice;
}

}  // namespace impactdic::advice

namespace impactdic {

int window_reaching(const TextureAdvice& advice, double error_px) {
  constexpr double kMostUsable = 0.9;
  for (const SizeAdvice& size : advice.sizes) {
    if (size.usable_share() >= kMostUsable && size.error_px <= error_px) return size.window_px;
  }
  return 0;
}

}  // namespace impactdic
