// What stands still before a camera that stands still. A thing that never moves is not the ball.
// Internal to host/circle.
#pragma once

#include <impactdic/circle.h>
#include <impactdic/image.h>

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace impactdic::circle {

// The picture that most of some frames agree on, pixel by pixel, and where each of them differs
// from it. Pictures are reduced, so that their longer side has at most kStill.longer_side_px
// pixels.
class StillScene {
 public:
  struct Learnt {
    // nullptr where nothing can be said: too few frames, a camera that moves, or nothing that does.
    std::shared_ptr<const StillScene> scene;
    bool nothing_moves = false;
  };
  // Full pixels to one of a reduced picture.
  static int shrink_of(const Frame& frame);
  // A frame as `learn` takes it: reduced and smoothed, 32-bit floats.
  static cv::Mat reduced(const Frame& frame);
  // Frames of one size, spread over a clip, in order of time; all reduced.
  // `shrink`: shrink_of the frames.
  static Learnt learn(const std::vector<cv::Mat>& pictures, int shrink);

  // 255 where the frame differs from what stands still, in the reduced picture.
  cv::Mat moved(const Frame& frame) const { return compare(reduced(frame)); }
  cv::Mat compare(const cv::Mat& reduced) const;
  // Share of the disc in which a picture of `moved` differs; 0 where the disc lies outside.
  double moved_share(const cv::Mat& moved, const Circle& circle) const;
  // Whether the disc is the same in this frame and in nearly all of the frames learnt from: what
  // rests for a while does not count, what is covered for a while does.
  bool rests(const cv::Mat& moved, const Circle& circle) const;
  // The same, but for a disc that holds all that moves, a ball that turns or moves by a pixel, if
  // enough of its rim shows.
  bool is_still(const cv::Mat& moved, const Circle& circle, double rim_fraction) const;

  // The disc that moved, in pixels of the frame: the largest within the hull of the largest blob of
  // what differs. That blob is the ball in this frame, with gaps, and what of it the still picture
  // holds. nullopt where the disc fills too little of the hull, or the blob reaches the picture's
  // edge.
  std::optional<Circle> moved_disc(const cv::Mat& moved) const;

  // Full pixels to one of the reduced picture.
  int shrink() const { return shrink_; }

 private:
  struct DiscRow {
    int y, begin, end;  // pixels of the row that lie in the disc
  };
  StillScene() = default;
  bool holds_all_that_moves(const Circle& circle) const;
  std::vector<DiscRow> rows_of(const Circle& circle, cv::Size size) const;
  static double share_of(const cv::Mat& moved, const std::vector<DiscRow>& rows);

  int shrink_ = 1;
  cv::Mat median_, threshold_;      // grey levels of the file
  std::vector<cv::Mat> movements_;  // of the frames learnt from
  cv::Mat times_moved_;             // of each pixel, in those
};

}  // namespace impactdic::circle
