// Impacts that leave the plane of t and n, and impacts of two balls.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "sim/contact/impact.h"
#include "sim/contact/motion.h"
#include "sim/job/source_jobs.h"
#include "tests/support/random_shots.h"

namespace impactdic {
namespace {

using sim::contact::simulate_impact;
using support::RandomShots;

constexpr double kDegree = 3.14159265358979323846 / 180;

// The same impact seen in axes that are turned about the normal.
ImpactJob turned(ImpactJob job, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const InitialMotion m = job.initial;
  job.initial.vt_m_s = c * m.vt_m_s, job.initial.vb_m_s = -s * m.vt_m_s;
  job.initial.omega_rad_s = c * m.omega_rad_s, job.initial.omega_t_rad_s = s * m.omega_rad_s;
  return job;
}

TEST(SpaceImpact, APlaneShotSeenFromElsewhereIsTheSameShot) {
  RandomShots shots(71);
  for (const auto& laws : support::kSoundLaws) {
    for (int i = 0; i < 10; ++i) {
      ImpactJob job = shots.next(laws);
      job.gravity_m_s2 = 0;
      const double angle = shots.between(-3, 3), c = std::cos(angle), s = std::sin(angle);
      ImpactJob aside = turned(job, angle);
      aside.initial.omega_n_rad_s = 17;
      const ImpactResult a = simulate_impact(job), b = simulate_impact(aside);
      const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s);
      const double spin = speed / job.body.radius_m();
      EXPECT_NEAR(b.final.vt_m_s, c * a.final.vt_m_s, 3e-9 * speed);
      EXPECT_NEAR(b.final.vb_m_s, -s * a.final.vt_m_s, 3e-9 * speed);
      EXPECT_NEAR(b.final.vn_m_s, a.final.vn_m_s, 3e-9 * speed);
      EXPECT_NEAR(b.final.omega_rad_s, c * a.final.omega_rad_s, 3e-9 * spin);
      EXPECT_NEAR(b.final.omega_t_rad_s, s * a.final.omega_rad_s, 3e-9 * spin);
      EXPECT_EQ(b.final.omega_n_rad_s, 17);
      ASSERT_EQ(b.separated, a.separated);
      if (a.separated) {
        EXPECT_NEAR(b.contact_s, a.contact_s, 1e-8 * a.contact_s);
      }
    }
  }
}

// Where nothing slips across, nothing changes there.
TEST(SpaceImpact, RollingAcrossGoesOn) {
  ImpactJob job = sim::job::wood_sound_job();
  const ImpactResult plane = simulate_impact(job);
  job.initial.vb_m_s = 0.8;
  job.initial.omega_t_rad_s = 0.8 / job.body.radius_m();
  const ImpactResult space = simulate_impact(job);
  EXPECT_EQ(space.final.vb_m_s, job.initial.vb_m_s);
  EXPECT_EQ(space.final.omega_t_rad_s, job.initial.omega_t_rad_s);
  EXPECT_NEAR(space.final.vt_m_s, plane.final.vt_m_s, 1e-9);
  EXPECT_NEAR(space.final.omega_rad_s, plane.final.omega_rad_s, 1e-7);
}

TEST(SpaceImpact, RandomShotsBreakNoLaw) {
  RandomShots shots(72);
  double seconds = 0;
  for (const auto& laws : support::kSoundLaws) {
    for (int i = 0; i < 100; ++i) {
      const ImpactJob job = shots.next_in_space(laws);
      EXPECT_EQ(support::broken_law(job, seconds), "")
          << name_of(laws.first) << " " << name_of(laws.second) << " " << i;
    }
  }
}

// m v' = F + G, with F = -mu P v_tip/|v_tip|, by the classic Runge-Kutta method with fixed steps.
struct Ball {
  double vt, vb, vn, omega, omega_t, depth;
};
Ball integrate_alone(const ImpactJob& job, double until_s, int steps) {
  const double m = job.body.mass_kg, r = job.body.radius_m(), inertia = job.body.inertia();
  const double angle = job.surface_angle_deg * kDegree;
  const double gt = -9.81 * std::sin(angle), gn = -9.81 * std::cos(angle);
  using State = std::array<double, 6>;  // vt, vb, vn, omega, omega_t, depth
  const auto rates = [&](const State& x) -> State {
    const double p = x[5] > 0 ? job.contact.stiffness * std::pow(x[5], 1.5) : 0;
    const double tip_t = x[0] + r * x[3], tip_b = x[1] - r * x[4];
    const double speed = std::hypot(tip_t, tip_b);
    const double ft = -job.contact.friction_kinetic * p * tip_t / speed;
    const double fb = -job.contact.friction_kinetic * p * tip_b / speed;
    return {ft / m + gt, fb / m, p / m + gn, r * ft / inertia, -r * fb / inertia, -x[2]};
  };
  const InitialMotion& i = job.initial;
  State x{i.vt_m_s, i.vb_m_s, i.vn_m_s, i.omega_rad_s, i.omega_t_rad_s, 0};
  const double h = until_s / steps;
  const auto moved = [](State a, const State& d, double by) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += by * d[k];
    return a;
  };
  for (int step = 0; step < steps; ++step) {
    const State a = rates(x), b = rates(moved(x, a, h / 2)), c = rates(moved(x, b, h / 2)),
                d = rates(moved(x, c, h));
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {x[0], x[1], x[2], x[3], x[4], x[5]};
}

ImpactJob slope_shot(double friction) {
  ImpactJob job = sim::job::wood_sound_job();
  job.friction = FrictionModel::kCoulomb;
  job.contact.damping_n_s_per_m = 0;
  job.contact.friction_kinetic = friction;
  job.surface_angle_deg = 40;
  job.initial = {-0.02, -1.5, 1.3};
  job.initial.vb_m_s = 0.3;
  job.initial.omega_t_rad_s = -4;
  job.initial.omega_n_rad_s = 20;
  return job;
}

TEST(SpaceImpact, TheWeightTurnsTheSlip) {
  // So little friction never stops the slip.
  const ImpactJob job = slope_shot(0.03);
  const ImpactResult r = simulate_impact(job);
  const Ball ball = integrate_alone(job, r.contact_s, 20000);
  EXPECT_NEAR(r.final.vt_m_s, ball.vt, 1e-9);
  EXPECT_NEAR(r.final.vb_m_s, ball.vb, 1e-9);
  EXPECT_NEAR(r.final.vn_m_s, ball.vn, 1e-8);
  EXPECT_NEAR(r.final.omega_rad_s, ball.omega, 1e-7);
  EXPECT_NEAR(r.final.omega_t_rad_s, ball.omega_t, 1e-7);
  const double before = std::atan2(r.tip_vb_start_m_s, r.tip_vt_start_m_s);
  const double after = std::atan2(r.tip_vb_final_m_s, r.tip_vt_final_m_s);
  EXPECT_GT(std::abs(after - before), 5 * kDegree);
  EXPECT_EQ(r.phases.size(), 3U);  // compression, restitution, sliding
}

// It stops in the middle of the contact; what is left of it then runs down the slope.
TEST(SpaceImpact, ATurningSlipStops) {
  const ImpactJob job = slope_shot(0.4);
  const ImpactResult r = simulate_impact(job);
  const Ball ball = integrate_alone(job, r.contact_s, 200000);
  // The fixed steps chatter about the rest.
  EXPECT_NEAR(r.final.vb_m_s, ball.vb, 1e-5);
  EXPECT_NEAR(r.final.omega_t_rad_s, ball.omega_t, 1e-3);
  EXPECT_NEAR(r.tip_vb_final_m_s, 0, 1e-8);
  ASSERT_GE(r.phases.size(), 3U);
  EXPECT_LE(std::abs(r.energy.residual_j), 1e-9 * r.energy.kinetic_start_j);
}

TEST(SpaceImpact, OrientationIsTheIntegralOfTheSpin) {
  ImpactJob job = slope_shot(0.3);
  job.initial.omega_rad_s = 250, job.initial.omega_t_rad_s = -180, job.initial.omega_n_rad_s = 120;
  job.initial.gap_m = 0.001;
  std::vector<double> times;
  constexpr int kSteps = 40000;
  const double end = 0.012;
  for (int i = 0; i <= 2 * kSteps; ++i) times.push_back(end * i / (2 * kSteps));
  const auto path = simulate_impact(job, {.times_s = times}).trajectory;
  // A product of small turns about the spin in the middle of each.
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i + 2 < path.size(); i += 2) {
    const BodyState& s = path[i + 1].state;
    const Eigen::Vector3d w(s.omega_t_rad_s, s.omega_n_rad_s, s.omega_rad_s);
    q = Eigen::Quaterniond(Eigen::AngleAxisd(w.norm() * end / kSteps, w.normalized())) * q;
  }
  const Quaternion& o = path.back().state.orientation;
  EXPECT_LT(q.angularDistance(Eigen::Quaterniond(o.w, o.x, o.y, o.z)), 1e-7);
  // The spin has changed its axis, so that angles do not add up.
  const double sum = path.back().state.angle_rad;
  EXPECT_GT(q.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(sum, Eigen::Vector3d::UnitZ()))),
            0.1);
}

TEST(SpaceImpact, FramesShowTheOrientationInTheCamerasAxes) {
  ImpactJob job = sim::job::wood_sound_job();
  job.gravity_m_s2 = 0;
  const auto plane = sim::contact::simulate_motion(job, 10000, 60, 20);
  job.initial.omega_n_rad_s = 1e-12;  // the same shot, by way of quaternions
  const auto space = sim::contact::simulate_motion(job, 10000, 60, 20);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    EXPECT_NEAR(2 * std::atan2(space[i].orientation.z, space[i].orientation.w), plane[i].angle_rad,
                1e-9);
    EXPECT_NEAR(space[i].orientation.x, 0, 1e-9);
  }
  // A spin about the normal, which leans with the surface.
  job.initial.omega_n_rad_s = 100;
  job.initial.omega_rad_s = 0, job.contact.friction_kinetic = 0.01;
  const auto leaning = sim::contact::simulate_motion(job, 10000, 15, 20);
  const Quaternion& q = leaning.back().orientation;
  EXPECT_NEAR(std::atan2(-q.x, q.y), job.surface_angle_deg * kDegree, 1e-6);
}

TEST(SpaceImpact, WhatTheLawsDoNotKnowIsSaid) {
  ImpactJob job = sim::job::wood_sound_job();
  job.initial.vb_m_s = 1;
  EXPECT_THROW(simulate_impact(job), InvalidArgument);  // springs and a slope
  job.friction = FrictionModel::kBrody;
  EXPECT_NO_THROW(simulate_impact(job));
  job.preset = ModelPreset::kPublished;
  EXPECT_THROW(simulate_impact(job), InvalidArgument);
}

ImpactJob two_balls() {
  ImpactJob job = sim::job::wood_sound_job();
  job.friction = FrictionModel::kCoulomb;
  job.surface_angle_deg = 20;
  job.initial = {0.9, -1.1, 40};
  job.initial.vb_m_s = -0.4, job.initial.omega_t_rad_s = 25, job.initial.omega_n_rad_s = 8;
  OtherBody other;
  other.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  other.initial = {-0.5, 0.7, -30};
  other.initial.vb_m_s = 0.3, other.initial.omega_n_rad_s = -11;
  job.other = other;
  return job;
}

TEST(TwoBalls, MomentumIsKept) {
  const ImpactJob job = two_balls();
  const ImpactResult r = simulate_impact(job);
  const double m1 = job.body.mass_kg, m2 = job.other->body.mass_kg;
  const double fall = 9.81 * r.contact_s, angle = 20 * kDegree;
  const auto sum = [&](double a, double b) { return m1 * a + m2 * b; };
  EXPECT_NEAR(sum(r.final.vt_m_s, r.other_final.vt_m_s),
              sum(0.9, -0.5) - (m1 + m2) * fall * std::sin(angle), 1e-12);
  EXPECT_NEAR(sum(r.final.vn_m_s, r.other_final.vn_m_s),
              sum(-1.1, 0.7) - (m1 + m2) * fall * std::cos(angle), 1e-12);
  EXPECT_NEAR(sum(r.final.vb_m_s, r.other_final.vb_m_s), sum(-0.4, 0.3), 1e-12);
  // The moment of the tangential impulse spins both the same way round.
  const auto spun = [](const ImpactBody& b, double domega) {
    return b.inertia() * domega / b.radius_m();
  };
  EXPECT_NEAR(spun(job.body, r.final.omega_rad_s - 40),
              spun(job.other->body, r.other_final.omega_rad_s + 30), 1e-12);
  EXPECT_NEAR(spun(job.body, r.final.omega_rad_s - 40), r.impulse_t_n_s, 1e-12);
  EXPECT_LE(std::abs(r.energy.residual_j), 1e-9 * r.energy.kinetic_start_j);
  EXPECT_GT(r.energy.slip_j, 0);
}

// Elastic and smooth, of equal masses: they exchange what they have along the normal.
TEST(TwoBalls, EqualBallsExchangeTheirVelocities) {
  ImpactJob job = two_balls();
  job.other->body = job.body;
  job.friction = FrictionModel::kNone;
  job.contact.damping_n_s_per_m = 0;
  job.gravity_m_s2 = 0;
  const ImpactResult r = simulate_impact(job);
  EXPECT_NEAR(r.final.vn_m_s, 0.7, 1e-9);
  EXPECT_NEAR(r.other_final.vn_m_s, -1.1, 1e-9);
  EXPECT_EQ(r.final.vt_m_s, 0.9);
  EXPECT_EQ(r.other_final.omega_n_rad_s, -11);
}

// Against a ball of a million times its mass and radius it is a wall.
TEST(TwoBalls, AHugeBallIsASurface) {
  for (const FrictionModel friction : {FrictionModel::kCoulomb, FrictionModel::kMawBarberFawcett}) {
    ImpactJob job = two_balls();
    job.friction = friction;
    job.gravity_m_s2 = 0;
    job.other->body = {BodyShape::kSolidSphere, 0.1e7, 0.06e7};
    job.other->initial = {};
    const ImpactResult two = simulate_impact(job);
    job.other.reset();
    const ImpactResult one = simulate_impact(job);
    EXPECT_NEAR(two.final.vt_m_s, one.final.vt_m_s, 1e-6);
    EXPECT_NEAR(two.final.vn_m_s, one.final.vn_m_s, 1e-6);
    EXPECT_NEAR(two.final.vb_m_s, one.final.vb_m_s, 1e-6);
    EXPECT_NEAR(two.final.omega_t_rad_s, one.final.omega_t_rad_s, 1e-4);
    EXPECT_NEAR(two.contact_s, one.contact_s, 1e-6 * one.contact_s);
  }
}

}  // namespace
}  // namespace impactdic
