// A ball in the plane of motion as a camera shows it, and back: what the circle that is fitted to
// its outline, and the rigid motion that is fitted to its texture, say of the ball itself.
//
// Neither is a point: over a ball's extent a lens bends differently, and seen from near by, the
// outline of a sphere that is off the axis is an ellipse about another point than its centre. The
// fit to what the camera would show is therefore worked out and inverted, to all orders.
#pragma once

#include "host/camera/plane_view.h"

namespace impactdic::camera {

// World axes (plane_view.h), m and rad; angle counter-clockwise as seen from the camera.
struct BallInPlane {
  Eigen::Vector2d centre{0, 0};
  double radius = 0;
};
struct TurnInPlane {
  Eigen::Vector2d shift{0, 0};
  double angle = 0;
};

// Picture: px, y down; angle counter-clockwise on the screen.
struct CircleInPicture {
  Eigen::Vector2d centre{0, 0};
  double radius = 0;
};

class BallView {
 public:
  // `sphere`: the outline is where lines of sight touch a sphere; else a circle in the plane.
  // `rim_margin_px`: how far inside the outline the texture is registered.
  BallView(const PlaneView& plane, bool sphere, double rim_margin_px)
      : plane_(plane), sphere_(sphere), rim_margin_px_(rim_margin_px) {}

  // The circle of least squares through the outline's picture, all around.
  CircleInPicture circle(const BallInPlane& ball) const;
  // The ball whose outline has this circle; NaN where there is none.
  BallInPlane ball(const CircleInPicture& circle) const;

  // The rigid motion of least squares about the circle's centre, over what is registered of the
  // ball's picture, of points that shift and turn with the ball about its centre.
  TurnInPlane motion_in_picture(const BallInPlane& ball, const CircleInPicture& circle,
                                const TurnInPlane& motion) const;
  // The ball's motion that shows as `in_picture` does; its shift in px, y down.
  TurnInPlane motion(const BallInPlane& ball, const CircleInPicture& circle,
                     const TurnInPlane& in_picture) const;

 private:
  Eigen::Vector2d picture_of(const Eigen::Vector2d& at) const {
    return plane_.to_picture({at.x(), at.y(), 0});
  }
  const PlaneView& plane_;
  bool sphere_;
  double rim_margin_px_;
};

}  // namespace impactdic::camera
