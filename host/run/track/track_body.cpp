// What the ball of a run is, and which of its pictures' pixels show it.
#include <cmath>
#include <vector>

#include "host/advice/along_path.h"
#include "host/advice/body_advice.h"
#include "host/advice/clip_advice.h"
#include "host/advice/round_advice.h"
#include "host/report/words.h"
#include "host/run/metres/sphere_sight.h"
#include "host/run/session.h"
#include "host/run/track/track_run.h"

namespace impactdic::run {

std::vector<advice::MovedBall> TrackRun::choose_body(const std::vector<advice::BallPair>& pairs,
                                                     const advice::AdviceRequest& looked) {
  result_.body = request_.body;
  result_.body_reason = "as was asked for";
  if (request_.body == Body::kAuto) {
    result_.body = Body::kDisc;
    result_.body_reason = "no pair of frames is registered that could tell (--estimator ball)";
    options_.tilt_is_unknown = options_.estimator.estimator == Estimator::kBall;
  }
  bool is_measured = false;
  Measured shown, by_turns;  // the radius over the camera's distance; the radius
  std::vector<advice::MovedBall> moved;
  if (!looks_at_body() && !pairs.empty()) {
    moved = advice::discs_moved(*session_.impl().open_engines().front(), pairs,
                                options_.estimator.field);
  } else if (!pairs.empty()) {  // also of a ball that is said to be a sphere: its radius
    see_from_near(pairs.front().first_ball.r_px);
    const advice::BodyAdvice judged =
        advice::judge_body(*session_.impl().open_engines().front(), pairs, options_.estimator.field,
                           options_.estimator.perspective, advice::far_frames(*source_, looked));
    is_measured = judged.is_measured;
    if (request_.body == Body::kAuto) {
      result_.body = judged.body;
      result_.body_reason = judged.reason;
      if (std::isfinite(judged.unseen_tilt_rad)) {
        options_.estimator.unseen_tilt_rad = judged.unseen_tilt_rad;
        options_.tilt_is_unknown = false;
      }
    }
    if (judged.radius_px > 0) {
      options_.estimator.sphere_radius_px = judged.radius_px;
      options_.estimator.sphere_radius_sd_px = judged.radius_sd_px;
      options_.estimator.sphere_blur_px2 = judged.blur_px2;
      options_.estimator.sphere_light = judged.light;
      by_turns = judged.radius_by_turns_px;
    }
    shown = judged.nearness;
    moved = judged.moved;
  }
  if (looks_at_body() && !is_measured) look_for_round_body();
  options_.estimator.sphere = result_.body == Body::kSphere;
  if (options_.estimator.sphere) options_.ball.circle.sphere = true;  // a disc is only not refuted
  if (options_.with_field) {
    caller_.say(MessageKind::kNote,
                std::string("body: ") + to_string(result_.body) + ", " + result_.body_reason);
  }
  const double radius_px = options_.estimator.sphere_radius_px;
  perspective_ = options_.estimator.perspective = {};
  if (!options_.estimator.sphere) return moved;
  see_from_near(radius_px > 0 ? radius_px : options_.ball.scouted_radius_px.value_or(0), shown);
  if (!(radius_px > 0)) return moved;
  result_.sphere_radius_px = {radius_px, options_.estimator.sphere_radius_sd_px};
  if (std::isfinite(by_turns.value)) {
    options_.ball.radius_by_turns = outline_radius(by_turns, perspective_);
  }
  state_nearness(camera_, perspective_, shown, result_);
  caller_.say(MessageKind::kNote, sphere_in_words(result_.sphere_radius_px, perspective_));
  return moved;
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
  options_.estimator.moving =
      advice::still_edges(advice::along_path(moved, looked.spare_sightings, frames),
                          result_.advice.texture->noise, frames);
  if (!options_.estimator.moving) return;
  caller_.say(MessageKind::kNote,
              "something stands still before the ball, or shines on it: its edges are left out of "
              "the ball's registration");
}

}  // namespace impactdic::run
