// The background's texture by what views agree on in which the ball lies elsewhere.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "host/base/statistics.h"
#include "host/circle/rays/frame_level.h"
#include "host/circle/scene/backdrop.h"
#include "host/circle/scene/outline_places.h"
#include "host/circle/settings/backdrop.h"

namespace impactdic::circle {
namespace {

using View = Backdrop::View;
using Outline = Backdrop::Outline;

constexpr double kFar_px = 30;  // distances beyond this make no difference

cv::Mat header_of(const Frame& frame) {
  const int depth = frame.type == PixelType::kU8 ? CV_8U : CV_16U;
  return {frame.height(), frame.width(), depth, const_cast<void*>(frame.bytes())};
}

// How far each pixel lies outside the balls of a view, px; negative within one.
cv::Mat distances(const View& view) {
  cv::Mat off(view.frame->height(), view.frame->width(), CV_32F, cv::Scalar(kFar_px));
  for (const Outline& ball : view.balls) {
    const cv::Rect box = box_about(ball, kFar_px, off.size());
    for (int y = box.y; y < box.br().y; ++y) {
      float* row = off.ptr<float>(y);
      for (int x = box.x; x < box.br().x; ++x) {
        row[x] = std::min(row[x], static_cast<float>(ball.distance_to(x, y)));
      }
    }
  }
  return off;
}

// What the views that show a pixel's background agree on.
struct Learnt {
  cv::Mat level;             // 32-bit floats; 0 where no view shows it
  cv::Mat unseen;            // 255 where no view shows it
  double noise = 0;          // of one view
  std::vector<cv::Mat> off;  // of each view: how far a pixel lies outside its balls
};

// `clear_px`: from there on a pixel outside the rim shows no ball. The median of the views in which
// it lies well outside, or that of them in which it lies farthest.
Learnt agreed(std::span<const View> views, double clear_px) {
  std::vector<cv::Mat> pictures, off;
  for (const View& view : views) {
    pictures.emplace_back();
    header_of(*view.frame).convertTo(pictures.back(), CV_32F);
    off.push_back(distances(view));
  }
  const cv::Size size = pictures.front().size();
  Learnt learnt{cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_8U)};
  std::vector<float> levels;
  std::vector<double> steps;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      levels.clear();
      std::size_t farthest = 0;
      for (std::size_t k = 0; k < views.size(); ++k) {
        if (off[k].at<float>(y, x) >= kBackdrop.well_clear_px) {
          levels.push_back(pictures[k].at<float>(y, x));
        }
        if (off[k].at<float>(y, x) > off[farthest].at<float>(y, x)) farthest = k;
      }
      if (off[farthest].at<float>(y, x) < clear_px) {
        learnt.unseen.at<std::uint8_t>(y, x) = 255;
        continue;
      }
      if (levels.size() > 1 && (x + y) % 7 == 0) steps.push_back(std::abs(levels[0] - levels[1]));
      if (levels.empty()) levels.push_back(pictures[farthest].at<float>(y, x));
      const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 2);
      std::nth_element(levels.begin(), middle, levels.end());
      learnt.level.at<float>(y, x) = *middle;
    }
  }
  if (!steps.empty()) {
    learnt.noise = kSdOfMad * upper_median(std::move(steps)) / std::numbers::sqrt2;
  }
  learnt.off = std::move(off);
  return learnt;
}

// A plane through what is known about a pixel, there; nullopt where that is too little.
std::optional<float> by_plane(const Learnt& learnt, const cv::Mat& known, int x, int y) {
  const int half = kBackdrop.plane_half_px;
  double n = 0, su = 0, sv = 0, suu = 0, suv = 0, svv = 0, sl = 0, sul = 0, svl = 0;
  for (int v = -half; v <= half; ++v) {
    for (int u = -half; u <= half; ++u) {
      const int px = x + u, py = y + v;
      if (px < 0 || py < 0 || px >= known.cols || py >= known.rows) continue;
      if (known.at<std::uint8_t>(py, px) == 0) continue;
      const double level = learnt.level.at<float>(py, px);
      n += 1, su += u, sv += v, suu += u * u, suv += u * v, svv += v * v;
      sl += level, sul += u * level, svl += v * level;
    }
  }
  if (n < kBackdrop.plane_least) return std::nullopt;
  const cv::Matx33d a(n, su, sv, su, suu, suv, sv, suv, svv);
  if (std::abs(cv::determinant(a)) < 1e-6 * n * n * n) return std::nullopt;
  return static_cast<float>((a.inv() * cv::Vec3d(sl, sul, svl))[0]);
}

// What no view shows: by a plane beside what is known, farther in as the nearest pixel. Returns
// where none is near.
cv::Mat spread(Learnt& learnt) {
  const cv::Mat known = learnt.unseen == 0;
  cv::Mat distance, labels;
  cv::distanceTransform(learnt.unseen, distance, labels, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<float> levels(learnt.unseen.total() + 1);
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const auto label = static_cast<std::size_t>(labels.at<int>(y, x));
      if (known.at<std::uint8_t>(y, x) != 0) levels[label] = learnt.level.at<float>(y, x);
    }
  }
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      if (known.at<std::uint8_t>(y, x) != 0) continue;
      std::optional<float> level;
      if (distance.at<float>(y, x) < kBackdrop.plane_px) level = by_plane(learnt, known, x, y);
      const auto label = static_cast<std::size_t>(labels.at<int>(y, x));
      learnt.level.at<float>(y, x) = level.value_or(levels[label]);
    }
  }
  return distance > kBackdrop.spread_px;
}

// Where the rim of a ball lies in one of the views: so far outside it.
cv::Mat beside_the_rims(std::span<const View> views) {
  cv::Mat beside =
      cv::Mat::zeros(views.front().frame->height(), views.front().frame->width(), CV_8U);
  for (const View& view : views) {
    for (const Outline& ball : view.balls) {
      const cv::Rect box = box_about(ball, kBackdrop.beside_px, beside.size());
      for (int y = box.y; y < box.br().y; ++y) {
        for (int x = box.x; x < box.br().x; ++x) {
          const double off = ball.distance_to(x, y);
          if (off > 0 && off < kBackdrop.beside_px) beside.at<std::uint8_t>(y, x) = 255;
        }
      }
    }
  }
  return beside;
}

// How much the background varies over some pixels there, rms.
double roughness(const cv::Mat& level, const cv::Mat& where) {
  cv::Mat mean, squares;
  const cv::Size square(kBackdrop.around_px, kBackdrop.around_px);
  cv::boxFilter(level, mean, CV_32F, square);
  cv::sqrBoxFilter(level, squares, CV_32F, square);
  const cv::Mat variance = squares - mean.mul(mean);
  return std::sqrt(std::max(0.0, cv::mean(variance, where)[0]));
}

float median_of(const cv::Mat& level, const cv::Mat& where) {
  std::vector<float> levels;
  for (int y = 0; y < where.rows; ++y) {
    for (int x = 0; x < where.cols; ++x) {
      if (where.at<std::uint8_t>(y, x) != 0) levels.push_back(level.at<float>(y, x));
    }
  }
  return upper_median(std::move(levels));
}

// What makes a texture that matters, at least.
double least_roughness(double noise, double full_scale) {
  return kBackdrop.noises * noise + kBackdrop.of_range * full_scale;
}

// Whether a view's background may be rough beside its ball, by that view alone; the noise from its
// difference to another one. Spares all that follows where the wall is even.
bool may_be_rough(const View& view, const View& other) {
  const Outline& ball = view.balls.front();
  const cv::Mat whole = header_of(*view.frame), before = header_of(*other.frame);
  const int half = kBackdrop.around_px / 2 + 1;
  const cv::Rect box = box_about(ball, kBackdrop.beside_px + 2 * half, whole.size());
  if (box.width <= half || box.height <= half) return false;
  cv::Mat level, elsewhere, beside = cv::Mat::zeros(box.size(), CV_8U);
  whole(box).convertTo(level, CV_32F);
  before(box).convertTo(elsewhere, CV_32F);
  std::vector<double> steps;
  for (int y = 0; y < box.height; ++y) {
    for (int x = 0; x < box.width; ++x) {
      const double off = ball.distance_to(x + box.x, y + box.y);
      if (off < half + 1 || off > kBackdrop.beside_px + half) continue;
      beside.at<std::uint8_t>(y, x) = 255;
      steps.push_back(std::abs(level.at<float>(y, x) - elsewhere.at<float>(y, x)));
    }
  }
  if (steps.empty()) return false;
  const double noise = kSdOfMad * upper_median(std::move(steps)) / std::numbers::sqrt2;
  const double rough = roughness(level, beside);
  const double least = kBackdrop.may_be * least_roughness(noise, view.frame->full_scale());
  return rough * rough - noise * noise > least * least;
}

bool may_be_rough(std::span<const View> views) {
  const std::size_t step = std::max<std::size_t>(1, views.size() / kBackdrop.looked_at);
  for (std::size_t k = 0; k < views.size(); k += step) {
    if (may_be_rough(views[k], views[k == 0 ? 1 : k - 1])) return true;
  }
  return false;
}

// Levels that are the same differ by less.
double same_level(const Learnt& learnt, double full_scale) {
  return kBackdrop.same_noises * learnt.noise + kBackdrop.of_range * full_scale;
}

// The share of a rim within which the background goes on, in a view: what is in front of the ball.
// As other views show it there; or, `as_outside`, as it is outside the rim, for other views show
// little of it where their balls are known roughly.
double hidden_share(const View& view, const Learnt& learnt, const Outline& ball, bool as_outside) {
  const cv::Rect all(0, 0, learnt.level.cols, learnt.level.rows);
  const double clear = kBackdrop.rough_px;
  const double same = same_level(learnt, view.frame->full_scale());
  int seen = 0, hidden = 0;
  for (int k = 0; k < kRimPoints; ++k) {
    const double angle = 2 * std::numbers::pi * k / kRimPoints;
    int inside = 0, alike = 0;
    for (const double deep : {1.0, 2.0, 3.0, 4.0}) {
      const cv::Point in = rim_point(ball, angle, -deep * clear);
      const cv::Point out = rim_point(ball, angle, clear + 1);
      if (!all.contains(in) || !all.contains(out)) continue;
      const double level = level_at(*view.frame, in.x, in.y);
      const bool known = !as_outside && learnt.unseen.at<std::uint8_t>(in) == 0;
      const cv::Point shown = known ? in : out;
      ++inside;
      alike += std::abs(level - learnt.level.at<float>(shown)) < same;
    }
    seen += inside > 0;
    hidden += inside > 0 && alike == inside;
  }
  return seen > 0 ? static_cast<double>(hidden) / seen : 0;
}

// Of the pixels of a view under a rim whose texture is plain, the share that shows it: of wires in
// front of the ball all do, of lines behind it those do on which ink happens to lie.
double through_share(const View& view, const Learnt& learnt, const Outline& ball, double even) {
  const cv::Rect all(0, 0, learnt.level.cols, learnt.level.rows);
  const double same = same_level(learnt, view.frame->full_scale());
  int textured = 0, shown = 0;
  for (int k = 0; k < kRimPoints; ++k) {
    const double angle = 2 * std::numbers::pi * k / kRimPoints;
    for (double deep = kBackdrop.rough_px; deep < kBackdrop.deep_of_r * ball.circle.r_px; ++deep) {
      const cv::Point in = rim_point(ball, angle, -deep);
      if (!all.contains(in) || learnt.unseen.at<std::uint8_t>(in) != 0) continue;
      const double there = learnt.level.at<float>(in);
      if (std::abs(there - even) < kBackdrop.plain_levels * same) continue;
      ++textured;
      shown += std::abs(level_at(*view.frame, in.x, in.y) - there) < same;
    }
  }
  return textured >= kRimPoints ? static_cast<double>(shown) / textured : 0;
}

// Whether something stands still in front of the balls.
bool is_hidden(std::span<const View> views, const Learnt& learnt, double even, bool as_outside) {
  std::vector<double> shares, through;
  for (const View& view : views) {
    for (const Outline& ball : view.balls) {
      shares.push_back(hidden_share(view, learnt, ball, as_outside));
      through.push_back(through_share(view, learnt, ball, even));
    }
  }
  return upper_median(std::move(shares)) > kBackdrop.most_hidden ||
         upper_median(std::move(through)) > kBackdrop.most_through;
}

// The share of what the views show beside their balls that is not what was learnt: of a background
// that moves, as leaves and shadows do.
double changing_share(std::span<const View> views, const Learnt& learnt, const cv::Mat& beside) {
  const double same = same_level(learnt, views.front().frame->full_scale());
  double seen = 0, changed = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    for (int y = 0; y < beside.rows; ++y) {
      for (int x = 0; x < beside.cols; ++x) {
        if (beside.at<std::uint8_t>(y, x) == 0 || learnt.unseen.at<std::uint8_t>(y, x) != 0 ||
            learnt.off[k].at<float>(y, x) < kBackdrop.well_clear_px) {
          continue;
        }
        ++seen;
        const double level = level_at(*views[k].frame, x, y);
        changed += std::abs(level - static_cast<double>(learnt.level.at<float>(y, x))) > same;
      }
    }
  }
  return seen > 0 ? changed / seen : 0;
}

}  // namespace

std::shared_ptr<const Backdrop> Backdrop::learn(std::span<const View> views, Known known) {
  if (views.size() < kBackdrop.least_views || !may_be_rough(views)) return nullptr;
  Learnt learnt = agreed(views, known == Known::kWell ? kBackdrop.clear_px : kBackdrop.rough_px);
  const cv::Mat unknown = spread(learnt);
  const cv::Mat beside = beside_the_rims(views) & ~unknown;
  if (cv::countNonZero(beside) == 0) return nullptr;
  const double least = least_roughness(learnt.noise, views.front().frame->full_scale());
  if (roughness(learnt.level, beside) < least) return nullptr;
  const float even = median_of(learnt.level, beside);
  if (known != Known::kWithin && is_hidden(views, learnt, even, known == Known::kRoughly))
    return nullptr;
  if (changing_share(views, learnt, beside) > kBackdrop.most_changing) return nullptr;
  Image<float> texture(beside.cols, beside.rows);
  Image<std::uint8_t> guessed(beside.cols, beside.rows);
  for (int y = 0; y < beside.rows; ++y) {
    for (int x = 0; x < beside.cols; ++x) {
      const bool is_known = unknown.at<std::uint8_t>(y, x) == 0;
      texture(x, y) = is_known ? learnt.level.at<float>(y, x) - even : 0;
      guessed(x, y) = learnt.unseen.at<std::uint8_t>(y, x) != 0;
    }
  }
  return std::shared_ptr<const Backdrop>(new Backdrop(std::move(texture), std::move(guessed)));
}

}  // namespace impactdic::circle
