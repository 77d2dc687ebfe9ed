#include "host/advice/along_path.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "host/base/parallel/parallel_for.h"

namespace impactdic::advice {
namespace {

// Places lie so far from each other, in radii of the ball, or farther where they would be too many.
constexpr double kApart = 0.7, kWider = 1.4;
constexpr std::size_t kMost = 32;
// The ball's way between the frames that tell its velocity at a place, px.
constexpr double kPath_px = 6;

struct Place {
  std::int64_t index = 0;
  Circle ball;
};

double distance_px(const Circle& a, const Circle& b) {
  return std::hypot(a.cx_px - b.cx_px, a.cy_px - b.cy_px);
}

// Where the ball is known to be, in order of time.
std::vector<Place> known_places(const std::vector<MovedBall>& moved,
                                std::span<const circle::BallCandidate::Sighting> seen,
                                std::int64_t count) {
  std::vector<Place> known;
  for (const MovedBall& one : moved) known.push_back({one.index, one.ball});
  for (const circle::BallCandidate::Sighting& one : seen) {
    if (one.index < count) known.push_back({one.index, one.ball.circle});
  }
  std::ranges::stable_sort(known, {}, &Place::index);
  const auto same = [](const Place& a, const Place& b) { return a.index == b.index; };
  known.erase(std::unique(known.begin(), known.end(), same), known.end());
  return known;
}

// Of a straight way from one place to another, the places up to this one so far apart.
void add_way(const Place& from, const Place& to, double apart_px, std::vector<Place>& way) {
  const double length_px = distance_px(from.ball, to.ball);
  const auto parts = std::clamp<std::int64_t>(std::llround(std::ceil(length_px / apart_px)), 1,
                                              to.index - from.index);
  for (std::int64_t k = 1; k <= parts; ++k) {
    const std::int64_t index = from.index + k * (to.index - from.index) / parts;
    const double share =
        static_cast<double>(index - from.index) / static_cast<double>(to.index - from.index);
    Place place{index, from.ball};
    place.ball.cx_px += share * (to.ball.cx_px - from.ball.cx_px);
    place.ball.cy_px += share * (to.ball.cy_px - from.ball.cy_px);
    way.push_back(place);
  }
}

// Places of the path that lie apart from each other and from those that were looked at.
std::vector<Place> places_apart(const std::vector<Place>& known,
                                const std::vector<MovedBall>& moved, double apart_px) {
  std::vector<Place> way = {known.front()}, apart;
  for (std::size_t k = 1; k < known.size(); ++k) add_way(known[k - 1], known[k], apart_px, way);
  for (const Place& place : way) {
    const auto is_beside = [&](const auto& other) {
      return distance_px(other.ball, place.ball) < 0.5 * apart_px;
    };
    if (std::ranges::none_of(moved, is_beside) && std::ranges::none_of(apart, is_beside)) {
      apart.push_back(place);
    }
  }
  return apart;
}

// The ball at a place, if it is there.
std::optional<MovedBall> moved_at(const Place& place, const std::vector<MovedBall>& moved,
                                  const FarFrames& frames) {
  const auto away = [&](const MovedBall& one) { return std::abs(one.index - place.index); };
  const MovedBall& nearest = *std::ranges::min_element(moved, {}, away);
  const std::optional<FoundBall> here = frames.find_near(place.index, place.ball);
  if (!here) return std::nullopt;
  const dic::RigidMotion& step = nearest.step;
  const double by_step_px = std::hypot(step.dx_px, step.dy_px);
  const double wanted = std::ceil(kPath_px / std::max(by_step_px, 1e-6));
  const std::int64_t ahead = frames.count - 1 - place.index;
  const std::int64_t most = std::max(ahead, place.index);
  const auto way = static_cast<std::int64_t>(std::min(wanted, static_cast<double>(most)));
  const std::int64_t to = way <= ahead ? way : -way;
  Circle guess = *here;
  guess.cx_px += static_cast<double>(to) * step.dx_px;
  guess.cy_px += static_cast<double>(to) * step.dy_px;
  const std::optional<FoundBall> there = frames.find_near(place.index + to, guess);
  if (!there) return std::nullopt;
  MovedBall ball{place.index, *here, step};
  ball.step.dx_px = (there->cx_px - here->cx_px) / static_cast<double>(to);
  ball.step.dy_px = (there->cy_px - here->cy_px) / static_cast<double>(to);
  return ball;
}

}  // namespace

std::vector<MovedBall> along_path(const std::vector<MovedBall>& moved,
                                  std::span<const circle::BallCandidate::Sighting> seen,
                                  const FarFrames& frames) {
  if (moved.empty() || frames.count < 2) return moved;
  const std::vector<Place> known = known_places(moved, seen, frames.count);
  double apart_px = kApart * moved.front().ball.r_px;
  std::vector<Place> places = places_apart(known, moved, apart_px);
  while (places.size() > kMost) places = places_apart(known, moved, apart_px *= kWider);
  std::vector<std::optional<MovedBall>> found(places.size());
  parallel_for(places.size(),
               [&](std::size_t k) { found[k] = moved_at(places[k], moved, frames); });
  std::vector<MovedBall> all = moved;
  for (const std::optional<MovedBall>& ball : found) {
    if (ball) all.push_back(*ball);
  }
  return all;
}

}  // namespace impactdic::advice
