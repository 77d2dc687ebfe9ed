// Rolling and spinning friction of a ball in contact.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/simulate.h>

#include <cmath>
#include <numbers>

#include "sim/contact/impact.h"
#include "tests/support/impacts/derivative_check.h"

namespace impactdic {
namespace {

using sim::contact::simulate_impact;

ImpactJob ball(FrictionModel friction) {
  ImpactJob job;
  job.normal = NormalModel::kHertzDamper;
  job.friction = friction;
  job.body = {BodyShape::kSolidSphere, 0.1, 0.05};
  job.contact.stiffness = 1e6;
  job.contact.friction_kinetic = 0.2;
  job.contact.poisson = 0.3;
  job.initial = {3, -2, 0};
  job.gravity_m_s2 = 0;
  return job;
}

void expect_closed(const ImpactResult& result) {
  EXPECT_TRUE(result.separated);
  EXPECT_LE(std::abs(result.energy.residual_j), 1e-9 * result.energy.kinetic_start_j);
}

// Without friction the couple alone brakes the spin: I dw = mu_r R 2 m v_n.
TEST(TurningResistance, RollingTakesItsShareOfTheBlow) {
  ImpactJob job = ball(FrictionModel::kNone);
  job.contact.rolling_friction = 0.01;
  job.initial.omega_rad_s = -300;
  const ImpactResult result = simulate_impact(job);
  const double braked = 0.01 * 0.025 * 2 * 0.1 * 2 / job.body.inertia();
  // w_0 is 0.144 rad/s: 1.2e-7 of the couple.
  EXPECT_NEAR(result.final.omega_rad_s, -300 + braked, 1e-6 * braked);
  const double taken = 0.5 * job.body.inertia() * (300 * 300 - std::pow(300 - braked, 2));
  EXPECT_NEAR(result.energy.slip_j, taken, 1e-6 * taken);
  expect_closed(result);
}

// Of Hertz's impact the integral of a P is 2 k sqrt(R) delta_m^3/v times that of s^2/sqrt(1 -
// s^2.5), 0.4 B(1.2, 0.5); delta_m = (5 m v^2/(4 k))^0.4.
TEST(TurningResistance, SpinningTakesWhatItsFormulaSays) {
  ImpactJob job = ball(FrictionModel::kNone);
  job.contact.spinning_friction = 0.3;
  job.initial.omega_n_rad_s = 500;
  const double deepest = std::pow(5 * 0.1 * 4 / (4 * 1e6), 0.4);
  const double integral =
      2 * 1e6 * std::sqrt(0.025) * std::pow(deepest, 3) / 2 * 0.4 * std::beta(1.2, 0.5);
  const double braked = 3 * std::numbers::pi / 16 * 0.3 * integral / job.body.inertia();
  const ImpactResult result = simulate_impact(job);
  EXPECT_GT(braked, 1);
  EXPECT_NEAR(result.final.omega_n_rad_s, 500 - braked, 1e-6 * braked);
  expect_closed(result);
}

// A surface has no direction of its own: the same shot in a plane turned by 30 degrees.
TEST(TurningResistance, IsAlikeInAllDirections) {
  ImpactJob plane = ball(FrictionModel::kCoulomb);
  plane.contact.rolling_friction = 0.05;
  plane.contact.spinning_friction = 0.2;
  const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
  for (const double vt : {0.5, 3.0}) {
    plane.initial.vt_m_s = vt, plane.initial.omega_rad_s = -10;
    ImpactJob turned = plane;
    turned.initial.vt_m_s = c * vt, turned.initial.vb_m_s = s * vt;
    turned.initial.omega_rad_s = c * -10, turned.initial.omega_t_rad_s = s * 10;
    const BodyState a = simulate_impact(plane).final, b = simulate_impact(turned).final;
    EXPECT_NEAR(b.vt_m_s, c * a.vt_m_s, 1e-8);
    EXPECT_NEAR(b.vb_m_s, s * a.vt_m_s, 1e-8);
    EXPECT_NEAR(b.omega_rad_s, c * a.omega_rad_s, 1e-6);
    EXPECT_NEAR(b.omega_t_rad_s, -s * a.omega_rad_s, 1e-6);
  }
}

// The contact point rests from the start, and no slip says along which line friction must hold it.
TEST(TurningResistance, HoldsWhatRollsFromTheStartInAnyDirection) {
  ImpactJob along = ball(FrictionModel::kCoulomb);
  along.contact.rolling_friction = 0.05;
  along.initial.vt_m_s = 2, along.initial.omega_rad_s = -80;
  ImpactJob across = along;
  across.initial.vt_m_s = across.initial.omega_rad_s = 0;
  across.initial.vb_m_s = 2, across.initial.omega_t_rad_s = 80;
  const BodyState a = simulate_impact(along).final, b = simulate_impact(across).final;
  EXPECT_LT(a.vt_m_s, 1.99);
  EXPECT_NEAR(b.vb_m_s, a.vt_m_s, 1e-8);
  EXPECT_NEAR(b.omega_t_rad_s, -a.omega_rad_s, 1e-6);
}

// What stops stays: a couple that could turn the ball back does not.
TEST(TurningResistance, StopsAndDoesNotTurnBack) {
  ImpactJob job = ball(FrictionModel::kNone);
  job.contact.rolling_friction = 1;
  job.contact.spinning_friction = 20;
  job.initial.omega_rad_s = -20, job.initial.omega_n_rad_s = 3;
  const ImpactResult result = simulate_impact(job);
  EXPECT_NEAR(result.final.omega_rad_s, 0, 0.02);
  EXPECT_LE(result.final.omega_rad_s, 0);
  EXPECT_NEAR(result.final.omega_n_rad_s, 0, 0.05);
  EXPECT_GE(result.final.omega_n_rad_s, 0);
  expect_closed(result);
}

TEST(TurningResistance, ClosesTheLedgerAndHasDerivatives) {
  for (const FrictionModel law :
       {FrictionModel::kCoulomb, FrictionModel::kThreePhase, FrictionModel::kMawBarberFawcett,
        FrictionModel::kTangentialSpring}) {
    ImpactJob job = ball(law);
    job.contact.friction_static = 0.3;
    job.contact.tangential_stiffness_n_per_m = 1e5;
    job.contact.rolling_friction = 0.03;
    job.contact.spinning_friction = 0.2;
    for (const double vt : {0.3, 4.0}) {
      job.initial = {vt, -2, 15};
      job.initial.omega_n_rad_s = 0;
      expect_closed(simulate_impact(job));
      const support::DerivativeError error = support::derivative_error(job, 1e-9, 0, 2);
      EXPECT_LT(error.worst, 1e-8) << name_of(law) << " " << vt << ": " << error.where;
      EXPECT_GT(error.compared, 50);
    }
  }
  ImpactJob space = ball(FrictionModel::kCoulomb);
  space.contact.rolling_friction = 0.03;
  space.contact.spinning_friction = 0.2;
  space.initial.vb_m_s = 0.7, space.initial.omega_t_rad_s = 20, space.initial.omega_n_rad_s = 90;
  expect_closed(simulate_impact(space));
  const support::DerivativeError error = support::derivative_error(space, 1e-9, 1, 2);
  EXPECT_LT(error.worst, 1e-8) << error.where;
  EXPECT_GT(error.compared, 50);
}

TEST(TurningResistance, IsRefusedWhereItIsNotKnown) {
  const auto refused = [](const ImpactJob& job) {
    EXPECT_THROW(simulate_impact(job), InvalidArgument);
  };
  ImpactJob job = ball(FrictionModel::kMawBarberFawcett);
  job.contact.rolling_friction = 0.1;
  job.initial.vb_m_s = 1;
  refused(job);
  job = ball(FrictionModel::kCoulomb);
  job.contact.spinning_friction = -1;
  refused(job);
  job.contact.spinning_friction = 0.1;
  job.other = OtherBody{{BodyShape::kHollowSphere, 0.05, 0.03}, {-0.4, 0.3, 7}};
  refused(job);
  job = ball(FrictionModel::kCoulomb);
  job.body = {BodyShape::kRod, 0.5784, 0.0127, 0.3};
  job.initial.angle_deg = 45;
  job.contact.rolling_friction = 0.1;
  refused(job);
}

}  // namespace
}  // namespace impactdic
