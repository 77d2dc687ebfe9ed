// The shape of a flat ball in a picture, and what it does to the turn that two pictures show.
#pragma once

#include "host/circle/circle.h"
#include "host/dic/rigid_fit.h"
#include "kernels/types.h"

namespace impactdic::motion {

// The stretch that makes an ellipse of a round ball, but for its size: [1 + e1, e2; e2, 1 − e1] in
// image axes. Figures of CircleFit over the radius; 0 of a circle, which may be an ellipse that
// does not show. size_sd: of the outline's radius.
struct BallShape {
  double e1 = 0, e2 = 0, sd = 0;
  double size_sd = 0;

  bool is_circle() const { return e1 == 0 && e2 == 0; }
  // Plainly no circle: in contact. A ball that is 2 % shorter along one axis.
  bool is_compressed() const;
};
BallShape shape_of(const circle::CircleFit& fit);

// How the ball's picture is stretched from frame to frame, in the first frame's axes and before it
// turns: [1 + xx, xy; xy, 1 + yy].
struct Stretch {
  double xx = 0, xy = 0, yy = 0;
};

// What that and a turn make of a point beside the ball's centre, in image axes: [xx, xy; yx, yy].
struct Gradient {
  double xx = 1, xy = 0, yx = 0, yy = 1;
};
Gradient gradient_of(const Stretch& stretch, double rot_rad);
Gradient inverse(const Gradient& gradient);

// The shape in the first frame, as the second frame's outline and a registration from the one to
// the other have it. An outline may miss that a ball is compressed while its pictures do not.
BallShape shape_before(const BallShape& second, const BallMotion& strain);

// What turns from one shape to another is not the rotation that their pictures show. A ball with
// stretch V and turn R shows V R (polar decomposition), so between two frames V2 R V1⁻¹ is
// registered: its own rotation is not R, though V1 and V2 be equal. Of a flat ball that was
// registered with a uniform strain, from a frame with the shape `first`: turns `motion` by what is
// missing, and widens its deviation by what is not known of the shape and of the strain.
// Only V1 is needed: the registered gradient times V1 is V2 R.
void correct_turn(const BallShape& first, const BallMotion& strain, dic::RigidMotion& motion);

}  // namespace impactdic::motion
