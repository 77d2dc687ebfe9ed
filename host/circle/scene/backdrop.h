// What lies behind the ball before a camera that stands still. Internal to host/circle.
#pragma once

#include <impactdic/circle.h>
#include <impactdic/image.h>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace impactdic::circle {

// The texture of the background, as frames show it in which the ball lies elsewhere: wood, tiles,
// the edge of a table. A frame whose background is evened shows the rim as before an even wall.
class Backdrop {
 public:
  // A ball's rim, as in CircleFit.
  struct Outline {
    Circle circle;
    double e1_px = 0, e2_px = 0;
    // How far a point lies outside it, px; negative within.
    double distance_to(double x, double y) const;
  };
  // A frame and all balls in it. Pictures of one size.
  struct View {
    const Frame* frame = nullptr;
    std::vector<Outline> balls;
  };
  // How the views' balls are known: discs that hold them and more, circles to a pixel, or to a part
  // of one.
  enum class Known { kWithin, kRoughly, kWell };
  // nullptr where nothing is gained (an even background), or nothing can be said: too few views, a
  // background that moves, or something that stands still hides a part of the ball (of discs that
  // hold it that is not asked).
  static std::shared_ptr<const Backdrop> learn(std::span<const View> views, Known known);

  // The frame without the texture. It is taken away from the rim of `ball`, too, and a little
  // inside it, so that no edge arises where the rim is not; the rest of the ball stays as it is,
  // and so does the texture's mean about the rim: where no ball is no disc may arise.
  void even(const Frame& frame, const Outline& ball, Frame& out) const;
  // The frame without the texture anywhere, within balls too.
  void even(const Frame& frame, Frame& out) const;
  // The share of a rim, 0 … 1, beside which no view has shown the background: there it is guessed
  // from what lies farther out.
  double guessed_share(const Outline& ball) const;

 private:
  Backdrop(Image<float> texture, Image<std::uint8_t> guessed)
      : texture_(std::move(texture)), guessed_(std::move(guessed)) {}
  void even(const Frame& frame, const Outline& ball, float usual, Frame& out) const;
  double texture_about(const Outline& ball) const;  // mean about its rim
  Image<float> texture_;                            // grey levels of the file, about their median
  Image<std::uint8_t> guessed_;                     // 1 where no view has shown it
};

}  // namespace impactdic::circle
