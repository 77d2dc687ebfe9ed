#include "sim/shot/shot.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"
#include "host/clip/track_row.h"
#include "host/impact/impact_phases.h"
#include "host/impact/impulse_figures.h"
#include "sim/contact/impact.h"
#include "sim/rod/free_flight.h"

namespace impactdic::sim::shot {
namespace {

constexpr double kLeastNoise_m = 1e-9;
constexpr int kFewestFlightFrames = 8;

// The track as `track` had it: lengths in the pixels of its table, times in frames.
class TrackImpact {
 public:
  TrackImpact(const MeasuredTrack& track, const ShotOptions& options)
      : track_(track), options_(options), unit_m_(track.metre_per_px) {}

  MeasuredShot run() {
    fill_rows();
    impact::ImpactOptions options;
    options.impact_is_expected = true;
    options.surface_angle_rad = options_.surface_angle_deg * kRadPerDeg;
    options.gravity = options_.gravity_m_s2 * track_.interval_s * track_.interval_s / unit_m_;
    options.inertia_factor = options_.body.inertia_factor();
    options.flight_frames = std::max(options_.flight_frames, kFewestFlightFrames);
    found_ = impact::analyse_impact(rows_, options);
    refuse();
    return shot();
  }

 private:
  void fill_rows();
  BodyPose pose(const TrackPose& placed) const;
  void refuse() const;
  MeasuredShot shot() const;
  void time(MeasuredShot& shot) const;

  Measured length(const Measured& m) const { return {m.value * unit_m_, m.sd * unit_m_}; }
  Measured duration(const Measured& m) const {
    return {m.value * track_.interval_s, m.sd * track_.interval_s};
  }
  Measured instant(const Measured& m) const {
    return {track_.time_s[0] + m.value * track_.interval_s, m.sd * track_.interval_s};
  }
  ShotFlight flight(const FlightMotion& m) const {
    const double speed = unit_m_ / track_.interval_s, rate = 1 / track_.interval_s;
    return {m.first,
            m.last,
            {m.vt.value * speed, m.vt.sd * speed},
            {m.vn.value * speed, m.vn.sd * speed},
            {m.spin.value * rate, m.spin.sd * rate}};
  }

  const MeasuredTrack& track_;
  const ShotOptions& options_;
  double unit_m_;
  std::vector<TrackRow> rows_;
  ImpactAnalysis found_;
};

// Where no deviation of a centre is stated, it is the scatter from frame to frame.
void TrackImpact::fill_rows() {
  const double scatter_px = std::max(rod::frame_noise(track_.x_m, kLeastNoise_m),
                                     rod::frame_noise(track_.y_m, kLeastNoise_m)) /
                            unit_m_;
  rows_.resize(track_.time_s.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    TrackRow& row = rows_[i];
    row.frame = static_cast<std::int64_t>(i);
    row.time_s = track_.time_s[i];
    row.circle_ok = std::isfinite(track_.x_m[i]) && std::isfinite(track_.y_m[i]);
    row.motion_ok = std::isfinite(track_.dx_m[i]) && std::isfinite(track_.dy_m[i]);
    row.r_px = options_.body.radius_m() / unit_m_;
    // Image axes have y down.
    row.cx_px = track_.x_m[i] / unit_m_, row.cy_px = -track_.y_m[i] / unit_m_;
    const double sd = track_.position_sd_m[i] / unit_m_;
    row.cx_sd_px = row.cy_sd_px = std::isnan(sd) ? scatter_px : sd;
    row.dx_px = track_.dx_m[i] / unit_m_, row.dy_px = -track_.dy_m[i] / unit_m_;
    row.dx_sd_px = row.dy_sd_px = track_.motion_sd_m[i] / unit_m_;
    row.rot_deg = track_.turn_rad[i] * kDegPerRad;
    row.rot_sd_deg = track_.turn_sd_rad[i] * kDegPerRad;
    if (i < track_.poses.size()) row.pose = pose(track_.poses[i]);
  }
}

BodyPose TrackImpact::pose(const TrackPose& placed) const {
  BodyPose pose;
  pose.ok = std::isfinite(placed.angle_rad);
  pose.x_px = placed.x_m / unit_m_, pose.y_px = -placed.y_m / unit_m_;
  pose.x_sd_px = pose.y_sd_px = placed.place_sd_m / unit_m_;
  pose.angle_rad = placed.angle_rad, pose.angle_sd_rad = placed.angle_sd_rad;
  pose.origin = placed.origin, pose.keyframe = placed.keyframe;
  return pose;
}

void TrackImpact::refuse() const {
  const auto fail = [&](const char* what, const char* hint) {
    throw FormatError(track_.file, -1, what, hint);
  };
  switch (found_.status) {
    case ImpactStatus::kNone:
      fail("the track shows no contact: the ball does not come to the surface and leave it again",
           "is the surface angle right?");
      break;
    case ImpactStatus::kWrongSide:
      fail("the track shows no contact on this side of the surface, but one on the other",
           "add 180 degrees to the surface angle");
      break;
    case ImpactStatus::kFlightTooShort:
      fail("the track shows fewer than 6 frames of free flight before or after the contact",
           "start the clip earlier or end it later");
      break;
    case ImpactStatus::kFound:
    case ImpactStatus::kNotResolved:
      break;
  }
  if (!std::isfinite(found_.turn.value) || !std::isfinite(found_.crossing_above_lowest.value)) {
    fail("too few frames show the contact", "a higher frame rate would");
  }
}

// The ends of a contact that is too short to be seen lie anywhere between flight and turn.
void TrackImpact::time(MeasuredShot& shot) const {
  if (found_.status == ImpactStatus::kFound) {
    shot.contact_start_s = instant(found_.start.instant);
    shot.contact_end_s = instant(found_.end.instant);
    shot.contact_s = duration(found_.duration);
    return;
  }
  const auto between = [](double a, double b) {
    return Measured{(a + b) / 2, std::abs(b - a) / std::sqrt(12.0)};
  };
  const double turn = found_.turn.value;
  const Measured start = between(static_cast<double>(found_.before.last), turn);
  const Measured end = between(turn, static_cast<double>(found_.after.first));
  shot.contact_start_s = instant(start);
  shot.contact_end_s = instant(end);
  shot.contact_s = duration({end.value - start.value, std::hypot(start.sd, end.sd)});
}

MeasuredShot TrackImpact::shot() const {
  MeasuredShot shot;
  shot.file = track_.file;
  shot.surface_angle_deg = options_.surface_angle_deg;
  shot.before = flight(found_.before), shot.after = flight(found_.after);
  time(shot);
  shot.t_max_compression_s = instant(found_.turn).value - shot.contact_start_s.value;
  shot.max_deflection_m = length(found_.max_deflection);
  shot.touch_x_m = found_.touch_x * unit_m_, shot.touch_y_m = found_.touch_y * unit_m_;
  std::vector<double> stated;
  for (const TrackRow& row : rows_) {
    if (row.circle_ok) stated.push_back(row.cx_sd_px);
  }
  shot.noise_m = found_.position_scatter * median(std::move(stated)) * unit_m_;
  shot.restitution = {found_.restitution.value, found_.restitution.sd};
  shot.friction = {found_.friction_published.value, found_.friction.value,
                   found_.rolling_cap.value};
  shot.friction_sd = found_.friction.sd;
  shot.crossing_s = instant(found_.crossing).value;
  shot.crossing_above_lowest_m = length(found_.crossing_above_lowest);
  return shot;
}

// The velocity at an instant that is known to `sd_s` instead of `old_sd_s`.
double moved_sd(double sd, double pull, double old_sd_s, double sd_s) {
  return std::sqrt(std::max(0.0, sd * sd - std::pow(pull * old_sd_s, 2)) +
                   std::pow(pull * sd_s, 2));
}

}  // namespace

void derive(MeasuredShot& shot, const ImpactBody& body, double gravity_m_s2) {
  const Measured in = shot.before.vn_m_s, out = shot.after.vn_m_s;
  const double e = impact::restitution(in.value, out.value);
  shot.restitution = {e, std::hypot(out.sd, e * in.sd) / std::abs(in.value)};
  const auto state = [](const ShotFlight& flight) {
    BodyState s;
    s.vt_m_s = flight.vt_m_s.value, s.vn_m_s = flight.vn_m_s.value;
    if (!std::isnan(flight.omega_rad_s.value)) s.omega_rad_s = flight.omega_rad_s.value;
    return s;
  };
  const BodyState before = state(shot.before);
  shot.friction = contact::effective_friction(body, before, state(shot.after), shot.contact_s.value,
                                              gravity_m_s2, shot.surface_angle_deg);
  shot.friction_sd = std::hypot(shot.before.vt_m_s.sd, shot.after.vt_m_s.sd,
                                shot.friction.sound * std::hypot(in.sd, out.sd)) /
                     (out.value - in.value);
}

void move_contact(MeasuredShot& shot, const Measured& start_s, const Measured& duration_s,
                  const ImpactBody& body, double gravity_m_s2) {
  const double angle = shot.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  const double later = start_s.value - shot.contact_start_s.value;
  const double vt = shot.before.vt_m_s.value, vn = shot.before.vn_m_s.value;
  const double fall_t = -gravity_m_s2 * s * later, fall_n = -gravity_m_s2 * c * later;
  const double along_t = (vt + fall_t / 2) * later, along_n = (vn + fall_n / 2) * later;
  shot.touch_x_m += c * along_t - s * along_n;
  shot.touch_y_m += s * along_t + c * along_n;
  shot.before.vt_m_s.value += fall_t;
  shot.before.vn_m_s.value += fall_n;
  const double after = start_s.value + duration_s.value - shot.contact_end_s.value;
  shot.after.vt_m_s.value -= gravity_m_s2 * s * after;
  shot.after.vn_m_s.value -= gravity_m_s2 * c * after;
  const Measured end = {start_s.value + duration_s.value, std::max(start_s.sd, duration_s.sd)};
  const auto move = [&](Measured& velocity, double pull, double old_sd_s, double sd_s) {
    velocity.sd = moved_sd(velocity.sd, pull, old_sd_s, sd_s);
  };
  move(shot.before.vt_m_s, gravity_m_s2 * s, shot.contact_start_s.sd, start_s.sd);
  move(shot.before.vn_m_s, gravity_m_s2 * c, shot.contact_start_s.sd, start_s.sd);
  move(shot.after.vt_m_s, gravity_m_s2 * s, shot.contact_end_s.sd, end.sd);
  move(shot.after.vn_m_s, gravity_m_s2 * c, shot.contact_end_s.sd, end.sd);
  shot.contact_start_s = start_s;
  shot.contact_s = duration_s;
  shot.contact_end_s = end;
  shot.t_max_compression_s -= later;
  shot.max_deflection_m = {shot.max_deflection_m.value + along_n, std::abs(vn) * start_s.sd};
  derive(shot, body, gravity_m_s2);
}

MeasuredShot measure_shot(const MeasuredTrack& track, const ShotOptions& options) {
  return TrackImpact(track, options).run();
}

}  // namespace impactdic::sim::shot
