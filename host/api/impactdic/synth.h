// Clips of a speckled ball with exactly known motion, rendered from formulas.
//
// Image axes: x right, y down, pixel centres at integers. Angles are positive counter-clockwise as
// seen on the screen.
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

struct BallPose {
  double cx_px = 0, cy_px = 0;       // the ball's centre
  double angle_deg = 0;              // turned from the pattern's own position
  double compression = 0;            // 0 ... 0.5: the ball is shorter by this share along the axis
  double compression_axis_deg = 90;  // direction of that axis on the screen
};

// The same step from frame to frame.
struct ConstantMotion {
  BallPose start;
  double dx_px = 0, dy_px = 0;  // per frame
  double rotation_deg = 0;      // per frame
  double compression_per_frame = 0;
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
  std::uint64_t noise_seed = 1;
  // Light on the ball falls linearly from 1 at the rim facing the lamp to 1 - shading at the rim
  // opposite. Fixed to the lamp: it follows the centre and does not turn with the ball.
  double shading = 0;     // 0 ... 1
  double lamp_deg = 135;  // where the lamp is, counter-clockwise from image-right
  std::optional<OccludingBar> bar;
  int bits = 8;  // of the frames: 8 ... 16

  // Throws InvalidArgument.
  void validate() const;
};

struct StartPx {
  double x_px = 0, y_px = 0;
};

struct SynthRequest {
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
