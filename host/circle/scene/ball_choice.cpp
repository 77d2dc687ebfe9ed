#include "host/circle/scene/ball_choice.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace impactdic::circle {
namespace {

// On the line between the frames before and after; that of the nearest frame beyond them.
Circle place_in(const BallChoice::Places& places, std::int64_t index) {
  const auto after = places.lower_bound(index);
  if (after == places.end()) return std::prev(after)->second;
  if (after == places.begin() || after->first == index) return after->second;
  const auto before = std::prev(after);
  const double t = static_cast<double>(index - before->first) /
                   static_cast<double>(after->first - before->first);
  const Circle &a = before->second, &b = after->second;
  return {std::lerp(a.cx_px, b.cx_px, t), std::lerp(a.cy_px, b.cy_px, t),
          std::lerp(a.r_px, b.r_px, t)};
}

double apart(const Circle& a, const Circle& b) {
  return std::hypot(a.cx_px - b.cx_px, a.cy_px - b.cy_px, a.r_px - b.r_px);
}

}  // namespace

bool BallChoice::is_another(std::int64_t index, const Circle& circle) const {
  const double own = apart(circle, place_in(own_, index));
  return std::any_of(others_.begin(), others_.end(), [&](const Places& other) {
    return apart(circle, place_in(other, index)) < own;
  });
}

}  // namespace impactdic::circle
