#include "host/circle/scout_ball.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/circle/scene/ball_choice.h"
#include "host/circle/scene/still_scene.h"
#include "host/circle/scout_backdrop.h"
#include "host/circle/settings/backdrop.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

using Sighting = BallCandidate::Sighting;

// A frame of the clip that was looked at.
struct Glance {
  std::int64_t index = 0;
  int shrink = 0;   // of `reduced`; 0 where the frame could not be read
  cv::Mat reduced;  // what is kept of the frame, for the scene
  std::vector<FoundBall> found;
};

std::vector<FoundBall> balls_in(const Frame& frame, const CircleOptions& options,
                                const StillScene* scene) {
  std::vector<FoundBall> balls = find_balls(frame, options, scene, true);
  for (FoundBall& ball : balls) {
    // A clean rim's proof is a measurement.
    if (ball.rim_fraction > kJudge.clean_rim && ball.residual_px < kJudge.clean_px) continue;
    CirclePrior prior;
    prior.predicted = ball.circle;
    prior.centre_sd_px = kScout.found_sd_px;
    prior.learn = false;  // roughly will do
    const CircleFit fit = measure_circle(frame, prior, options);
    ball.circle = fit.circle;
    ball.rim_fraction = fit.status == CircleStatus::kOk ? fit.rim_fraction : 0;
    ball.score = ball.rim_fraction * fit.circle.r_px;
  }
  std::erase_if(balls, [](const FoundBall& b) { return b.rim_fraction < kScout.well_seen; });
  return balls;
}

bool same_radius(const FoundBall& a, const FoundBall& b) {
  return std::abs(a.circle.r_px - b.circle.r_px) < kScout.same_radius * b.circle.r_px;
}

// Those that agree with the sighting that most rim speaks for: a blob inside the ball is round too,
// but small. They are taken out of `glances`.
std::vector<Sighting> take_agreed(std::vector<Glance>& glances) {
  std::optional<FoundBall> centre;
  double best_score = 0;
  for (const Glance& one : glances) {
    for (const FoundBall& ball : one.found) {
      double score = 0;
      for (const Glance& other : glances) {
        for (const FoundBall& b : other.found) score += same_radius(b, ball) ? b.score : 0;
      }
      if (score > best_score) {
        best_score = score;
        centre = ball;
      }
    }
  }
  std::vector<Sighting> agreed;
  if (!centre) return agreed;
  for (Glance& glance : glances) {
    for (const FoundBall& ball : glance.found) {
      if (same_radius(ball, *centre)) agreed.push_back({glance.index, ball});
    }
    std::erase_if(glance.found, [&](const FoundBall& ball) { return same_radius(ball, *centre); });
  }
  return agreed;
}

double distance(const FoundBall& a, const FoundBall& b) {
  return std::hypot(a.circle.cx_px - b.circle.cx_px, a.circle.cy_px - b.circle.cy_px);
}

BallCandidate describe(std::vector<Sighting> sightings) {
  BallCandidate ball;
  std::vector<double> radii_px;
  for (const Sighting& one : sightings) {
    radii_px.push_back(one.ball.circle.r_px);
    ball.score += one.ball.score;
    ball.rim_fraction += one.ball.rim_fraction / static_cast<double>(sightings.size());
    for (const Sighting& other : sightings) {
      ball.moved_px = std::max(ball.moved_px, distance(one.ball, other.ball));
    }
  }
  ball.radius_px = upper_median(std::move(radii_px));
  ball.sightings = std::move(sightings);
  return ball;
}

// Balls of one size: as many as one frame shows at once. Each frame's go to the nearest of those
// before.
std::vector<BallCandidate> tell_apart(const std::vector<Sighting>& sightings) {
  std::vector<std::vector<Sighting>> balls;
  for (std::size_t begin = 0, end = 0; begin < sightings.size(); begin = end) {
    while (end < sightings.size() && sightings[end].index == sightings[begin].index) ++end;
    std::vector<bool> taken(balls.size(), false);
    for (std::size_t k = begin; k < end; ++k) {
      std::size_t nearest = balls.size();
      for (std::size_t b = 0; b < taken.size(); ++b) {
        const auto off = [&](std::size_t i) {
          return distance(balls[i].back().ball, sightings[k].ball);
        };
        if (!taken[b] && (nearest == balls.size() || off(b) < off(nearest))) nearest = b;
      }
      if (nearest == balls.size()) {
        balls.emplace_back();
      } else {
        taken[nearest] = true;
      }
      balls[nearest].push_back(sightings[k]);
    }
  }
  std::vector<BallCandidate> described;
  for (std::vector<Sighting>& ball : balls) described.push_back(describe(std::move(ball)));
  return described;
}

std::vector<BallCandidate> rank(std::vector<Glance> glances) {
  std::vector<BallCandidate> balls;
  for (;;) {
    const std::vector<Sighting> agreed = take_agreed(glances);
    if (agreed.empty()) break;
    for (BallCandidate& ball : tell_apart(agreed)) balls.push_back(std::move(ball));
  }
  std::stable_sort(balls.begin(), balls.end(), [](const BallCandidate& a, const BallCandidate& b) {
    return a.score > b.score;
  });
  return balls;
}

// The scouting of one clip, in rounds of more and more frames.
class Scouting {
 public:
  Scouting(FrameSource& source, const FrameRange& range, const Roi& roi,
           const CircleOptions& options)
      : source_(source), range_(range), roi_(roi), options_(options) {}

  // Of `n` frames spread evenly over the range, those not yet looked at.
  void look_at(std::int64_t n) {
    const std::size_t before = glances_.size();
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int64_t index = (2 * k + 1) * range_.count() / (2 * n);
      const bool known = std::any_of(glances_.begin(), glances_.end(),
                                     [&](const Glance& glance) { return glance.index == index; });
      if (!known) glances_.emplace_back().index = index;
    }
    std::vector<Frame> frames(glances_.size() - before);
    parallel_for(frames.size(), [&](std::size_t k) { read(glances_[before + k], frames[k]); });
    learn_scene();
    parallel_for(frames.size(), [&](std::size_t k) {
      Glance& glance = glances_[before + k];
      if (glance.shrink > 0) glance.found = balls_in(frames[k], options_, learnt_.scene.get());
    });
    keep(std::move(frames), before);
  }

  // What lies behind the balls that `scouted` believes in, from the frames kept.
  ScoutedBackdrop backdrop(const Scouted& scouted) const {
    if (!learnt_.scene || scouted.believed().empty()) return {};
    return scout_backdrop(showing(scouted), scouted.believed().front()->radius_px, options_);
  }

  // The same if nothing does: which of the balls are plain as they are.
  ScoutedBackdrop without_backdrop(const Scouted& scouted) const {
    return scout_without_backdrop(showing(scouted), options_);
  }

  // The same where too few frames show one, from what moved.
  ScoutedBackdrop moved_backdrop() const {
    if (!learnt_.scene) return {};
    std::vector<Backdrop::View> views;
    for (const Kept& kept : kept_) {
      Backdrop::View& view = views.emplace_back();
      view.frame = &kept.frame;
      const auto disc = learnt_.scene->moved_disc(learnt_.scene->moved(kept.frame));
      if (disc) view.balls.push_back({*disc});
    }
    ScoutedBackdrop moved = scout_moved_backdrop(std::move(views), options_);
    const auto plain = std::count_if(moved.plain.begin(), moved.plain.end(),
                                     [](const auto& ball) { return ball.has_value(); });
    return plain < kBackdrop.plain_views ? ScoutedBackdrop() : moved;
  }

  // Adds the balls that are plain before a background to what was found.
  void take(const ScoutedBackdrop& seen) {
    for (std::size_t k = 0; k < seen.plain.size(); ++k) {
      for (Glance& glance : glances_) {
        if (seen.plain[k] && glance.index == kept_[k].index) glance.found = {*seen.plain[k]};
      }
    }
  }

  // Whether the candidate is a mark on what moves: nearly wherever it is seen, it lies within a
  // disc that moved and is much larger.
  bool is_mark(const BallCandidate& ball) const {
    if (!learnt_.scene) return false;
    int discs = 0, within = 0;
    for (const Sighting& one : ball.sightings) {
      const auto glance = std::ranges::find(glances_, one.index, &Glance::index);
      const auto disc = learnt_.scene->moved_disc(learnt_.scene->compare(glance->reduced));
      if (!disc) continue;
      ++discs;
      const Circle& mark = one.ball.circle;
      within += mark.r_px < kBackdrop.mark_of_r * disc->r_px &&
                std::hypot(mark.cx_px - disc->cx_px, mark.cy_px - disc->cy_px) < disc->r_px;
    }
    return discs >= kBackdrop.plain_views && within > kBackdrop.mostly * discs;
  }

  Scouted result() const {
    std::vector<Glance> glances = glances_;
    std::sort(glances.begin(), glances.end(),
              [](const Glance& a, const Glance& b) { return a.index < b.index; });
    bool any_rests = false;
    for (Glance& glance : glances) {
      if (glance.found.empty() || !learnt_.scene) continue;
      // What moves is known better than when it was searched.
      const cv::Mat moved = learnt_.scene->compare(glance.reduced);
      std::erase_if(glance.found, [&](const FoundBall& ball) {
        return learnt_.scene->is_still(moved, ball.circle, ball.rim_fraction);
      });
      any_rests |= std::any_of(
          glance.found.begin(), glance.found.end(),
          [&](const FoundBall& ball) { return learnt_.scene->rests(moved, ball.circle); });
    }
    Scouted scouted;
    scouted.frames = static_cast<int>(glances.size());
    // A scene in which the ball itself rests, as it moves too little, tells nothing of it.
    if (!any_rests) scouted.scene = learnt_.scene;
    scouted.still = learnt_.nothing_moves;
    scouted.balls = rank(std::move(glances));
    scouted.put_mover_first();
    return scouted;
  }

 private:
  // The frames kept, with the balls that `scouted` believes in.
  std::vector<Backdrop::View> showing(const Scouted& scouted) const {
    std::vector<Backdrop::View> views;
    for (const Kept& kept : kept_) {
      Backdrop::View& view = views.emplace_back();
      view.frame = &kept.frame;
      for (const BallCandidate* ball : scouted.believed()) {
        for (const Sighting& one : ball->sightings) {
          if (one.index == kept.index) view.balls.push_back({one.ball.circle});
        }
      }
    }
    return views;
  }

  void read(Glance& glance, Frame& frame) const {
    Frame whole;
    try {
      source_.read(range_.at(glance.index), whole);
    } catch (const Error&) {
      return;  // the run itself will say so, when it has measured the frames before
    }
    crop(whole, roi_, frame);
    glance.shrink = StillScene::shrink_of(frame);
    glance.reduced = StillScene::reduced(frame);
  }

  // Frames in which the background will be looked at.
  void keep(std::vector<Frame> frames, std::size_t before) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const std::size_t bytes = frames[k].byte_count();
      if (kept_.size() == kBackdrop.most_views || kept_bytes_ + bytes > kBackdrop.most_bytes) break;
      if (glances_[before + k].shrink == 0) continue;
      kept_bytes_ += bytes;
      kept_.push_back({glances_[before + k].index, std::move(frames[k])});
    }
  }

  void learn_scene() {
    std::vector<const Glance*> seen;
    for (const Glance& glance : glances_) {
      if (glance.shrink > 0) seen.push_back(&glance);
    }
    std::sort(seen.begin(), seen.end(),
              [](const Glance* a, const Glance* b) { return a->index < b->index; });
    std::vector<cv::Mat> pictures;
    const std::size_t some = std::min(seen.size(), kStill.most_frames);
    for (std::size_t k = 0; k < some; ++k) {
      pictures.push_back(seen[k * (seen.size() - 1) / std::max<std::size_t>(some - 1, 1)]->reduced);
    }
    if (!seen.empty()) learnt_ = StillScene::learn(pictures, seen.front()->shrink);
  }

  FrameSource& source_;
  const FrameRange& range_;
  const Roi& roi_;
  const CircleOptions& options_;
  std::vector<Glance> glances_;
  StillScene::Learnt learnt_;
  struct Kept {
    std::int64_t index = 0;  // as Glance
    Frame frame;
  };
  std::vector<Kept> kept_;
  std::size_t kept_bytes_ = 0;
};

// Whether it is believed and seen in frames enough to learn what lies behind it.
bool seen_often(const Scouted& scouted) {
  const std::vector<const BallCandidate*> believed = scouted.believed();
  return !believed.empty() && believed.front()->sightings.size() >= kBackdrop.least_views;
}

// Whether there is no need to look for another ball in what moved.
bool is_plain(const Scouted& scouted, const Scouting& scouting) {
  if (!seen_often(scouted)) return false;
  const BallCandidate& best = *scouted.believed().front();
  return best.rim_fraction >= kBackdrop.seen_rim && !scouting.is_mark(best);
}

// What lies behind the ball: as it was seen, or as what moved shows it, whichever shows more.
void learn_backdrop(const ScoutedBackdrop& moved, Scouting& scouting, Scouted& scouted) {
  ScoutedBackdrop seen;
  const bool is_ball = seen_often(scouted) && !scouting.is_mark(*scouted.believed().front());
  if (is_ball) seen = scouting.backdrop(scouted);
  // What moved may have shown a texture that is the ball's own: a slow ball hides what is behind
  // it.
  if (is_ball && !seen.backdrop && moved.backdrop) seen = scouting.without_backdrop(scouted);
  if (moved.shown() > seen.shown()) {
    scouting.take(moved);
    scouted = scouting.result();
    scouted.backdrop = moved.backdrop;
  } else {
    scouted.backdrop = seen.backdrop;
  }
}

}  // namespace

Scouted scout_ball(FrameSource& source, const FrameRange& range, const Roi& roi,
                   const CircleOptions& options) {
  Scouting scouting(source, range, roi, options);
  Scouted scouted;
  ScoutedBackdrop moved;
  for (std::int64_t wanted = kScout.first_frames; wanted <= kScout.most_frames; wanted *= 2) {
    const std::int64_t n = std::min(wanted, range.count());
    scouting.look_at(n);
    scouted = scouting.result();
    if (!is_plain(scouted, scouting)) moved = scouting.moved_backdrop();
    const bool agree = !scouted.balls.empty() &&
                       static_cast<int>(scouted.balls.front().sightings.size()) >= kScout.agree;
    if (moved.backdrop || agree || n == range.count()) break;
  }
  learn_backdrop(moved, scouting, scouted);
  return scouted;
}

}  // namespace impactdic::circle
