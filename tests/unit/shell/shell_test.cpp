// A ball that is a shell, in series with its surface.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/simulate.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "sim/contact/impact.h"
#include "sim/fit/calibration.h"
#include "sim/job/job_toml.h"
#include "tests/support/impacts/derivative_check.h"
#include "tests/support/scratch.h"
#include "tests/support/synthetic_track.h"

namespace impactdic {
namespace {

using sim::contact::simulate_impact;

// A tennis ball on a string bed.
ImpactJob tennis(double bed, double shell, double flat) {
  ImpactJob job;
  job.normal = NormalModel::kLinearSpringDamper;
  job.friction = FrictionModel::kNone;
  job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  job.contact.stiffness = bed;
  job.shell = BallShell{shell, 0, flat};
  job.initial.vn_m_s = -10;
  job.gravity_m_s2 = 0;
  return job;
}

// The two masses one by one, in small steps of the classical Runge-Kutta method (y and q: of the
// part in contact and of the rest, into the surface), until the ball has gone.
struct Masses {
  double last_touch_s = 0, velocity_m_s = 0, vibration_j = 0, squeezed_m = 0;
};

Masses followed(const ImpactJob& job) {
  using State = std::array<double, 4>;  // y, q and their rates
  const double flat = job.shell->flat_fraction * job.body.mass_kg;
  const double rest = job.body.mass_kg - flat, k = job.shell->stiffness_n_per_m;
  const auto force = [&](const State& s) { return s[0] > 0 ? job.contact.stiffness * s[0] : 0; };
  const auto rate = [&](const State& s) -> State {
    const double shell = k * (s[1] - s[0]) + job.shell->damping_n_s_per_m * (s[3] - s[2]);
    return {s[2], s[3], (shell - force(s)) / flat, -shell / rest};
  };
  const auto moved = [](State s, const State& r, double h) {
    for (std::size_t i = 0; i < s.size(); ++i) s[i] += h * r[i];
    return s;
  };
  const double fastest = std::sqrt((job.contact.stiffness + k) / flat);
  const double h = 2e-4 / fastest, speed = -job.initial.vn_m_s;
  State s{0, 0, speed, speed};
  Masses result;
  for (double t = 0;; t += h) {
    const State a = rate(s), b = rate(moved(s, a, h / 2)), c = rate(moved(s, b, h / 2)),
                d = rate(moved(s, c, h));
    const double before = s[0];
    for (std::size_t i = 0; i < s.size(); ++i) {
      s[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
    result.squeezed_m = std::max(result.squeezed_m, s[1] - s[0]);
    if (before > 0 && s[0] <= 0) {
      result.last_touch_s = t + h * before / (before - s[0]);
      result.velocity_m_s = -(flat * s[2] + rest * s[3]) / job.body.mass_kg;
      const double apart = s[3] - s[2], squeezed = s[1] - s[0];
      result.vibration_j =
          0.5 * k * squeezed * squeezed + 0.5 * flat * rest / job.body.mass_kg * apart * apart;
    }
    const double centre = (flat * s[0] + rest * s[1]) / job.body.mass_kg;
    if (t > 0 && s[0] < 0 && centre < -std::sqrt(2 * result.vibration_j / k)) return result;
  }
}

// Of hard surfaces the part in contact bounces before the ball has turned.
TEST(Shell, IsItsTwoMassesFollowedOneByOne) {
  int bounces = 0;
  for (const auto& [bed, shell, flat] : {std::array{35000.0, 25000.0, 0.2},
                                         {20000.0, 60000.0, 0.1},
                                         {4e5, 25000.0, 0.1},
                                         {3e6, 25000.0, 0.3}}) {
    const ImpactJob job = tennis(bed, shell, flat);
    const ImpactResult r = simulate_impact(job);
    const Masses masses = followed(job);
    ASSERT_TRUE(r.separated);
    EXPECT_NEAR(r.restitution * 10, masses.velocity_m_s, 1e-6) << bed;
    EXPECT_NEAR(r.contact_s, masses.last_touch_s, 1e-6 * r.contact_s) << bed;
    EXPECT_NEAR(r.energy.vibration_j, masses.vibration_j, 1e-6 * r.energy.kinetic_start_j);
    EXPECT_NEAR(r.max_flattening_m, masses.squeezed_m, 1e-6 * r.max_flattening_m);
    for (const ContactPhase& phase : r.phases) bounces += phase.kind == ContactPhaseKind::kFlight;
  }
  EXPECT_GT(bounces, 2);
}

ImpactJob random_shell(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  ImpactJob job =
      tennis(std::pow(10, between(3.5, 6)), std::pow(10, between(3.8, 5)), between(0.02, 0.5));
  const double reduced =
      job.shell->flat_fraction * (1 - job.shell->flat_fraction) * job.body.mass_kg;
  job.shell->damping_n_s_per_m =
      between(0, 0.3) * 2 * std::sqrt(job.shell->stiffness_n_per_m * reduced);
  job.contact.damping_n_s_per_m = between(0, 0.3) * std::sqrt(job.contact.stiffness * 0.0567);
  if (between(0, 1) < 0.3) job.contact.damping_n_s_per_m = job.shell->damping_n_s_per_m = 0;
  job.friction = between(0, 1) < 0.3 ? FrictionModel::kBrody : FrictionModel::kCoulomb;
  job.contact.friction_kinetic = between(0.05, 0.8);
  job.initial = {between(-20, 20), -between(2, 30), between(-300, 300)};
  job.initial.gap_m = between(0, 0.01);
  job.gravity_m_s2 = between(0, 1) < 0.5 ? 0 : 9.81;
  job.surface_angle_deg = between(-45, 45);
  return job;
}

TEST(Shell, LosesNoEnergyInItsLedger) {
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const ImpactJob job = random_shell(random);
    const ImpactResult r = simulate_impact(job);
    ASSERT_TRUE(r.separated) << i;
    EXPECT_LE(std::abs(r.energy.residual_j), 1e-9 * r.energy.kinetic_start_j) << i;
    EXPECT_GE(r.energy.slip_j, -1e-9 * r.energy.kinetic_start_j) << i;
    EXPECT_LE(r.restitution, 1.001) << i;
    EXPECT_LE(std::abs(r.impulse_t_n_s),
              (1 + 1e-8) * job.contact.friction_kinetic * r.impulse_n_n_s + 1e-9)
        << i;
  }
}

// Beyond the first bounce, too: the swing goes on in flight.
TEST(Shell, KeepsItsLedgerOverSeveralBounces) {
  ImpactJob job = tennis(35000, 25000, 0.2);
  job.initial.vn_m_s = -3;
  job.gravity_m_s2 = 9.81;
  job.shell->damping_n_s_per_m = 2;
  job.solver.contacts = 3;
  const ImpactResult r = simulate_impact(job, {.rate_hz = 5000});
  EXPECT_LE(std::abs(r.energy.residual_j), 1e-9 * r.energy.kinetic_start_j);
  EXPECT_GT(r.end_s, 0.5);
  for (const TrajectoryPoint& p : r.trajectory) {
    EXPECT_LE(std::abs(p.energy.residual_j), 1e-9 * r.energy.kinetic_start_j) << p.time_s;
  }
}

TEST(Shell, DerivativesMeetDifferences) {
  ImpactJob job = tennis(35000, 25000, 0.2);
  job.friction = FrictionModel::kCoulomb;
  job.contact.friction_kinetic = 0.2;
  job.contact.damping_n_s_per_m = 3;
  job.shell->damping_n_s_per_m = 2;
  job.gravity_m_s2 = 9.81;
  job.surface_angle_deg = 10;
  job.initial = {9, -10, 30};
  ImpactJob bouncing = job;
  bouncing.contact.stiffness = 4e5;
  for (const ImpactJob& one : {job, bouncing}) {
    const support::DerivativeError error = support::derivative_error(one, 1e-9);
    EXPECT_LT(error.worst, 1e-8) << error.where;
    EXPECT_GT(error.compared, 100);
  }
}

// The outline's way, and no more.
ShotFit fit_of(const ImpactJob& truth, const std::vector<FitParameter>& parameters, double noise_m,
               bool rivals = false) {
  testing::ScratchFolder folder;
  testing::SyntheticTrack track{truth};
  track.fps = 20000;
  track.frames_contact = 150;
  track.position_noise_m = track.stated_sd_m = noise_m;
  write_track(track, folder / "track.csv");
  FitRequest request;
  request.shots = {{folder / "track.csv", truth.surface_angle_deg}};
  request.impact = truth;
  request.parameters = parameters;
  request.rivals = rivals;
  request.threads = 1;
  return sim::fit::calibrate(request).shots[0];
}

// The inertia of the flattened part tells the springs apart, where it can be seen.
TEST(Shell, FitFindsBothStiffnesses) {
  ImpactJob truth = tennis(35000, 25000, 0.1);
  truth.contact.damping_n_s_per_m = 4;
  const ShotFit both = fit_of(
      truth, {FitParameter::kStiffness, FitParameter::kDamping, FitParameter::kShellStiffness},
      13e-6, true);
  for (const auto& [i, value] : {std::pair{0u, 35000.0}, {1u, 4.0}, {2u, 25000.0}}) {
    EXPECT_TRUE(both.parameters[i].determined) << both.parameters[i].key;
    EXPECT_NEAR(both.parameters[i].value, value, 4 * both.parameters[i].sd);
  }
  const DerivedFigure& series = both.derived.back();
  EXPECT_EQ(series.key, "series_stiffness_n_per_m");
  EXPECT_NEAR(series.value, 1 / (1 / 35000.0 + 1 / 25000.0), 4 * series.sd);
  ASSERT_EQ(both.rivals.size(), 2u);
  EXPECT_TRUE(both.rivals[0].shell);
}

// In the noise of a poor track two springs in series with little mass between them are one, and the
// fit says so; with one of them known it finds the other.
TEST(Shell, FitSaysWhatOneSpringCannotTell) {
  constexpr double kNoise_m = 1.5e-4;
  ImpactJob truth = tennis(35000, 25000, 0.002);
  truth.initial.vn_m_s = -3;
  truth.solver.relative_tolerance = 1e-7;
  const ShotFit both =
      fit_of(truth, {FitParameter::kStiffness, FitParameter::kShellStiffness}, kNoise_m, true);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_FALSE(both.parameters[i].determined) << both.parameters[i].value;
    EXPECT_NE(both.parameters[i].verdict.find("in series"), std::string::npos);
  }
  const DerivedFigure& series = both.derived.back();
  EXPECT_NEAR(series.value, 1 / (1 / 35000.0 + 1 / 25000.0), 4 * series.sd);
  EXPECT_LT(series.sd, 0.15 * series.value);
  EXPECT_TRUE(std::any_of(both.warnings.begin(), both.warnings.end(), [](const std::string& w) {
    return w.find("one spring describes the path as well") != std::string::npos;
  }));
  const ShotFit one = fit_of(truth, {FitParameter::kShellStiffness}, kNoise_m);
  EXPECT_TRUE(one.parameters[0].determined);
  EXPECT_NEAR(one.parameters[0].value, 25000, 4 * one.parameters[0].sd);
}

TEST(Shell, RefusesWhatItDoesNotKnow) {
  const auto where = [](const ImpactJob& job) -> std::string {
    try {
      job.validate();
    } catch (const InvalidArgument& error) {
      return error.where();
    }
    return "";
  };
  ImpactJob job = tennis(35000, 25000, 0.2);
  EXPECT_EQ(where(job), "");
  job.shell->flat_fraction = 1;
  EXPECT_EQ(where(job), "shell.flat_fraction");
  job = tennis(35000, 25000, 0.2);
  job.shell->damping_n_s_per_m = 1e3;
  EXPECT_EQ(where(job), "shell.damping_n_s_per_m");
  job = tennis(35000, 0, 0.2);
  EXPECT_EQ(where(job), "shell.stiffness_n_per_m");
  job = tennis(35000, 25000, 0.2);
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  EXPECT_EQ(where(job), "normal");
  job = tennis(35000, 25000, 0.2);
  job.air.drag_coefficient = 0.5;
  EXPECT_EQ(where(job), "air");
}

TEST(Shell, JobReadsBackAsItWasWritten) {
  testing::ScratchFolder folder;
  SimulateRequest request;
  request.impact = tennis(35000, 25000, 0.2);
  const std::string text = sim::job::to_toml(request);
  std::ofstream(folder / "job.toml") << text;
  const SimulateRequest read = sim::job::read_simulate_job(folder / "job.toml");
  EXPECT_EQ(sim::job::to_toml(read), text);
  ASSERT_TRUE(read.impact.shell);
  EXPECT_EQ(read.impact.shell->flat_fraction, 0.2);
}

}  // namespace
}  // namespace impactdic
