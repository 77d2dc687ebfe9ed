// What the ball of a run is, and which of its pictures' pixels show it.
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/advice/along_path.h"
#include "host/advice/clip_advice.h"
#include "host/advice/round_advice.h"
#include "host/report/words.h"
#include "host/run/metres/sphere_sight.h"
#include "host/run/session.h"
#include "host/run/track/track_run.h"

namespace impactdic::run {
namespace {

// A ball whose dark half does not show before a dark background has another silhouette than its
// rim: the rim is a circle of one size in all pictures, as that of no other body.
bool shows_one_circle(const std::vector<advice::BallPair>& pairs) {
  constexpr double kAlike = 0.01;  // fruits: 4 % and more from frame to frame
  if (pairs.size() < 2) return false;
  double least = pairs.front().first_ball.r_px, most = least;
  for (const advice::BallPair& pair : pairs) {
    if (pair.first_ball.oval > 0 || pair.second_ball.oval > 0) return false;
    least = std::min({least, pair.first_ball.r_px, pair.second_ball.r_px});
    most = std::max({most, pair.first_ball.r_px, pair.second_ball.r_px});
  }
  return most < (1 + kAlike) * least;
}

}  // namespace

void TrackRun::choose_body(const std::vector<advice::BallPair>& pairs,
                           const advice::AdviceRequest& looked) {
  advice::BodyAdvice judged = judge_body(pairs, looked);
  leave_out_still_edges(judged.moved, looked);
  // Such edges look like a turn, or hide one.
  if (options_.estimator.moving && looks_at_body()) judged = judge_body(pairs, looked);
  const bool is_asked = request_.body != Body::kAuto;
  result_.body = is_asked ? request_.body : judged.body;
  result_.body_reason = is_asked ? "as was asked for" : judged.reason;
  if (looks_at_body() && !judged.is_measured && !shows_one_circle(pairs)) look_for_round_body();
  take_up(judged);
  if (options_.with_field) {
    caller_.say(MessageKind::kNote,
                std::string("body: ") + to_string(result_.body) + ", " + result_.body_reason);
  }
  if (result_.sphere_radius_px.value > 0) {
    caller_.say(MessageKind::kNote, sphere_in_words(result_.sphere_radius_px, perspective_));
  }
}

advice::BodyAdvice TrackRun::judge_body(const std::vector<advice::BallPair>& pairs,
                                        const advice::AdviceRequest& looked) {
  advice::BodyAdvice judged;
  judged.is_measured = false;
  judged.reason = "no pair of frames is registered that could tell (--estimator ball)";
  if (pairs.empty()) return judged;
  opencl::Engine& engine = *session_.impl().open_engines().front();
  if (!looks_at_body()) {
    judged.moved = advice::discs_moved(engine, pairs, options_.estimator);
    return judged;
  }
  // Also of a ball that is said to be a sphere: its radius.
  see_from_near(pairs.front().first_ball.r_px);
  return advice::judge_body(engine, pairs, options_.estimator,
                            advice::far_frames(*source_, looked));
}

void TrackRun::take_up(const advice::BodyAdvice& judged) {
  motion::EstimatorOptions& estimator = options_.estimator;
  if (request_.body == Body::kAuto) {
    const bool is_known = std::isfinite(judged.unseen_tilt_rad);
    if (is_known) estimator.unseen_tilt_rad = judged.unseen_tilt_rad;
    options_.tilt_is_unknown = estimator.estimator == Estimator::kBall && !is_known;
  }
  if (judged.radius_px > 0) {
    estimator.sphere_radius_px = judged.radius_px;
    estimator.sphere_radius_sd_px = judged.radius_sd_px;
    estimator.sphere_blur_px2 = judged.blur_px2;
    estimator.sphere_light = judged.light;
  }
  perspective_ = estimator.perspective = {};
  estimator.sphere = result_.body == Body::kSphere;
  if (!estimator.sphere) return;
  options_.ball.circle.sphere = true;  // a disc is only not refuted
  const double radius_px = estimator.sphere_radius_px;
  see_from_near(radius_px > 0 ? radius_px : options_.ball.scouted_radius_px.value_or(0),
                judged.nearness);
  if (!(radius_px > 0)) return;
  result_.sphere_radius_px = {radius_px, estimator.sphere_radius_sd_px};
  if (std::isfinite(judged.radius_by_turns_px.value)) {
    options_.ball.radius_by_turns = outline_radius(judged.radius_by_turns_px, perspective_);
  }
  state_nearness(camera_, perspective_, judged.nearness, result_);
}

void TrackRun::look_for_round_body() {
  round_body_ = advice::find_round_body(*session_.impl().open_engines().front(), *source_,
                                        options_.frames, options_.roi);
  if (!round_body_) return;
  result_.body = Body::kSpheroid;
  result_.body_reason = advice::round_body_in_words(*round_body_);
}

void TrackRun::see_from_near(double radius_px, const Measured& shown) {
  perspective_ = perspective_of(request_, camera_, info(), radius_px);
  if (perspective_.is_unknown()) perspective_ = as_pictures_show(perspective_, shown, radius_px);
  options_.estimator.perspective = in_region(perspective_, options_.roi);
}

void TrackRun::leave_out_still_edges(const std::vector<advice::MovedBall>& moved,
                                     const advice::AdviceRequest& looked) {
  if (!result_.advice.texture) return;
  const advice::FarFrames frames = advice::far_frames(*source_, looked);
  const advice::StillEdges edges =
      advice::still_edges(advice::along_path(moved, looked.spare_sightings, frames),
                          result_.advice.texture->noise, frames);
  options_.estimator.moving = edges.moving;
  edges_cover_ball_ = edges.cover_ball;
  if (!edges.moving || edges.cover_ball) return;  // a warning says the latter
  caller_.say(MessageKind::kNote,
              "something stands still before the ball, or shines on it: its edges are left out of "
              "the ball's registration");
}

}  // namespace impactdic::run
