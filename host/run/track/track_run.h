// One run of `track`, in its steps: what `track` and `track_to_folder` share.
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/track.h>

#include <functional>
#include <memory>
#include <vector>

#include "host/advice/body_advice.h"
#include "host/advice/clip_advice.h"
#include "host/base/stage_times.h"
#include "host/circle/scout_ball.h"
#include "host/clip/row_store.h"
#include "host/clip/steady_rows.h"
#include "host/motion/round/round_body.h"
#include "host/pipeline/track_clip.h"
#include "host/run/control.h"

namespace impactdic::run {

class TrackRun {
 public:
  // Checks the request, opens the clip and, where the field is measured, the devices. Everything
  // must outlive the run; `needs_rate`: what asks for a frame rate beside the scale, or "".
  TrackRun(const TrackRequest& request, Session& session, Caller& caller, TrackResult& result,
           const std::string& needs_rate = "");

  const ClipInfo& info() const { return source_->info(); }
  FrameSource& source() { return *source_; }
  const pipeline::TrackOptions& options() const { return options_; }

  // The ball as another run over the same frames, region and radii has scouted it, so that this one
  // need not. Figures then differ in their last digits from those of a run that was told nothing.
  void know(circle::Scouted scouted) { scouted_ = std::move(scouted); }
  const std::optional<circle::Scouted>& scouted() const {
    return as_filmed_ ? as_filmed_ : scouted_;
  }
  // Before `look`, where other frames will be measured than the source has: they come as they were
  // filmed, and those looked at are to have the same grey levels.
  void leave_grey_levels() { evens_out_sensor_ = false; }
  // In place of `look`, where circles alone are wanted at once: says nothing of texture and light.
  void look_for_ball();
  // Looks at the texture: the noise that windows are judged by, and the warnings.
  void look();

  // What gets the frames, beside the result.
  struct Outputs {
    pipeline::GridSink grid;                                       // may be empty
    pipeline::TrackSink frame;                                     // may be empty
    std::function<void(const pipeline::ResumePoint&)> checkpoint;  // may be empty
    std::optional<pipeline::ResumePoint> from;                     // with its rows already taken up
  };
  // From here on the rows go there, and not into the result. Before `take_up`.
  void keep_rows_in(RowStore& store) { store_ = &store; }
  // The rows of an earlier run, which this one goes on with.
  void take_up(std::vector<TrackRow> rows);
  // All rows so far.
  TrackRows rows() const {
    if (!changed_.empty()) return *changed_.back();
    return store_ != nullptr ? TrackRows(*store_) : TrackRows(result_.rows);
  }
  // Measures. What was measured before an error is in the result.
  void measure(const Outputs& outputs);
  // Scale and impact of the rows measured.
  void conclude();
  // The surface's inclination by its edge in the picture, deg; where one is seen at the impact.
  const std::optional<Measured>& surface_in_picture() const { return surface_in_picture_; }

 private:
  // Where the ball's centre may be, and the frames corrected by hand.
  void take_limits();
  // The ball that was asked for, and none of the others. `known`: another run has scouted it.
  void choose_ball(const circle::Scouted& found, bool known, advice::AdviceRequest& request);
  // Looks for the ball in frames spread over the clip.
  void scout(advice::AdviceRequest& request);
  // Takes off what the sensor's columns and rows add, and scouts again; what is said of it, or
  // nothing where they add nothing.
  std::string even_out_sensor(advice::AdviceRequest& request);
  // Looks for the surface's edge, and compares it with the angle that was given.
  void look_for_surface();
  // Sphere or disc, and what is known of it, by the pairs of frames that the look found.
  void choose_body(const std::vector<advice::BallPair>& pairs, const advice::AdviceRequest& looked);
  advice::BodyAdvice judge_body(const std::vector<advice::BallPair>& pairs,
                                const advice::AdviceRequest& looked);
  // What the look at the body tells the estimators and the circles.
  void take_up(const advice::BodyAdvice& judged);
  // Whether the background shows that the camera moved.
  std::string look_at_camera_motion();  // what is said of it, or nothing
  // Where the flights show that motions err by more than they state.
  void restate_motions(const TrackRows& even);
  bool registers_ball() const {
    return options_.with_field && options_.estimator.estimator == Estimator::kBall;
  }
  // Whether the pictures are to tell what turns, or more of it.
  bool looks_at_body() const { return registers_ball() && request_.body != Body::kDisc; }
  // Of a bar before the ball, or a glint on it: registrations do without.
  void leave_out_still_edges(const std::vector<advice::MovedBall>& moved,
                             const advice::AdviceRequest& looked);
  // Where no pair shows a ball's motion: whether what turns is no sphere.
  void look_for_round_body();

  void keep(const TrackRow& row);
  // Changes all rows so far.
  void change_rows(const RowChange& change);
  // Has periods and times count the frames that the film lacks; what is said of them, or nothing.
  std::string count_missing_frames();
  void count_rows();

  // Tells the estimators from where a sphere of this radius is seen, as far as that is known:
  // `shown` by its pictures, the radius over the distance.
  void see_from_near(double radius_px, const Measured& shown = {});

  const TrackRequest& request_;
  Session& session_;
  Caller& caller_;
  TrackResult& result_;
  RowStore* store_ = nullptr;
  // The rows there, as the whole track shows them: each those before it with one thing changed.
  std::vector<std::unique_ptr<RowSource>> changed_;
  std::optional<SteadyRows> steady_;  // where the camera moved
  std::shared_ptr<FrameSource> source_;
  pipeline::TrackOptions options_;
  std::vector<std::string> clock_warnings_;
  std::optional<circle::Scouted> scouted_;
  std::optional<circle::Scouted> as_filmed_;  // before the sensor's pattern was taken off
  std::string second_ball_warning_;           // "": none is seen
  std::optional<Camera> camera_;
  motion::Perspective perspective_;  // of a sphere, in the whole frames
  std::optional<Measured> surface_in_picture_;
  std::optional<motion::RoundBody> round_body_;  // of kSpheroid
  bool evens_out_sensor_ = true;
  bool edges_cover_ball_ = false;  // see advice::StillEdges
};

// Gives a frame to a caller's sink, which is not empty.
void hand_on(const pipeline::TrackedFrame& frame, int window_px, const TrackSink& sink);

}  // namespace impactdic::run
