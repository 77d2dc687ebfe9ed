#include "sim/speckle/sphere/sphere_view.h"

#include <impactdic/error.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/speckle/orientation.h"

namespace impactdic::sim::speckle {
namespace {

constexpr double kNearest = 1.2;  // radii from the eye to the centre

}  // namespace

Stretches meet(const Stretches& a, const Stretches& b) {
  Stretches out;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count && out.count < 2; ++j) {
      const Span &p = a.span[static_cast<std::size_t>(i)], &q = b.span[static_cast<std::size_t>(j)];
      out.add(std::max(p.first, q.first), std::min(p.last, q.last));
    }
  }
  return out;
}

Stretches SphereLine::stretches(const Eigen::Vector3d& w, double b) const {
  Stretches out;
  const double p = e1_.dot(w), q = e2_.dot(w), h = std::hypot(p, q);
  const double beyond = b - m_.dot(w);
  if (beyond >= rho_ * h) return out;
  if (beyond <= -rho_ * h) {
    out.add(outline_.first, outline_.last);
    return out;
  }
  // The arc cos(a - a0) >= k between a0 - delta and a0 + delta.
  const double k = beyond / (rho_ * h), s = std::sqrt(1 - k * k);
  const double s0 = p / h, c0 = q / h;
  const double left_cosine = c0 * k + s0 * s, right_cosine = c0 * k - s0 * s;
  const bool left_seen = left_cosine > visible_, right_seen = right_cosine > visible_;
  const double left = left_seen ? column(s0 * k - c0 * s, left_cosine) : outline_.first;
  const double right = right_seen ? column(s0 * k + c0 * s, right_cosine) : outline_.last;
  if (!left_seen && !right_seen) {
    // All or nothing: as the point nearest to the eye, a = 0.
    if (c0 >= k) out.add(outline_.first, outline_.last);
  } else if (left_seen && right_seen && left > right) {
    out.add(outline_.first, right);  // the arc goes round the back
    out.add(left, outline_.last);
  } else {
    out.add(left, right);
    out.whole = left_seen && right_seen && out.count == 1;
  }
  return out;
}

void SphereLine::widen(double factor) {
  const double middle = (outline_.first + outline_.last) / 2, rest = (1 - factor) * middle;
  n0_ = factor * n0_ + rest * d0_;
  n1_ = factor * n1_ + rest * d1_;
  n2_ = factor * n2_ + rest * d2_;
  const double half = factor * (outline_.last - middle);
  outline_ = {middle - half, middle + half};
}

Eigen::Vector3d SphereLine::point(double x) const {
  // a sin + b cos = g, the solution towards the eye.
  const double a = n1_ - x * d1_, b = n2_ - x * d2_, g = x * d0_ - n0_;
  const double square = a * a + b * b, root = std::sqrt(std::max(0.0, square - g * g));
  return m_ + rho_ / square * ((g * a - b * root) * e1_ + (g * b + a * root) * e2_);
}

SphereView::SphereView(const BallPose& pose, double radius_px, const SynthScene& scene)
    : radius_(radius_px),
      x0_((scene.width - 1) / 2.0),
      y0_((scene.height - 1) / 2.0),
      distance_(scene.distance_radii * radius_px),
      c_(pose.compression),
      parallel_(scene.distance_radii == 0),
      turn_(orientation_of(pose).toRotationMatrix()) {
  if (!(c_ >= 0 && c_ <= 0.5)) {
    throw InvalidArgument("the compression is out of range", "pose", "0 … 0.5 of the diameter");
  }
  const Vec axis = direction(pose.compression_axis_deg);
  axis_ = {axis.x, -axis.y, 0};
  if (parallel_) {
    centre_ = {pose.cx_px, -pose.cy_px, 0};
    eye_ = Eigen::Vector3d::UnitZ();
    columns_ = {pose.cx_px - radius_, pose.cx_px + radius_};
    rows_ = {pose.cy_px - radius_, pose.cy_px + radius_};
    return;
  }
  const double depth = distance_ - pose.z_px;
  if (!(depth > kNearest * radius_)) {
    throw InvalidArgument("the ball comes too near to the camera", "pose",
                          "a larger distance, or a smaller z_px");
  }
  const double wide = depth / distance_;
  centre_ = {(pose.cx_px - x0_) * wide, -(pose.cy_px - y0_) * wide, -depth};
  eye_ = stretch(-centre_);
  const auto tangents = [&](double aside) -> Span {
    const double to = std::atan2(aside, depth),
                 half = std::asin(radius_ / std::hypot(aside, depth));
    return {distance_ * std::tan(to - half), distance_ * std::tan(to + half)};
  };
  const Span across = tangents(centre_.x()), up = tangents(centre_.y());
  columns_ = {x0_ + across.first, x0_ + across.last};
  rows_ = {y0_ - up.last, y0_ - up.first};
}

SphereLine SphereView::line(double y) const {
  SphereLine line;
  const Eigen::Vector3d right = stretch(Eigen::Vector3d::UnitX());
  const Eigen::Vector3d ray = parallel_ ? Eigen::Vector3d(0, 0, -1)
                                        : stretch(Eigen::Vector3d(0, -(y - y0_) / distance_, -1));
  const Eigen::Vector3d on_plane =
      parallel_ ? stretch(Eigen::Vector3d(0, -y - centre_.y(), 0)) : eye_;
  const Eigen::Vector3d normal = right.cross(ray).normalized();
  line.m_ = normal * normal.dot(on_plane);
  const double square = radius_ * radius_ - line.m_.squaredNorm();
  if (!(square > 0)) return line;
  line.rho_ = std::sqrt(square);
  const Eigen::Vector3d to_eye = parallel_ ? eye_ : Eigen::Vector3d(eye_ - line.m_);
  line.e2_ = to_eye.normalized();
  line.visible_ = parallel_ ? 0 : line.rho_ / to_eye.norm();
  line.e1_ = normal.cross(line.e2_);
  if (line.e1_.dot(right) < 0) line.e1_ = -line.e1_;
  const Eigen::Vector3d base = squash(line.m_), a = squash(line.e1_) * line.rho_,
                        b = squash(line.e2_) * line.rho_;
  if (parallel_) {
    line.n0_ = centre_.x() + base.x();
    line.n1_ = a.x();
    line.n2_ = b.x();
  } else {
    line.d0_ = -centre_.z() - base.z();
    line.d1_ = -a.z();
    line.d2_ = -b.z();
    line.n0_ = distance_ * (centre_.x() + base.x()) + x0_ * line.d0_;
    line.n1_ = distance_ * a.x() + x0_ * line.d1_;
    line.n2_ = distance_ * b.x() + x0_ * line.d2_;
  }
  const double sine = std::sqrt(1 - line.visible_ * line.visible_);
  line.outline_ = {line.column(-sine, line.visible_), line.column(sine, line.visible_)};
  return line;
}

Span SphereView::rows_of(const Eigen::Vector3d& centre, double radius_px) const {
  const double sine = radius_px / radius_, cosine = std::sqrt(1 - sine * sine);
  const double away = parallel_ ? 1 : eye_.norm();
  const double facing = centre.dot(eye_) / away, limit = parallel_ ? 0 : radius_ / away;
  if (facing < cosine &&
      facing * cosine + std::sqrt(std::max(0.0, 1 - facing * facing)) * sine < limit) {
    return {1, 0};
  }
  // A disc about the middle of the cap's rim; half its height and depth.
  const Eigen::Vector3d middle = centre_ + squash(centre * (radius_ * cosine));
  const Eigen::Vector3d up = squash(Eigen::Vector3d::UnitY());
  const double along = up.dot(centre);
  // The cap ends at its rim, or at the ball's outline where it lies over the highest or lowest
  // point.
  const double high = radius_px * std::sqrt(std::max(0.0, up.squaredNorm() - along * along)) + 1e-6;
  double y = -middle.y(), half = high, aslant = 0;
  if (!parallel_) {
    const double depth = -middle.z();
    const double deep = radius_px * std::sqrt(std::max(0.0, 1 - centre.z() * centre.z()));
    y = y0_ - distance_ * middle.y() / depth;
    half = distance_ * (high + std::abs(middle.y()) * deep / depth) / (depth - deep);
    aslant = std::atan2(radius_ + std::abs(centre_.y()), -centre_.z() - radius_);
  }
  const double from_pole = std::acos(std::min(1.0, std::abs(along) / up.norm()));
  if (from_pole > std::asin(sine) + aslant) return {y - half, y + half};
  return along > 0 ? Span{rows_.first, y + half} : Span{y - half, rows_.last};
}

Eigen::Vector3d SphereView::to_camera(const Eigen::Vector3d& point) const {
  return parallel_ ? eye_ : Eigen::Vector3d((eye_ - point).normalized());
}

}  // namespace impactdic::sim::speckle
