#include "host/impact/flight/flight_links.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "host/base/statistics.h"
#include "host/impact/flight/flat_links.h"

namespace impactdic::impact {
namespace {

using Eigen::Matrix3d, Eigen::Quaterniond, Eigen::Vector2d, Eigen::Vector3d;

// Where a keyframe's picture has turned away by this much, foreshortening makes frames that lean on
// it err alike by as much as noise does (four patterns of R 115 px).
constexpr double kReach_rad = 10 * kRadPerDeg;
constexpr double kFree = 1e3;  // deviations: what is not known of a keyframe before the flight
constexpr double kLeastAngle_rad = 1e-9;

Quaterniond quaternion_of(const Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < kLeastAngle_rad) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

Vector3d rotation_vector(Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double length = q.vec().norm();
  if (length < kLeastAngle_rad) return 2 * q.vec();
  return 2 * std::atan2(length, q.w()) / length * q.vec();
}

// What a change of the rotation vector turns further by, about the camera's axes (left Jacobian of
// SO(3): Chirikjian 2012, equation 10.86).
Matrix3d turned_further(const Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < 1e-6) return Matrix3d::Identity();
  const Vector3d u = vector / angle;
  Matrix3d cross;
  cross << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
  const double s = std::sin(angle) / angle;
  return s * Matrix3d::Identity() + (1 - s) * u * u.transpose() +
         (1 - std::cos(angle)) / angle * cross;
}

// One registration, in the surface's axes t, n, b: t and n in px, turns in rad.
struct Link {
  Vector2d shift;
  Quaterniond turn;
  double tilt_rad = 0;
  Eigen::Matrix2d shift_to_centre;  // px a px by which the keyframe's circle lies off the ball
  Eigen::Matrix<double, 3, 2> turn_to_centre;
  Vector2d shift_to_radius, shift_to_nearness;
  Vector3d turn_to_radius, turn_to_nearness;
};

class FlightLinks {
 public:
  FlightLinks(const ImpactSeries& series, const GravityDirection& direction,
              const FlightRange& range, int flight, int group)
      : rows_(series.sphere->rows()),
        series_(series),
        pull_(direction.t, direction.n),
        across_(-direction.n, direction.t),
        range_(range),
        flight_(flight),
        next_group_(group) {
    to_local_ << series.sphere->cosine(), series.sphere->sine(), 0, -series.sphere->sine(),
        series.sphere->cosine(), 0, 0, 0, 1;
    spin_ = usual_spin();
  }

  std::vector<Datum> data() {
    if (!spin_.allFinite()) return {};
    std::size_t linked = 0;
    for (std::size_t i = range_.first + 1; i <= range_.last; ++i) {
      if (add(i)) ++linked;
    }
    const auto frames = static_cast<double>(range_.last - range_.first);
    if (static_cast<double>(linked) < kFewestLinked * frames) return {};
    return std::move(data_);
  }

 private:
  // A keyframe, or where it lies before the flight the first frame that leans on it.
  struct Key {
    int group = 0;
    std::size_t row = 0;
    bool in_flight = false;
    Quaterniond turn = Quaterniond::Identity();  // of that first frame
    Vector2d shift = Vector2d::Zero();
  };

  // A turn a frame that is near enough to linearise about.
  Vector3d usual_spin() const {
    Vector3d spin;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> turns;
      for (std::size_t i = range_.first; i < range_.last; ++i) {
        const TrackRow& row = rows_[i];
        if (!row.motion_ok || !std::isfinite(row.rot_x_deg)) continue;
        turns.push_back((to_local_ * Vector3d(row.rot_x_deg, row.rot_y_deg, row.rot_deg))[axis]);
      }
      spin[axis] = turns.empty() ? kNotMeasured : upper_median(std::move(turns)) * kRadPerDeg;
    }
    return spin;
  }

  std::optional<Link> link(const TrackRow& row) const {
    const BodyPose& pose = row.pose;
    if (!pose.ok || !row.circle_ok || !std::isfinite(pose.key_rot_x_deg)) return std::nullopt;
    const Vector3d turn =
        Vector3d(pose.key_rot_x_deg, pose.key_rot_y_deg, pose.key_rot_deg) * kRadPerDeg;
    TrackRow key = row;  // where the keyframe's ball was
    key.cx_px -= pose.key_dx_px;
    key.cy_px -= pose.key_dy_px;
    const auto r = series_.sphere->response(key, turn, pose.key_dx_px, pose.key_dy_px);
    if (!std::isfinite(r.rot_z[sphere::kToRadius])) return std::nullopt;
    // In the picture y points down.
    const Eigen::Matrix2d flat = to_local_.topLeftCorner<2, 2>() * Vector2d(1, -1).asDiagonal();
    Link link;
    link.shift = flat * Vector2d(pose.key_dx_px, pose.key_dy_px);
    link.turn = quaternion_of(to_local_ * turn);
    link.tilt_rad = std::acos(std::clamp(link.turn.toRotationMatrix()(2, 2), -1.0, 1.0));
    Eigen::Matrix2d shift;
    shift << r.dx[0], r.dx[1], r.dy[0], r.dy[1];
    link.shift_to_centre = flat * shift * flat.transpose();
    Eigen::Matrix<double, 3, 2> turns;
    turns << r.rot_x[0], r.rot_x[1], r.rot_y[0], r.rot_y[1], r.rot_z[0], r.rot_z[1];
    link.turn_to_centre = to_local_ * turns * flat.transpose();
    const auto shift_by = [&](std::size_t k) -> Vector2d {
      return flat * Vector2d(r.dx[k], r.dy[k]);
    };
    const auto turn_by = [&](std::size_t k) -> Vector3d {
      return to_local_ * Vector3d(r.rot_x[k], r.rot_y[k], r.rot_z[k]);
    };
    link.shift_to_radius = shift_by(sphere::kToRadius);
    link.turn_to_radius = turn_by(sphere::kToRadius);
    link.shift_to_nearness = shift_by(sphere::kToNearness);
    link.turn_to_nearness = turn_by(sphere::kToNearness);
    return link;
  }

  const Key& key_of(std::size_t i, const Link& link) {
    const std::int64_t frame = rows_[i].pose.keyframe;
    const auto known = keys_.find(frame);
    if (known != keys_.end()) return known->second;
    Key key;
    key.group = next_group_;
    next_group_ += 3;
    const auto row = rows_.find_frame(frame);
    key.in_flight = row && *row >= range_.first && *row < i && rows_[*row].circle_ok &&
                    rows_[*row].pose.origin == rows_[i].pose.origin;
    key.row = key.in_flight ? *row : i;
    if (!key.in_flight) key.turn = link.turn, key.shift = link.shift;
    return keys_.emplace(frame, key).first->second;
  }

  Datum begun(DatumKind kind, bool normal, const Key& key, const Link& link) const {
    Datum datum;
    datum.kind = kind;
    datum.normal = normal;
    datum.flight = flight_;
    datum.group = key.group + (kind == DatumKind::kShift ? 0 : kind == DatumKind::kTilt ? 1 : 2);
    datum.group = 2 * datum.group + (normal ? 1 : 0);
    datum.loose = key.in_flight ? 1 : kFree;
    datum.reach = link.tilt_rad / kReach_rad;
    return datum;
  }

  // What `slope` times how far the keyframe's circle lies off the ball's path does to `row`.
  void add_off_path(const Eigen::RowVector2d& slope, const Key& key, Datum& row) const {
    const double at = static_cast<double>(key.row) - range_.at;
    const Vector2d circle(series_.position_t(key.row), series_.position_n[key.row]);
    const std::array<std::size_t, 2> place = {kT0, kN0};
    for (int axis = 0; axis < 2; ++axis) {
      const std::size_t column = place[static_cast<std::size_t>(axis)];
      row.slope[column] -= slope[axis];
      row.slope[column + 1] -= slope[axis] * at;
    }
    row.gravity_slope -= slope.dot(pull_) * at * at / 2;
    row.across_slope -= slope.dot(across_) * at * at / 2;
    row.value -= slope.dot(circle);
  }

  Datum shift(std::size_t i, const Link& link, const Key& key, bool normal) const {
    Datum row = begun(DatumKind::kShift, normal, key, link);
    const double at = static_cast<double>(i) - range_.at;
    const double from = static_cast<double>(key.row) - range_.at;
    const int axis = normal ? 1 : 0;
    row.slope[(normal ? kN0 : kT0) + 1] = at - from;
    row.gravity_slope = pull_[axis] * (at * at - from * from) / 2;
    row.across_slope = across_[axis] * (at * at - from * from) / 2;
    row.value = link.shift[axis] - key.shift[axis];
    row.radius_slope = link.shift_to_radius[axis];
    row.nearness_slope = link.shift_to_nearness[axis];
    if (key.in_flight) add_off_path(link.shift_to_centre.row(axis), key, row);
    return row;
  }

  Datum turn(std::size_t i, const Link& link, const Key& key, int axis) const {
    Datum row = begun(axis == 2 ? DatumKind::kRoll : DatumKind::kTilt, axis == 1, key, link);
    const double frames = static_cast<double>(i) - static_cast<double>(key.row);
    const Vector3d expected = frames * spin_;
    const Quaterniond turned = link.turn * key.turn.conjugate();
    const Vector3d off = rotation_vector(turned * quaternion_of(expected).conjugate());
    const Eigen::RowVector3d slope = frames * turned_further(expected).row(axis);
    row.value = off[axis] + slope * spin_;
    for (int k = 0; k < 3; ++k) row.spin_slope[static_cast<std::size_t>(k)] = slope[k];
    row.radius_slope = link.turn_to_radius[axis];
    row.nearness_slope = link.turn_to_nearness[axis];
    if (axis == 2) {
      row.rolled_slope = link.tilt_rad;
    } else {
      row.tilted_slope = rotation_vector(link.turn)[axis];
    }
    if (key.in_flight) add_off_path(link.turn_to_centre.row(axis), key, row);
    return row;
  }

  // Of frame `i`; false where it has none. Its noise is that of the step into it, of which two
  // frames make one half each.
  bool add(std::size_t i) {
    const std::optional<Link> link = this->link(rows_[i]);
    const SphereStep step = link ? (*series_.sphere)[i - 1] : SphereStep{};
    if (!step.ok) return false;
    const Key& key = key_of(i, *link);
    const std::array shifts = {shift(i, *link, key, false), shift(i, *link, key, true)};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      keep(shifts[axis], step.step_sd[axis]);
      Datum tilt = turn(i, *link, key, static_cast<int>(axis));
      // A place and the turn across it err together.
      for (std::size_t k = 0; k < 2; ++k) take_off(tilt, step.by_step[axis][k], shifts[k]);
      keep(tilt, step.turn_sd[axis]);
    }
    keep(turn(i, *link, key, 2), series_.turn_sd(i - 1));
    return true;
  }

  void keep(Datum row, double of_step) {
    row.sd = of_step / std::sqrt(2.0);
    if (std::isfinite(row.value) && row.sd > 0) data_.push_back(row);
  }

  TrackRows rows_;
  const ImpactSeries& series_;
  Vector2d pull_, across_;
  FlightRange range_;
  int flight_, next_group_;
  Matrix3d to_local_;
  Vector3d spin_;
  std::map<std::int64_t, Key> keys_;  // by frame
  std::vector<Datum> data_;
};

}  // namespace

std::vector<Datum> flight_links(const ImpactSeries& series, const GravityDirection& direction,
                                const FlightRange& range, int flight, int first_group) {
  if (!series.sphere) return flat_links(series, direction, range, flight, first_group);
  return FlightLinks(series, direction, range, flight, first_group).data();
}

}  // namespace impactdic::impact
