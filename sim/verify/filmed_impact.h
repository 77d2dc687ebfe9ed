// Tracked rows of an integrated impact, with noise of a known deviation, and the truth about it:
// what `verify` and the tests analyse.
#pragma once

#include <impactdic/track.h>
#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "sim/contact/impact.h"

namespace impactdic::sim::verify {

struct FilmedImpact {
  ImpactJob job;
  double fps = 10000, metre_per_px = 0.29e-3;
  int frames_before = 110, frames = 300;
  double touch = 0.37;             // part of a frame that the touch comes after frames_before
  double step_noise_m_s = 0.0015;  // each axis
  double spin_noise_rad_s = 0.06;
  double position_noise_px = 0.005;
  unsigned seed = 1;
  bool with_motion = true;

  double speed(double m_s) const { return m_s / (metre_per_px * fps); }  // px/frame
};

// The tennis ball on a racket and the lacrosse ball on a wooden flat of the dissertation
// (chapters 3 and 4).
inline FilmedImpact tennis_on_racket() {
  FilmedImpact f;
  f.job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  f.job.contact.stiffness = 13385;
  f.job.contact.damping_n_s_per_m = 5.36;
  f.job.contact.friction_kinetic = 0.0335;
  f.job.surface_angle_deg = 15;
  f.job.initial.vt_m_s = -0.5176;
  f.job.initial.vn_m_s = -1.9319;
  return f;
}

inline FilmedImpact lacrosse_on_wood() {
  FilmedImpact f;
  f.job.normal = NormalModel::kHertzDamper;
  f.job.friction = FrictionModel::kCoulomb;
  f.job.body = {BodyShape::kSolidSphere, 0.14566, 0.06325};
  f.job.contact.stiffness = 875000;
  f.job.contact.damping_n_s_per_m = 18;
  f.job.contact.friction_kinetic = 0.1;
  f.job.surface_angle_deg = 20;
  f.job.initial.vt_m_s = -0.57;
  f.job.initial.vn_m_s = -1.69;
  return f;
}

struct FilmedTruth {
  double start, turn, end;  // frames
  BodyState before, after;
  double deflection_px, restitution, friction, rolling_cap;
  double slip_t_m_s, slip_b_m_s, friction_t, friction_b;  // impulse ratios, gravity taken off
};

// The rotation vector from one orientation to the next, local axes t, n, b.
inline Eigen::Vector3d turn_between(const Quaternion& from, const Quaternion& to) {
  const Eigen::Quaterniond a(from.w, from.x, from.y, from.z), b(to.w, to.x, to.y, to.z);
  const Eigen::AngleAxisd turn(b * a.conjugate());
  return turn.angle() * turn.axis();
}

inline FilmedTruth film(const FilmedImpact& f, std::vector<TrackRow>& rows) {
  std::vector<double> times;
  for (int i = 0; i < f.frames; ++i) times.push_back((i - f.frames_before - f.touch) / f.fps);
  const ImpactResult impact = contact::simulate_impact(f.job, {0, times});
  const double angle = f.job.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  std::mt19937_64 random(f.seed);
  std::normal_distribution<double> noise(0, 1);
  const double step_sd = f.speed(f.step_noise_m_s), turn_sd = f.spin_noise_rad_s / f.fps;
  const auto x_px = [&](const BodyState& p) { return (c * p.qt_m - s * p.qn_m) / f.metre_per_px; };
  const auto y_px = [&](const BodyState& p) { return -(s * p.qt_m + c * p.qn_m) / f.metre_per_px; };
  rows.assign(static_cast<std::size_t>(f.frames), {});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    const BodyState& here = impact.trajectory[i].state;
    row.frame = static_cast<std::int64_t>(i);
    row.time_s = static_cast<double>(i) / f.fps;
    row.status = TrackStatus::kOk;
    row.circle_ok = true;
    row.cx_px = 256 + x_px(here) + f.position_noise_px * noise(random);
    row.cy_px = 300 + y_px(here) + f.position_noise_px * noise(random);
    row.r_px = f.job.body.radius_m() / f.metre_per_px;
    row.cx_sd_px = row.cy_sd_px = row.r_sd_px = f.position_noise_px;
    if (!f.with_motion || i + 1 == rows.size()) continue;
    const BodyState& next = impact.trajectory[i + 1].state;
    row.motion_ok = true;
    row.dx_px = x_px(next) - x_px(here) + step_sd * noise(random);
    row.dy_px = y_px(next) - y_px(here) + step_sd * noise(random);
    row.rot_deg = (next.angle_rad - here.angle_rad + turn_sd * noise(random)) * kDegPerRad;
    if (!f.job.initial.plane()) {
      const Eigen::Vector3d turn = turn_between(here.orientation, next.orientation);
      row.rot_deg = (turn.z() + turn_sd * noise(random)) * kDegPerRad;
      row.rot_x_deg = (c * turn.x() - s * turn.y() + 3 * turn_sd * noise(random)) * kDegPerRad;
      row.rot_y_deg = (s * turn.x() + c * turn.y() + 3 * turn_sd * noise(random)) * kDegPerRad;
      row.rot_x_sd_deg = row.rot_y_sd_deg = 3 * turn_sd * kDegPerRad;
      row.dx_rot_y_corr = row.dy_rot_x_corr = 0;
    }
    row.dx_sd_px = row.dy_sd_px = step_sd;
    row.rot_sd_deg = turn_sd * kDegPerRad;
    row.windows = 200;
  }
  FilmedTruth truth;
  truth.start = f.frames_before + f.touch;
  truth.turn = truth.start + impact.t_max_compression_s * f.fps;
  truth.end = truth.start + impact.contact_s * f.fps;
  truth.before = impact.start;
  truth.after = impact.final;
  truth.deflection_px = impact.max_deflection_m / f.metre_per_px;
  truth.restitution = -impact.final.vn_m_s / impact.start.vn_m_s;
  // An impulse ratio: less than the coefficient of friction where the ball stops slipping.
  const EffectiveFriction friction =
      contact::effective_friction(f.job.body, impact.start, impact.final, impact.contact_s,
                                  f.job.gravity_m_s2, f.job.surface_angle_deg);
  truth.friction = std::abs(friction.sound);
  truth.rolling_cap = friction.rolling_cap;
  truth.slip_t_m_s = impact.tip_vt_start_m_s, truth.slip_b_m_s = impact.tip_vb_start_m_s;
  truth.friction_t = impact.impulse_t_n_s / impact.impulse_n_n_s;
  truth.friction_b = impact.impulse_b_n_s / impact.impulse_n_n_s;
  return truth;
}

}  // namespace impactdic::sim::verify
