// The motion of an impact frame by frame, for the video renderer.
#pragma once

#include <impactdic/impact_model.h>

#include <vector>

namespace impactdic::sim::contact {

// One frame of a filmed impact. World axes: x right, y up, z towards the camera, metres; the origin
// is where the centre of the ball is at the first touch.
struct FramePose {
  double time_s = 0;  // from the first touch
  double x_m = 0, y_m = 0, z_m = 0;
  double angle_rad = 0;    // counter-clockwise, 0 at frame 0
  Quaternion orientation;  // since frame 0, world axes; about z by angle_rad in plane motion
  double compression = 0;  // deflection / diameter along the surface's normal, 0 out of contact
};

// The pose at `frames` instants 1/fps apart. The first touch happens `touch_frame` frames (may be
// fractional) after frame 0; free flight under gravity before and after. Throws as simulate_impact.
std::vector<FramePose> simulate_motion(const ImpactJob& job, double fps, int frames,
                                       double touch_frame);

}  // namespace impactdic::sim::contact
