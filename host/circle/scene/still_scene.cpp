#include "host/circle/scene/still_scene.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "host/base/statistics.h"
#include "host/circle/circle.h"
#include "host/circle/settings/backdrop.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

// The pictures' values in ascending order, pixel by pixel, down to the lowest quarter.
std::vector<cv::Mat> sorted(const std::vector<cv::Mat>& pictures) {
  std::vector<cv::Mat> planes;
  for (const cv::Mat& picture : pictures) planes.push_back(picture.clone());
  cv::Mat less;
  for (std::size_t end = planes.size(); end > planes.size() / 4; --end) {
    for (std::size_t i = 0; i + 1 < end; ++i) {
      cv::min(planes[i], planes[i + 1], less);
      cv::max(planes[i], planes[i + 1], planes[i + 1]);
      std::swap(planes[i], less);
    }
  }
  return planes;
}

// Every so many pixels of the picture, some thousands in all.
std::vector<double> some_values(const cv::Mat& picture) {
  const int step = std::max(1, static_cast<int>(std::sqrt(picture.total() / kStill.some)));
  std::vector<double> values;
  for (int y = step / 2; y < picture.rows; y += step) {
    const float* row = picture.ptr<float>(y);
    for (int x = step / 2; x < picture.cols; x += step) values.push_back(row[x]);
  }
  return values;
}

// How much brighter the picture is than the still one: lamps flicker.
double gain(const cv::Mat& picture, const cv::Mat& still) {
  const std::vector<double> a = some_values(picture), b = some_values(still);
  const double bright = 0.5 * upper_median(b);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (b[i] > bright && b[i] > 0) ratios.push_back(a[i] / b[i]);
  }
  return ratios.empty() ? 1 : std::max(upper_median(std::move(ratios)), 1e-3);
}

// How pixels that stand still scatter: quartiles of a normal deviate. `planes`: sorted.
double scatter_of(const std::vector<cv::Mat>& planes) {
  const std::size_t n = planes.size();
  return upper_median(some_values(planes[n - 1 - n / 4] - planes[n / 4])) / 1.35;
}

// Sorted as in one light where that is plainly what they differ by: a lamp that dims would look
// like noise, behind which nothing moves.
std::vector<cv::Mat> sorted_in_one_light(const std::vector<cv::Mat>& pictures) {
  std::vector<cv::Mat> as_seen = sorted(pictures), even;
  const cv::Mat& still = as_seen[as_seen.size() / 2];
  for (const cv::Mat& picture : pictures) even.emplace_back(picture / gain(picture, still));
  even = sorted(even);
  return scatter_of(even) < kStill.other_light * scatter_of(as_seen) ? even : as_seen;
}

// What makes a difference: noise, edges that tremble with the camera, and a part of the contrast.
cv::Mat threshold_of(const cv::Mat& still, double noise) {
  cv::Mat right, down;
  cv::Sobel(still, right, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(still, down, CV_32F, 0, 1, 3, 0.125);
  cv::Mat slope;
  cv::magnitude(right, down, slope);
  std::vector<double> levels = some_values(still);
  std::sort(levels.begin(), levels.end());
  const double range = levels[levels.size() * 99 / 100] - levels[levels.size() / 100];
  return kStill.tremble_px * slope + (kStill.noises * noise + kStill.of_range * range);
}

double changed_share(const cv::Mat& moved) {
  return static_cast<double>(cv::countNonZero(moved)) / static_cast<double>(moved.total());
}

}  // namespace

int StillScene::shrink_of(const Frame& frame) {
  return (std::max(frame.width(), frame.height()) - 1) / kStill.longer_side_px + 1;
}

cv::Mat StillScene::reduced(const Frame& frame) {
  const int depth = frame.type == PixelType::kU8 ? CV_8U : CV_16U;
  const cv::Mat whole(frame.height(), frame.width(), depth, const_cast<void*>(frame.bytes()));
  cv::Mat picture = whole;
  if (const int shrink = shrink_of(frame); shrink > 1) {
    const cv::Size size(std::max(8, frame.width() / shrink), std::max(8, frame.height() / shrink));
    cv::resize(whole, picture, size, 0, 0, cv::INTER_AREA);
  }
  cv::Mat smooth;
  picture.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {}, kStill.blur_px);
  return smooth;
}

StillScene::Learnt StillScene::learn(const std::vector<cv::Mat>& pictures, int shrink) {
  if (pictures.size() < kStill.least_frames) return {};
  const std::shared_ptr<StillScene> scene(new StillScene);
  scene->shrink_ = shrink;
  const std::vector<cv::Mat> planes = sorted_in_one_light(pictures);
  const std::size_t n = planes.size();
  scene->median_ = planes[n / 2];
  const double noise = scatter_of(planes);
  scene->threshold_ = threshold_of(scene->median_, noise);
  scene->times_moved_ = cv::Mat::zeros(scene->median_.size(), CV_8U);
  std::vector<double> shares;
  for (const cv::Mat& picture : pictures) {
    scene->movements_.push_back(scene->compare(picture));
    scene->times_moved_ += scene->movements_.back() & 1;
    shares.push_back(changed_share(scene->movements_.back()));
  }
  const double most_px = *std::max_element(shares.begin(), shares.end()) * scene->median_.total();
  if (most_px < kStill.least_moved_px) return {nullptr, true};
  if (upper_median(shares) > kStill.most_moved) return {};
  return {scene, false};
}

cv::Mat StillScene::compare(const cv::Mat& reduced) const {
  cv::Mat off;
  cv::absdiff(reduced / gain(reduced, median_), median_, off);
  return off > threshold_;
}

std::vector<StillScene::DiscRow> StillScene::rows_of(const Circle& circle, cv::Size size) const {
  const double half = 0.5 * (shrink_ - 1);
  const double cx = (circle.cx_px - half) / shrink_, cy = (circle.cy_px - half) / shrink_;
  const double r = std::max(circle.r_px / shrink_, 1.0);
  const int left = std::max(0, static_cast<int>(std::ceil(cx - r)));
  const int bottom = std::min(size.height - 1, static_cast<int>(std::floor(cy + r)));
  const int right = std::min(size.width - 1, static_cast<int>(std::floor(cx + r)));
  std::vector<DiscRow> rows;
  for (int y = std::max(0, static_cast<int>(std::ceil(cy - r))); y <= bottom; ++y) {
    const auto outside = [&](int x) { return (x - cx) * (x - cx) + (y - cy) * (y - cy) > r * r; };
    int begin = left, end = right + 1;
    while (begin < end && outside(begin)) ++begin;
    while (begin < end && outside(end - 1)) --end;
    if (begin < end) rows.push_back({y, begin, end});
  }
  return rows;
}

double StillScene::share_of(const cv::Mat& moved, const std::vector<DiscRow>& rows) {
  int inside = 0, changed = 0;
  for (const DiscRow& at : rows) {
    const std::uint8_t* row = moved.ptr(at.y);
    inside += at.end - at.begin;
    for (int x = at.begin; x < at.end; ++x) changed += row[x] != 0;
  }
  return inside > 0 ? static_cast<double>(changed) / inside : 0;
}

double StillScene::moved_share(const cv::Mat& moved, const Circle& circle) const {
  return share_of(moved, rows_of(circle, moved.size()));
}

bool StillScene::holds_all_that_moves(const Circle& circle) const {
  Circle wider = circle;
  wider.r_px += kStill.about_px * shrink_;
  double inside = 0;
  for (const DiscRow& at : rows_of(wider, times_moved_.size())) {
    const std::uint8_t* row = times_moved_.ptr(at.y);
    inside = std::accumulate(row + at.begin, row + at.end, inside);
  }
  return inside > kStill.of_all_moved * cv::sum(times_moved_)[0];
}

bool StillScene::is_still(const cv::Mat& moved, const Circle& circle, double rim_fraction) const {
  return rests(moved, circle) &&
         !(rim_fraction >= kStill.enough_rim && holds_all_that_moves(circle));
}

bool StillScene::rests(const cv::Mat& moved, const Circle& circle) const {
  const std::vector<DiscRow> rows = rows_of(circle, moved.size());
  const auto same = [&](const cv::Mat& picture) {
    return share_of(picture, rows) < kStill.changed;
  };
  if (!same(moved)) return false;
  const auto others = std::count_if(movements_.begin(), movements_.end(),
                                    [&](const cv::Mat& picture) { return !same(picture); });
  return static_cast<double>(others) <= kStill.passing * static_cast<double>(movements_.size());
}

std::optional<Circle> StillScene::moved_disc(const cv::Mat& moved) const {
  const int size = kBallSearch.disc_px[0];
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * size + 1, 2 * size + 1});
  cv::Mat blob;
  cv::morphologyEx(moved, blob, cv::MORPH_CLOSE, disc);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(blob, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(blob, outlines, -1, 255, cv::FILLED);
  cv::morphologyEx(blob, blob, cv::MORPH_OPEN, disc);
  cv::findContours(blob, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  if (outlines.empty()) return std::nullopt;
  const auto area = [](const auto& outline) { return cv::contourArea(outline); };
  const auto& largest = *std::ranges::max_element(outlines, {}, area);
  const cv::Rect box = cv::boundingRect(largest);
  const bool whole = box.x > 0 && box.y > 0 && box.br().x < blob.cols && box.br().y < blob.rows;
  // Where the ball is as the wall is, the blob has gaps; its hull has none.
  std::vector<cv::Point> hull;
  cv::convexHull(largest, hull);
  blob.setTo(0);
  cv::fillConvexPoly(blob, hull, 255);
  cv::Mat depth;
  cv::distanceTransform(blob, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double r = 0;
  cv::Point centre;
  cv::minMaxLoc(depth, nullptr, &r, nullptr, &centre);
  if (!whole || kPi * r * r < kBackdrop.moved_round * cv::contourArea(hull)) return std::nullopt;
  const double half = 0.5 * (shrink_ - 1);
  return Circle{centre.x * shrink_ + half, centre.y * shrink_ + half, r * shrink_};
}

bool stands_still(const StillScene* scene, const Frame& frame, const Circle& circle) {
  return scene != nullptr && scene->rests(scene->moved(frame), circle);
}

}  // namespace impactdic::circle
