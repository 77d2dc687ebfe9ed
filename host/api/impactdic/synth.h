// Clips of a speckled ball with exactly known motion, rendered from formulas.
//
// Image axes: x right, y down, pixel centres at integers. Angles are positive counter-clockwise as
// seen on the screen. Camera axes, for a sphere: X right, Y up, Z towards the camera, right-handed,
// so that a rotation about Z is an angle on the screen.
#pragma once

#include <impactdic/control.h>
#include <impactdic/export.h>
#include <impactdic/image.h>
#include <impactdic/impact_model.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// What is painted and turned: a flat disc, or a sphere with ink on all of its surface.
enum class SynthBody { kDisc, kSphere };

struct BallPose {
  double cx_px = 0, cy_px = 0;       // the ball's centre in the picture
  double angle_deg = 0;              // turned from the pattern's own position
  double compression = 0;            // 0 ... 0.5: the ball is shorter by this share along the axis
  double compression_axis_deg = 90;  // direction of that axis on the screen
  // Of a sphere: (rx_deg, ry_deg, angle_deg) is the rotation vector, in camera axes, that turns the
  // pattern's own position into this pose; its length is the angle. A disc has 0 here.
  double rx_deg = 0, ry_deg = 0;
  // How much nearer than the scene's distance the centre is; the sphere's radius in the same px.
  double z_px = 0;
};

// Ball axes to camera axes; w >= 0.
Quaternion orientation(const BallPose& pose);
// The pose with that orientation; its rotation vector is at most 180 degrees long.
// Throws InvalidArgument for a quaternion that is zero or not finite; any other is normalised.
BallPose oriented(BallPose pose, const Quaternion& orientation);

// The same step from frame to frame.
struct ConstantMotion {
  BallPose start;
  double dx_px = 0, dy_px = 0;  // per frame
  double rotation_deg = 0;      // per frame
  double compression_per_frame = 0;
  // Of a sphere: with rotation_deg its spin vector in camera axes, degrees per frame.
  double spin_x_deg = 0, spin_y_deg = 0;
  // Towards the camera, per frame. With a distance, dx_px and dy_px count at that distance, and the
  // picture of the path is in perspective.
  double dz_px = 0;
};

// A pose for every frame.
struct GivenMotion {
  std::vector<BallPose> poses;
  bool placed = false;  // positions count as they are; otherwise they are relative to the first
};

// The ball follows an integrated impact, compressed along the surface's normal; the diameter of the
// picture's ball, twice radius_px, stands for that of the body.
struct SimulatedMotion {
  ImpactJob impact;         // of a ball
  double touch_frame = 25;  // the frame, fractions allowed, of the first touch
};

// A straight static bar in front of the ball, endless along its direction.
struct OccludingBar {
  double x_px = 0, y_px = 0;  // a point on its centre line
  double angle_deg = 0;       // direction, counter-clockwise from image-right
  double width_px = 0;
  double level = 90;
};

// Camera, light and surroundings. Grey levels and noise are of 255 at every bit depth.
struct SynthScene {
  int width = 512, height = 512;  // px
  double white = 200, ink = 40, background = 30;
  double psf_sigma_px = 0.6;  // the lens; 0.3 or more
  double noise_sigma = 0;     // grey levels, independent in every pixel
  // Likewise, but the same in every frame: what a sensor adds to its pixels.
  double fixed_noise_sigma = 0;
  std::uint64_t noise_seed = 1;
  // Light on the ball falls linearly from 1 at the rim facing the lamp to 1 - shading at the rim
  // opposite. Fixed to the lamp: it follows the centre and does not turn with the ball.
  double shading = 0;     // 0 ... 1
  double lamp_deg = 135;  // where the lamp is, counter-clockwise from image-right
  std::optional<OccludingBar> bar;
  int bits = 8;  // of the frames: 8 ... 16
  // Of a sphere. A lamp far away gives the share lamp_share of the light, ambient light the rest: a
  // surface whose normal is at the angle i to the lamp shows 1 - lamp_share (1 - max(0, cos i))
  // of its grey level (Lambert 1760). The lamp stands lamp_deg on the screen and
  // lamp_elevation_deg from the picture's plane towards the camera.
  double lamp_share = 0;          // 0 ... 1
  double lamp_elevation_deg = 0;  // -90 ... 90
  // u of the linear law of limb darkening 1 - u (1 - cos e), e between normal and line of sight
  // (Milne 1921).
  double limb_darkening = 0;  // 0 ... 1
  // Distance from the camera to the plane of the ball's centre, in radii of the ball; there a px
  // of the ball is a px of the picture. The camera looks along Z through the picture's middle. The
  // outline's radius on that axis is R / sqrt(1 - (R/D)^2). 0: parallel rays.
  double distance_radii = 0;
  // A lens that bends straight lines: what would be r from the picture's middle is shown at
  // r (1 + k1 q^2 + k2 q^4), q being r over half of the picture's diagonal. The truth is where a
  // lens without distortion would show the ball.
  double distortion_k1 = 0, distortion_k2 = 0;  // -0.3 ... 0.3

  // Throws InvalidArgument.
  void validate() const;
};

struct StartPx {
  double x_px = 0, y_px = 0;
};

struct SynthRequest {
  SynthBody body = SynthBody::kDisc;
  // Painted ball: a1 ... a3, b1 ... b3, c1 ... c3, d1 ... d3, e1, e2, f1, f2; or none.
  std::string pattern = "e1";
  std::uint64_t seed = 1;  // of the pattern and of the noise (scene.noise_seed is not looked at)
  double radius_px = 115;  // 20 ... 2000
  double fps = 10000;
  int frames = 0;  // 0: 20; as many as are given; 110 of an impact
  std::variant<ConstantMotion, GivenMotion, SimulatedMotion> motion =
      ConstantMotion{{}, 1, 0, 0, 0};
  // The centre in frame 0; without it the path lies in the picture's middle. Not where `placed`.
  std::optional<StartPx> start;
  SynthScene scene;
  double exposure = 0;    // share of the frame interval that the shutter is open
  double hidden = 0;      // share of the ball that a bar hides in bar_frame (SynthTruth)
  double bar_level = 90;  // its grey level

  // Throws InvalidArgument naming the setting, by its name on the command line.
  void validate() const;
};

// Where the ball is, exact to double precision.
struct SynthTruth {
  std::vector<BallPose> poses;             // one a frame, at mid-exposure
  std::size_t bar_frame = 0;               // the middle frame; of an impact that of the first touch
  double surface_angle_deg = 0;            // of an impact; the bar's direction
  std::optional<std::size_t> leaves_view;  // the first frame that does not show the whole ball
};

// The truth alone, without a picture. Throws as synthesize.
SynthTruth synth_truth(const SynthRequest& request);

struct SynthResult {
  SynthTruth truth;
  std::size_t frames = 0;  // rendered
  bool cancelled = false;
};

// Gets the frames one after the other, in order; valid during the call only.
using SynthSink = std::function<void(const Frame&)>;

// Renders every frame. The same request gives the same bits, however many threads work. What `sink`
// throws ends the clip and is thrown on. Throws InvalidArgument (validate, or as simulate).
SynthResult synthesize(const SynthRequest& request, const SynthSink& sink,
                       const RunControl& control = {});

}  // namespace impactdic
