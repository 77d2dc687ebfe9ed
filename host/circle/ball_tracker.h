// The ball over the frames of a clip: predicts, measures, finds again after a loss.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/sphere/rim_bias.h"

namespace impactdic::circle {

struct BallTrackerOptions {
  CircleOptions circle;
  std::optional<double> compression_axis_rad;  // normal of the surface that is hit, image axes
  std::optional<double> scouted_radius_px;     // roughly: another circle is not this ball
  std::shared_ptr<const StillScene> scene;     // what stands still is not this ball either
  std::shared_ptr<const Backdrop> backdrop;    // what lies behind it; nullptr: it is even
  // Frames corrected by hand, in order: by their numbers here, px of the pictures given.
  std::vector<BallByHand> by_hand;
  std::shared_ptr<const BallChoice> choice;  // nor are the balls that were not chosen
  // Of the outline, by a sphere's turns: what that says of the circles is noted (RimBias), and no
  // circle changed.
  std::optional<Measured> radius_by_turns;
  void validate() const;
};

// Follows one ball through frames in order (of time; a step back or a gap is allowed). Predicts
// with constant velocity from the last two measured frames, or from three as a ball falls in slow
// film, measures (measure_circle), and looks in the whole picture (find_ball) in the first frame
// and after a loss. Learns the free ball's radius as the median of what it measured while the ball
// was round, and its polarity. Where a frame is corrected by hand it measures from the circle given
// and goes on from there; frames in which it had followed something else are forgotten.
//
// Not for use from several threads; `follow` spreads the frames over threads itself.
class BallTracker {
 public:
  explicit BallTracker(BallTrackerOptions options = {});

  struct Seen {
    std::int64_t index;
    CircleFit fit;
  };
  // All that it knows of the frames before.
  struct Memory {
    std::deque<Seen> seen;        // the last measured frames, newest last
    std::deque<double> radii_px;  // of the last frames in which the ball was round and whole
    // Of the same frames, each by itself, and its deviation.
    std::deque<double> own_radii_px, own_radii_sd_px;
    std::int64_t next_learning = 0;   // frame from which on the rim model is learnt
    std::optional<RimBias> rim_bias;  // by the first radii that were learnt
  };
  const Memory& memory() const { return memory_; }
  // Goes on as the tracker would whose memory this was.
  void restore(Memory memory) { memory_ = std::move(memory); }

  // Measures the ball in `frame`, which is frame number `index` of the clip. A frame without a
  // ball says so in its status; the tracker goes on.
  CircleFit track(const Frame& frame, std::int64_t index);

  // Frames that lie between two measured ones, on the line that the ball takes: left by `lead`,
  // measured by `complete`.
  struct Plan;

  // Measures the ball in consecutive frames from number `first_index` on. Where it moves steadily a
  // frame some way ahead is measured, and where it lies as predicted the frames up to it are left
  // to `complete`. `fits` gets one fit for every other frame, the last one among them. `repeats`
  // (may be empty): whether a frame is the picture before it once more. Such a one has the fit of
  // that, and tells nothing of where the ball goes.
  Plan lead(std::span<const Frame> frames, std::int64_t first_index, std::span<CircleFit> fits,
            const std::vector<bool>& repeats = {});
  // What is expected of the frames that `lead` left, in the order of the plan.
  std::vector<CirclePrior> expected(const Plan& plan) const;
  // Whether a device may follow some of them (RimFollower), which see the pictures as they are.
  bool any_to_follow(const Plan& plan) const;
  // Measures the frames that `lead` left, in parallel; safe beside anything, on several batches at
  // once. The fits are the same on any number of threads. `followed` (may be empty): one for each
  // of them, where a device has followed it.
  void complete(const Plan& plan, std::span<const Frame> frames, std::span<CircleFit> fits,
                std::span<const std::optional<CircleFit>> followed = {}) const;
  // Both.
  void follow(std::span<const Frame> frames, std::int64_t first_index, std::span<CircleFit> fits);

  // What is expected of frame `index`; nullopt where nothing is known.
  std::optional<CirclePrior> predict(std::int64_t index) const;

  // The free ball's radius so far, and the scatter of that.
  std::optional<double> radius_px() const;
  double radius_sd_px() const;
  double radius_bias_sd_px() const;

 private:
  // The free ball's radius; nothing before it is learnt. `rough_px` tells the ball from others.
  struct Radius {
    std::optional<double> px;
    double sd_px = 0, bias_sd_px = 0;
    std::optional<double> rough_px;
  };
  Radius radius() const;
  CirclePrior prior_ahead(std::int64_t index) const;
  // By how much farther than on a line the ball comes, px, and whether the frames before tell that.
  struct Bend {
    double x_px = 0, y_px = 0;
    double sd_px = 0;  // by what the frames err, of the place
    bool is_told = false;
  };
  Bend bend_ahead(double ahead) const;
  std::pair<double, double> fall() const;
  // Of frame number `index`, which no memory of others has a part in. `was_lost`: the ball was not
  // seen just before it. `followed`: its circle from the prior, where a device has told it.
  struct Place {
    std::int64_t index = 0;
    std::optional<CirclePrior> prior;
    bool was_lost = false;
    const CircleFit* followed = nullptr;
  };
  // Measures a frame, from the prior or by searching all of it.
  CircleFit locate(const Frame& frame, const Place& place, const Radius& radius,
                   bool* searched = nullptr) const;
  CircleFit search(const Frame& frame, std::int64_t index, const Radius& radius) const;
  // Of a circle that the search has found.
  CirclePrior prior_found(const Circle& found, const Radius& radius) const;
  CircleFit measure(const Frame& frame, const CirclePrior& prior) const;
  // The correction of frame `index`; nullptr where there is none.
  const BallByHand* correction(std::int64_t index) const;
  CircleFit measure_by_hand(const Frame& frame, const BallByHand& given);
  void forget_others(const BallByHand& given);
  // The steps of `lead`, for the run of frames [begin, end).
  void lead_run(std::span<const Frame> frames, std::size_t begin, std::size_t end,
                std::span<CircleFit> fits, Plan& plan);
  bool measure_ahead(std::span<const Frame> frames, std::size_t begin, std::size_t end,
                     std::span<CircleFit> fits, Plan& plan);
  void search_run(std::span<const Frame> frames, std::int64_t first_index, std::size_t begin,
                  std::size_t end, std::span<CircleFit> fits);

  // Measures the first frames again, and those before them that were lost, by what the frames after
  // them tell; `found`: the first in which the ball was seen.
  void look_back(std::span<const Frame> frames, std::int64_t first_index, std::size_t begin,
                 std::size_t found, std::size_t end, std::span<CircleFit> fits) const;

  CircleFit with_last_model(CircleFit fit) const;
  void remember(const CircleFit& fit, std::int64_t index);
  void learn_radius(const CircleFit& fit);
  void learn_bias();

  BallTrackerOptions options_;
  Memory memory_;
};

struct BallTracker::Plan {
  struct Left {
    std::size_t frame;                    // of the batch
    Seen from, to;                        // the measured frames before and behind
    double centre_sd_px;                  // from the way between them
    double bend_x_px = 0, bend_y_px = 0;  // of that: four times its arrow; 0 of a line
  };
  std::int64_t first_index = 0;
  Radius radius;
  std::vector<Left> left;
};

}  // namespace impactdic::circle
