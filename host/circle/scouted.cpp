// What the scouts of a clip believe.
#include <algorithm>
#include <utility>

#include "host/circle/scene/ball_choice.h"
#include "host/circle/scout_ball.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {

std::optional<double> Scouted::radius_px() const {
  if (balls.empty()) return std::nullopt;
  return balls.front().radius_px;
}

bool Scouted::is_believed(const BallCandidate& ball) const {
  const int enough = std::min(kScout.agree, (frames + 1) / 2);
  if (static_cast<int>(ball.sightings.size()) < enough) return false;
  return moves(ball) || ball.rim_fraction >= kScout.resting_rim;
}

bool Scouted::moves(const BallCandidate& ball) {
  return ball.moved_px > std::max(kScout.moved_px, kScout.moved_of_r * ball.radius_px);
}

std::vector<const BallCandidate*> Scouted::believed() const {
  std::vector<const BallCandidate*> found;
  for (const BallCandidate& ball : balls) {
    if (is_believed(ball)) found.push_back(&ball);
  }
  return found;
}

std::shared_ptr<const BallChoice> Scouted::choose(const BallCandidate& ball) const {
  const auto places = [](const BallCandidate& one) {
    BallChoice::Places seen;
    for (const BallCandidate::Sighting& sighting : one.sightings) {
      seen.emplace(sighting.index, sighting.ball.circle);
    }
    return seen;
  };
  std::vector<BallChoice::Places> others;
  for (const BallCandidate* other : believed()) {
    if (other != &ball) others.push_back(places(*other));
  }
  if (others.empty()) return nullptr;
  return std::make_shared<BallChoice>(places(ball), std::move(others));
}

void Scouted::put_mover_first() {
  if (balls.empty() || moves(balls.front())) return;
  const double enough = kScout.as_plain * balls.front().score;
  const auto mover = std::ranges::find_if(balls, [&](const BallCandidate& ball) {
    return moves(ball) && ball.moved_px > kScout.plainly_moved_of_r * ball.radius_px &&
           is_believed(ball) && ball.score > enough;
  });
  if (mover != balls.end()) std::rotate(balls.begin(), mover, mover + 1);
}

bool Scouted::rests_beside_the_best() const {
  return !balls.empty() && is_believed(balls.front()) && moves(balls.front()) &&
         std::ranges::any_of(believed(), [](const BallCandidate* ball) { return !moves(*ball); });
}

const BallCandidate* Scouted::second_ball() const {
  // Seen at once: the same ball may look larger in a hand, or nearer to the camera.
  const auto beside_the_best = [&](const BallCandidate::Sighting& one) {
    const std::vector<BallCandidate::Sighting>& best = balls.front().sightings;
    return std::any_of(best.begin(), best.end(), [&](const BallCandidate::Sighting& other) {
      return other.index == one.index;
    });
  };
  for (std::size_t i = 1; i < balls.size(); ++i) {
    const BallCandidate& ball = balls[i];
    const auto at_once =
        std::count_if(ball.sightings.begin(), ball.sightings.end(), beside_the_best);
    if (at_once >= kScout.at_once && ball.rim_fraction >= kScout.other_rim && is_believed(ball) &&
        ball.radius_px >= kScout.other_of_r * balls.front().radius_px) {
      return &ball;
    }
  }
  return nullptr;
}

}  // namespace impactdic::circle
