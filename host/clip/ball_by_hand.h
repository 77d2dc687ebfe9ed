// Frames that a person has corrected: --ball-at FRAME:X,Y,R/FRAME:none/…
#pragma once

#include <impactdic/track.h>

#include <optional>
#include <string>
#include <vector>

namespace impactdic {

// The frames in order. Throws InvalidArgument.
std::vector<BallByHand> read_balls_by_hand(const std::string& text);
std::string to_text(const std::vector<BallByHand>& balls);
// Throws InvalidArgument for a frame below 0 or that stands twice, a radius that is none, and a
// place that is no number.
void check_balls_by_hand(const std::vector<BallByHand>& balls);
// Throws InvalidArgument for a frame that the clip lacks, or a centre that is not in the picture.
void check_balls_by_hand(const std::vector<BallByHand>& balls, const ClipInfo& clip);

// By their frames.
std::vector<BallByHand> in_order(std::vector<BallByHand> balls);

// Those of the frames that are analysed, in order: frames by their number among them, places in
// pictures that are cut to `roi`.
std::vector<BallByHand> as_analysed(const std::vector<BallByHand>& balls, const FrameRange& frames,
                                    const Roi& roi);
// Of the ball: what was found, unless the circles drawn are those of another one.
std::optional<double> radius_by_hand(std::optional<double> found_px,
                                     const std::vector<BallByHand>& balls);

// The first frame that both, in order, do not say the same of; nullopt where there is none.
std::optional<std::int64_t> first_difference(const std::vector<BallByHand>& one,
                                             const std::vector<BallByHand>& other);

}  // namespace impactdic
