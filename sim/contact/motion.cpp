#include "sim/contact/motion.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "sim/contact/impact.h"

namespace impactdic::sim::contact {
namespace {

Eigen::Quaterniond of(const Quaternion& q) { return {q.w, q.x, q.y, q.z}; }

}  // namespace

std::vector<FramePose> simulate_motion(const ImpactJob& job, double fps, int frames,
                                       double touch_frame) {
  if (!(fps > 0)) throw InvalidArgument("must be positive", "fps");
  if (frames < 1) throw InvalidArgument("must be at least 1", "frames");
  const ImpactResult impact = simulate_impact(job);
  std::vector<double> times(frames);
  for (int frame = 0; frame < frames; ++frame) {
    times[frame] = impact.contact_start_s + (frame - touch_frame) / fps;
  }
  const double touch_s = impact.contact_start_s;
  const std::vector<TrajectoryPoint> touch =
      simulate_impact(job, {.times_s = std::span(&touch_s, 1)}).trajectory;
  const std::vector<TrajectoryPoint> path = simulate_impact(job, {.times_s = times}).trajectory;
  const double angle = job.surface_angle_deg * kRadPerDeg;
  // Local axes t, n, b to world axes.
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond first = of(path[0].state.orientation);
  std::vector<FramePose> poses(frames);
  for (int frame = 0; frame < frames; ++frame) {
    const TrajectoryPoint& point = path[frame];
    const double t = point.state.qt_m - touch[0].state.qt_m;
    const double n = point.state.qn_m - point.state.outline_lag_m;
    const double flattened = job.shell ? point.state.flattening_m : point.deflection_m;
    const Eigen::Quaterniond q =
        tilt * of(point.state.orientation) * first.conjugate() * tilt.conjugate();
    poses[frame] = {point.time_s - touch_s,
                    t * std::cos(angle) - n * std::sin(angle),
                    t * std::sin(angle) + n * std::cos(angle),
                    point.state.qb_m - touch[0].state.qb_m,
                    point.state.angle_rad - path[0].state.angle_rad,
                    {q.w(), q.x(), q.y(), q.z()},
                    std::max(flattened, 0.0) / job.body.diameter_m};
  }
  return poses;
}

}  // namespace impactdic::sim::contact
