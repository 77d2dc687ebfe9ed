#include <impactdic/error.h>
#include <impactdic/synth.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "sim/contact/motion.h"
#include "sim/speckle/clip.h"
#include "sim/speckle/lens.h"
#include "sim/speckle/orientation.h"
#include "sim/speckle/sphere/sphere_render.h"

namespace impactdic {
namespace {

constexpr int kDefaultFrames = 20;
constexpr int kImpactFrames = 110;

// Puts a path that is known only relative to its first frame into the picture.
void put_into_picture(std::vector<BallPose>& poses, const SynthRequest& request) {
  double x, y;
  if (request.start) {
    x = request.start->x_px - poses.front().cx_px;
    y = request.start->y_px - poses.front().cy_px;
  } else {
    const auto [left, right] =
        std::minmax_element(poses.begin(), poses.end(),
                            [](const BallPose& a, const BallPose& b) { return a.cx_px < b.cx_px; });
    const auto [top, bottom] =
        std::minmax_element(poses.begin(), poses.end(),
                            [](const BallPose& a, const BallPose& b) { return a.cy_px < b.cy_px; });
    x = (request.scene.width - 1) / 2.0 - (left->cx_px + right->cx_px) / 2;
    y = (request.scene.height - 1) / 2.0 - (top->cy_px + bottom->cy_px) / 2;
  }
  for (BallPose& pose : poses) {
    pose.cx_px += x;
    pose.cy_px += y;
  }
}

// With a distance the path was laid in the plane at that distance; the picture shows what comes
// nearer larger.
void put_into_perspective(std::vector<BallPose>& poses, const SynthRequest& request) {
  const double distance = request.scene.distance_radii * request.radius_px;
  if (distance == 0) return;
  const double x0 = (request.scene.width - 1) / 2.0, y0 = (request.scene.height - 1) / 2.0;
  for (BallPose& pose : poses) {
    if (pose.z_px == 0) continue;
    const double scale = distance / (distance - pose.z_px);
    pose.cx_px = x0 + scale * (pose.cx_px - x0);
    pose.cy_px = y0 + scale * (pose.cy_px - y0);
  }
}

SynthTruth path_of(const ConstantMotion& motion, const SynthRequest& request) {
  SynthTruth truth;
  truth.poses =
      sim::speckle::constant_motion(motion, request.frames > 0 ? request.frames : kDefaultFrames);
  truth.bar_frame = (truth.poses.size() - 1) / 2;
  return truth;
}

SynthTruth path_of(const GivenMotion& motion, const SynthRequest& request) {
  SynthTruth truth;
  truth.poses = motion.poses;
  if (request.frames > 0) truth.poses.resize(static_cast<std::size_t>(request.frames));
  truth.bar_frame = (truth.poses.size() - 1) / 2;
  return truth;
}

// The path of an impact, relative to the first touch, which the radius in px scales.
SynthTruth path_of(const SimulatedMotion& motion, const SynthRequest& request) {
  const ImpactJob& job = motion.impact;
  const int frames = request.frames > 0 ? request.frames : kImpactFrames;
  const double px_per_m = 2 * request.radius_px / job.body.diameter_m;
  SynthTruth truth;
  truth.surface_angle_deg = job.surface_angle_deg;
  truth.bar_frame =
      static_cast<std::size_t>(std::clamp(std::lround(motion.touch_frame), 0L, frames - 1L));
  for (const sim::contact::FramePose& at :
       sim::contact::simulate_motion(job, request.fps, frames, motion.touch_frame)) {
    BallPose pose{at.x_m * px_per_m, -at.y_m * px_per_m, at.angle_rad * kDegPerRad, at.compression,
                  job.surface_angle_deg + 90};
    if (!job.initial.plane()) {
      pose = oriented(pose, at.orientation);
      pose.z_px = at.z_m * px_per_m;
    }
    truth.poses.push_back(pose);
  }
  return truth;
}

std::optional<std::size_t> leaves_view(const SynthTruth& truth, const SynthRequest& request) {
  for (std::size_t k = 0; k < truth.poses.size(); ++k) {
    const BallPose& p = truth.poses[k];
    const double r = sim::speckle::radius_seen(p, request.radius_px, request.scene.distance_radii);
    if (p.cx_px < r || p.cy_px < r || p.cx_px > request.scene.width - 1 - r ||
        p.cy_px > request.scene.height - 1 - r) {
      return k;
    }
  }
  return std::nullopt;
}

sim::speckle::SpeckleBall make_ball(const SynthRequest& request) {
  if (request.pattern != "none") {
    return sim::speckle::paint_ball(request.pattern, request.seed, request.radius_px);
  }
  sim::speckle::SpeckleBall plain;
  plain.radius_px = request.radius_px;
  return plain;
}

sim::speckle::SpeckleSphere make_sphere(const SynthRequest& request) {
  if (request.pattern != "none") {
    return sim::speckle::paint_sphere(request.pattern, request.seed, request.radius_px);
  }
  sim::speckle::SpeckleSphere plain;
  plain.radius_px = request.radius_px;
  return plain;
}

std::unique_ptr<sim::speckle::FrameRenderer> make_renderer(const SynthRequest& request,
                                                           const SynthScene& scene) {
  using namespace sim::speckle;
  if (bends(scene)) {
    std::unique_ptr<FrameRenderer> fine;
    if (request.body == SynthBody::kSphere) {
      fine = std::make_unique<SphereRenderer>(finer(make_sphere(request)), finer(scene));
    } else {
      fine = std::make_unique<BallRenderer>(finer(make_ball(request)), finer(scene));
    }
    return std::make_unique<BentRenderer>(std::move(fine), scene);
  }
  if (request.body == SynthBody::kSphere) {
    return std::make_unique<SphereRenderer>(make_sphere(request), scene);
  }
  return std::make_unique<BallRenderer>(make_ball(request), scene);
}

// A disc has neither far side nor depth.
void validate_disc(const SynthRequest& request) {
  const SynthScene& scene = request.scene;
  const auto refuse = [](bool found, const char* what, const char* key) {
    if (found) throw InvalidArgument(what, key, "--body sphere");
  };
  const auto turns = [](const BallPose& pose) {
    return pose.rx_deg != 0 || pose.ry_deg != 0 || pose.z_px != 0;
  };
  refuse(scene.lamp_share > 0, "a disc is not lit by a lamp", "--lamp");
  refuse(scene.limb_darkening > 0, "a disc has no limb", "--limb-darkening");
  refuse(scene.distance_radii > 0, "a disc has no depth", "--distance");
  if (const auto* motion = std::get_if<ConstantMotion>(&request.motion)) {
    refuse(turns(motion->start) || motion->spin_x_deg != 0 || motion->spin_y_deg != 0 ||
               motion->dz_px != 0,
           "a disc turns and moves in its plane only", "--spin-deg, --velocity-px");
  } else if (const auto* given = std::get_if<GivenMotion>(&request.motion)) {
    refuse(std::any_of(given->poses.begin(), given->poses.end(), turns),
           "a disc turns and moves in its plane only", "--motion");
  } else if (const auto* impact = std::get_if<SimulatedMotion>(&request.motion)) {
    refuse(!impact->impact.initial.plane(), "a disc turns and moves in its plane only",
           "--simulate");
  }
}

bool finite(const BallPose& p) {
  for (const double v : {p.cx_px, p.cy_px, p.angle_deg, p.compression, p.compression_axis_deg,
                         p.rx_deg, p.ry_deg, p.z_px}) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

bool finite(const ConstantMotion& m) {
  for (const double v : {m.dx_px, m.dy_px, m.rotation_deg, m.compression_per_frame, m.spin_x_deg,
                         m.spin_y_deg, m.dz_px}) {
    if (!std::isfinite(v)) return false;
  }
  return finite(m.start);
}

void validate_motion(const SynthRequest& request) {
  if (const auto* motion = std::get_if<ConstantMotion>(&request.motion)) {
    if (!finite(*motion)) {
      throw InvalidArgument("must be finite", "motion");
    }
  } else if (const auto* given = std::get_if<GivenMotion>(&request.motion)) {
    if (!std::all_of(given->poses.begin(), given->poses.end(),
                     [](const BallPose& pose) { return finite(pose); })) {
      throw InvalidArgument("must be finite", "--motion");
    }
    if (given->poses.empty()) throw InvalidArgument("the motion has no pose", "--motion");
    if (static_cast<std::size_t>(request.frames) > given->poses.size()) {
      throw InvalidArgument(
          "the motion has only " + std::to_string(given->poses.size()) + " frames", "--motion",
          "ask for fewer with --frames");
    }
    if (given->placed && request.start) {
      throw InvalidArgument("the motion file already says where the ball is", "--start-px",
                            "leave it out, or give dx_px,dy_px in the file");
    }
  } else if (const auto* impact = std::get_if<SimulatedMotion>(&request.motion)) {
    if (impact->impact.body.shape == BodyShape::kRod) {
      throw InvalidArgument("the renderer knows balls only", "--simulate", "not a rod");
    }
    if (impact->impact.other) {
      throw InvalidArgument("the renderer shows one ball", "--simulate", "without [other]");
    }
    if (!std::isfinite(impact->touch_frame)) throw InvalidArgument("must be finite", "touch_frame");
    impact->impact.validate();
  }
  if (request.start &&
      !(std::isfinite(request.start->x_px) && std::isfinite(request.start->y_px))) {
    throw InvalidArgument("must be finite", "--start-px");
  }
}

}  // namespace

Quaternion orientation(const BallPose& pose) {
  Eigen::Quaterniond q = sim::speckle::orientation_of(pose);
  if (q.w() < 0) q.coeffs() *= -1;
  return {q.w(), q.x(), q.y(), q.z()};
}

BallPose oriented(BallPose pose, const Quaternion& orientation) {
  const Eigen::Quaterniond q(orientation.w, orientation.x, orientation.y, orientation.z);
  if (!(q.norm() > 0) || !std::isfinite(q.norm())) {
    throw InvalidArgument("is no orientation", "quaternion", "one that is not zero");
  }
  sim::speckle::set_orientation(pose, q);
  return pose;
}

void SynthRequest::validate() const {
  const auto require = [](bool good, const char* what, const char* key, const char* hint = "") {
    if (!good) throw InvalidArgument(what, key, hint);
  };
  if (pattern != "none") sim::speckle::find_pattern(pattern);
  require(radius_px >= 20 && radius_px <= 2000, "the ball's radius is out of range", "--radius-px",
          "20 ... 2000 px");
  require(fps > 0 && std::isfinite(fps), "must be positive", "--fps");
  require(frames >= 0, "must not be negative", "--frames");
  require(exposure >= 0 && exposure <= 1, "the exposure is out of range", "--exposure",
          "0 ... 1 of a frame interval");
  require(hidden >= 0 && hidden <= 1, "the hidden share of the ball is out of range", "--occlude",
          "0 ... 1");
  scene.validate();
  validate_motion(*this);
  if (body == SynthBody::kDisc) validate_disc(*this);
}

SynthTruth synth_truth(const SynthRequest& request) {
  request.validate();
  SynthTruth truth =
      std::visit([&](const auto& motion) { return path_of(motion, request); }, request.motion);
  const auto* given = std::get_if<GivenMotion>(&request.motion);
  if (given == nullptr || !given->placed) put_into_picture(truth.poses, request);
  if (given == nullptr) {
    put_into_perspective(truth.poses, request);
  }
  truth.leaves_view = leaves_view(truth, request);
  return truth;
}

SynthResult synthesize(const SynthRequest& request, const SynthSink& sink,
                       const RunControl& control) {
  SynthResult result;
  result.truth = synth_truth(request);
  SynthScene scene = request.scene;
  scene.noise_seed = request.seed;
  if (request.hidden > 0) {
    scene.bar = sim::speckle::bar_hiding(request.hidden, result.truth.poses[result.truth.bar_frame],
                                         request.radius_px, result.truth.surface_angle_deg);
    scene.bar->level = request.bar_level;
  }
  const auto renderer = make_renderer(request, scene);
  result.frames =
      sim::speckle::render_clip(*renderer, result.truth.poses, request.exposure, sink, control);
  result.cancelled = result.frames < result.truth.poses.size();
  return result;
}

}  // namespace impactdic
