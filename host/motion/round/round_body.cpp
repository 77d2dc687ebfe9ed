#include "host/motion/round/round_body.h"

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"

namespace impactdic::motion {
namespace {

// Frames that are looked at, and how many of their views must be left to show what is light.
constexpr std::int64_t kLooks = 32;
constexpr std::size_t kFewestForLight = 6;

double deviation(const std::vector<double>& values) {
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += std::pow(value - mean, 2);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

std::optional<RoundBody> RoundBody::learn(const ReadFrame& read, std::int64_t count) {
  struct Look {
    std::int64_t index = 0;
    Frame frame;
    circle::Silhouette outline;
  };
  std::vector<Look> looks;
  const std::int64_t wanted = std::min(count, kLooks);
  for (std::int64_t k = 0; k < wanted; ++k) {
    const std::int64_t index = wanted > 1 ? k * (count - 1) / (wanted - 1) : 0;
    Frame frame = read(index);
    if (auto outline = circle::find_silhouette(frame)) {
      looks.push_back({index, std::move(frame), *std::move(outline)});
    }
  }
  if (looks.size() < 2 || 2 * static_cast<std::int64_t>(looks.size()) <= wanted) {
    return std::nullopt;
  }
  RoundBody body;
  std::vector<double> radii, along, across;
  body.shortest_px_ = looks.front().outline.short_px();
  for (const Look& look : looks) {
    radii.push_back(std::sqrt(look.outline.long_px() * look.outline.short_px()));
    along.push_back(look.outline.e1_px);
    across.push_back(look.outline.e2_px);
    body.longest_px_ = std::max(body.longest_px_, look.outline.long_px());
    body.shortest_px_ = std::min(body.shortest_px_, look.outline.short_px());
  }
  body.change_ = std::hypot(deviation(radii), deviation(along), deviation(across));
  body.round_.radius_px = upper_median(radii);
  body.change_ /= body.round_.radius_px;
  for (const Look& look : looks) {
    body.views_.emplace_back(look.index, round_view(look.frame, look.outline, body.round_));
  }
  return body;
}

RoundView RoundBody::light_beside(std::int64_t first, std::int64_t second) const {
  std::vector<const RoundView*> others;
  for (const auto& [index, view] : views_) {
    if (index != first && index != second) others.push_back(&view);
  }
  if (others.size() < kFewestForLight) return {};
  RoundView mean(round_.side_px(), round_.side_px());
  for (const RoundView* view : others) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean.data()[i] += view->data()[i] / static_cast<float>(others.size());
    }
  }
  return mean;
}

}  // namespace impactdic::motion
