// Which of the balls that a clip shows a run measures.
#include <impactdic/error.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "host/advice/clip_advice.h"
#include "host/advice/sensor_lines.h"
#include "host/circle/scout_ball.h"
#include "host/clip/ball_by_hand.h"
#include "host/run/session.h"
#include "host/run/track/track_run.h"
#include "host/video/levels/even_lines.h"

namespace impactdic::run {

void TrackRun::choose_ball(const circle::Scouted& found, bool known,
                           advice::AdviceRequest& request) {
  const std::vector<const circle::BallCandidate*> balls = found.believed();
  if (request_.ball > static_cast<int>(balls.size())) {
    throw InvalidArgument("only " + std::to_string(balls.size()) +
                              (balls.size() == 1 ? " ball is seen" : " balls are seen"),
                          "--ball " + std::to_string(request_.ball),
                          "impactdic info --candidates lists them");
  }
  const circle::BallCandidate& ball = *balls[static_cast<std::size_t>(request_.ball) - 1];
  options_.ball.scouted_radius_px = request.radius_px = ball.radius_px;
  options_.ball.choice = request.choice = found.choose(ball);
  if (known) request.sightings = ball.sightings;
  request.spare_sightings = ball.sightings;
}

void TrackRun::scout(advice::AdviceRequest& request) {
  const bool known = scouted_.has_value();
  if (!known) {
    scouted_ = circle::scout_ball(*source_, options_.frames, options_.roi, options_.ball.circle);
  }
  const circle::Scouted& found = *scouted_;
  second_ball_warning_.clear();
  options_.scouted = true;
  options_.ball.scouted_radius_px = request.radius_px =
      radius_by_hand(found.radius_px(), request_.ball_at);
  options_.ball.scene = request.scene = found.scene;
  options_.ball.backdrop = request.backdrop = found.backdrop;
  if (request_.ball > 0) return choose_ball(found, known, request);
  if (!found.balls.empty()) {
    if (known) request.sightings = found.balls.front().sightings;
    request.spare_sightings = found.balls.front().sightings;
  }
  if (found.rests_beside_the_best()) {  // it is told by its place, whatever the scene says of it
    options_.ball.choice = request.choice = found.choose(found.balls.front());
  }
  if (const circle::BallCandidate* other = found.second_ball()) {
    const circle::BallCandidate::Sighting& seen = other->sightings.front();
    char text[240];
    std::snprintf(
        text, sizeof text,
        "a second ball is seen, of radius %.1f px, at %.0f, %.0f in frame %lld; the one of "
        "radius %.1f px is measured: --ball N chooses, info --candidates counts them",
        other->radius_px, seen.ball.circle.cx_px + options_.roi.x,
        seen.ball.circle.cy_px + options_.roi.y,
        static_cast<long long>(options_.frames.at(seen.index)), *found.radius_px());
    second_ball_warning_ = text;
  }
}

std::string TrackRun::even_out_sensor(advice::AdviceRequest& request) {
  if (!evens_out_sensor_ || scouted_->balls.empty()) return {};
  const circle::BallCandidate& ball =
      request_.ball > 0 ? *scouted_->believed()[static_cast<std::size_t>(request_.ball) - 1]
                        : scouted_->balls.front();
  const auto lines = advice::sensor_lines(*source_, options_.frames, options_.roi, ball);
  if (!lines) return {};
  source_ = video::even_lines(source_, lines->pattern);
  as_filmed_ = std::exchange(scouted_, std::nullopt);
  scout(request);
  char text[200];
  const bool both = lines->columns_rms > 0 && lines->rows_rms > 0;
  std::snprintf(text, sizeof text,
                "the sensor's %s%s%s differ by %.1f grey levels of 255 (rms): that is taken off as "
                "far as the ball shows it; let the camera correct its black level and gains",
                lines->columns_rms > 0 ? "columns" : "", both ? " and " : "",
                lines->rows_rms > 0 ? "rows" : "", std::max(lines->columns_rms, lines->rows_rms));
  return text;
}

}  // namespace impactdic::run
