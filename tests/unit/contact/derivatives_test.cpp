// Derivatives of impacts: against extrapolated differences, and where a formula knows them.
#include <gtest/gtest.h>
#include <impactdic/simulate.h>

#include <cmath>

#include "sim/contact/derivatives/path_slopes.h"
#include "tests/support/impacts/derivative_check.h"
#include "tests/support/random_shots.h"

namespace impactdic {
namespace {

using sim::contact::derivatives_of;
using sim::contact::simulate_impact;

double derivative(const ImpactDerivatives& d, const std::string& outcome,
                  const std::string& input) {
  const auto r = std::find(d.outcomes.begin(), d.outcomes.end(), outcome);
  const auto c = std::find(d.inputs.begin(), d.inputs.end(), input);
  if (r == d.outcomes.end() || c == d.inputs.end()) {
    ADD_FAILURE() << "no " << outcome << " by " << input;
    return 0;
  }
  return d.values[static_cast<std::size_t>(r - d.outcomes.begin()) * d.inputs.size() +
                  static_cast<std::size_t>(c - d.inputs.begin())];
}

ImpactDerivatives derivatives(const ImpactJob& job) {
  return derivatives_of(job, simulate_impact(job));
}

ImpactJob ball() {
  ImpactJob job;
  job.normal = NormalModel::kHertzDamper;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kSolidSphere, 0.1, 0.05};
  job.contact.stiffness = 1e6;
  job.contact.friction_kinetic = 0.1;
  job.initial = {3, -2, 0};
  job.gravity_m_s2 = 0;
  return job;
}

// T = 2.94328 delta_m/v ~ (m^2/(k^2 v))^(1/5), delta_m = (5 m v^2/(4 k))^0.4 (Hertz 1882).
TEST(Derivatives, OfHertzsImpactByItsFormula) {
  const ImpactJob job = ball();
  const ImpactResult plain = simulate_impact(job);
  const ImpactDerivatives d = derivatives_of(job, plain);
  EXPECT_NEAR(derivative(d, "contact_s", "body.mass_kg") * 0.1 / plain.contact_s, 0.4, 1e-9);
  EXPECT_NEAR(derivative(d, "contact_s", "contact.stiffness_n_per_m1p5") * 1e6 / plain.contact_s,
              -0.4, 1e-9);
  EXPECT_NEAR(derivative(d, "contact_s", "initial.vn_m_s") * -2 / plain.contact_s, -0.2, 1e-9);
  EXPECT_NEAR(derivative(d, "max_deflection_m", "initial.vn_m_s") * -2 / plain.max_deflection_m,
              0.8, 1e-9);
  // It slides throughout: v_t' = v_t - mu (1 + e)|v_n|, R omega' = -5/2 mu (1 + e)|v_n|.
  EXPECT_NEAR(derivative(d, "final.vt_m_s", "contact.friction_kinetic"), -4, 1e-8);
  EXPECT_NEAR(derivative(d, "final.vt_m_s", "initial.vn_m_s"), 0.2, 1e-8);
  EXPECT_NEAR(derivative(d, "final.omega_rad_s", "initial.vn_m_s") * 0.025, 0.5, 1e-8);
  EXPECT_NEAR(derivative(d, "final.vt_m_s", "initial.vt_m_s"), 1, 1e-8);
  // A little slip across turns the line of friction by vb/vt.
  EXPECT_NEAR(derivative(d, "final.vb_m_s", "initial.vb_m_s"), 1 - 0.4 / 3, 1e-8);
  EXPECT_EQ(derivative(d, "final.vt_m_s", "initial.vb_m_s"), 0);
}

// A contact point that rests before rolls, and any little slip is gone at once: 5/7.
TEST(Derivatives, OfAContactPointAtRest) {
  ImpactJob job = ball();
  job.initial.vt_m_s = 0;
  EXPECT_NEAR(derivative(derivatives(job), "final.vt_m_s", "initial.vt_m_s"), 5.0 / 7, 1e-9);
  EXPECT_NEAR(derivative(derivatives(job), "final.vb_m_s", "initial.vb_m_s"), 5.0 / 7, 1e-9);
}

// The touch moves with the gap: one metre more of flight takes 1/|v_n|.
TEST(Derivatives, ByAGapOfZero) {
  ImpactJob job = ball();
  job.friction = FrictionModel::kFullSliding;
  const ImpactDerivatives d = derivatives(job);
  EXPECT_NEAR(derivative(d, "contact_start_s", "initial.gap_m"), 0.5, 1e-9);
  EXPECT_NEAR(derivative(d, "end_s", "initial.gap_m"), 0.5, 1e-9);
  EXPECT_NEAR(derivative(d, "final.qt_m", "initial.gap_m"), 1.5, 1e-9);
}

TEST(Derivatives, OfEveryLawMeetDifferences) {
  constexpr std::size_t kStride = 6;  // all inputs of all laws would take half a minute
  int compared = 0;
  std::size_t first = 0;
  for (const support::LawPair& laws : support::kSoundLaws) {
    support::RandomShots random(11);
    const ImpactJob job = random.next(laws);
    const support::DerivativeError error =
        support::derivative_error(job, 1e-9, first++ % kStride, kStride);
    EXPECT_LT(error.worst, 1e-8) << name_of(laws.first) << " " << name_of(laws.second) << ": "
                                 << error.where;
    compared += error.compared;
  }
  EXPECT_GT(compared, 1000);
}

TEST(Derivatives, InSpaceMeetDifferences) {
  for (const support::LawPair& laws :
       {support::LawPair{NormalModel::kHertzDamper, FrictionModel::kCoulomb},
        support::LawPair{NormalModel::kHertzDamper, FrictionModel::kMawBarberFawcett},
        support::LawPair{NormalModel::kThornton, FrictionModel::kCoulomb}}) {
    support::RandomShots random(4);
    const support::DerivativeError error =
        support::derivative_error(random.next_in_space(laws), 1e-9, 1, 3);
    EXPECT_LT(error.worst, 1e-8) << error.where;
    EXPECT_GT(error.compared, 30);
  }
}

// Motions that are hard to follow: a slip whose velocity is exactly zero where the law looks for
// its end, a damper that is infinitely steep where the ball leaves, adhesion that gives way to
// pressure, a slip that turns as it stops, a switch that follows the touch at once.
TEST(Derivatives, OfHardMotionsMeetDifferences) {
  struct Hard {
    support::LawPair laws;
    bool space;
    int shot;  // of the first series
  };
  for (const Hard& hard :
       {Hard{{NormalModel::kLinearSpringDamper, FrictionModel::kCoulomb}, false, 5},
        Hard{{NormalModel::kTsuji, FrictionModel::kNone}, false, 11},
        Hard{{NormalModel::kJkr, FrictionModel::kTangentialSpring}, false, 4},
        Hard{{NormalModel::kLinearSpringDamper, FrictionModel::kBrody}, true, 2},
        Hard{{NormalModel::kKogutEtsion, FrictionModel::kTangentialSpring}, true, 5}}) {
    support::RandomShots random(1);
    ImpactJob job;
    for (int i = 0; i <= hard.shot; ++i) {
      job = hard.space ? random.next_in_space(hard.laws) : random.next(hard.laws);
    }
    const support::DerivativeError error = support::derivative_error(job, 1e-9);
    EXPECT_LT(error.worst, 1e-8) << name_of(hard.laws.first) << ": " << error.where;
    EXPECT_GT(error.compared, 100);
    EXPECT_EQ(error.missing, 0);
  }
}

TEST(Derivatives, OfTwoBallsAndOfFlightMeetDifferences) {
  ImpactJob job = ball();
  job.friction = FrictionModel::kMawBarberFawcett;
  job.contact.poisson = 0.3;
  job.initial = {3, -2, 20};
  ImpactJob two = job;
  two.other = OtherBody{{BodyShape::kHollowSphere, 0.05, 0.03}, {-0.4, 0.3, 7}};
  ImpactJob flown = job;
  flown.gravity_m_s2 = 9.81;
  flown.surface_angle_deg = 12;
  flown.initial.gap_m = 0.3;
  flown.air.drag_coefficient = 0.5;
  flown.air.lift_coefficient = 0.8;
  for (const ImpactJob& one : {two, flown}) {
    const support::DerivativeError error = support::derivative_error(one, 1e-9, 0, 3);
    EXPECT_LT(error.worst, 1e-8) << error.where;
    EXPECT_GT(error.compared, 50);
  }
}

TEST(Derivatives, OfARodMeetDifferences) {
  ImpactJob job = ball();
  job.body = {BodyShape::kRod, 0.5784, 0.0127, 0.3};
  job.contact.stiffness = 1e9;
  job.initial = {0.3, -2, 1};
  job.initial.angle_deg = 45;
  const support::DerivativeError error = support::derivative_error(job, 1e-9);
  EXPECT_LT(error.worst, 1e-8) << error.where;
  EXPECT_GT(error.compared, 50);
}

// What a fit asks for: places at fixed instants, in flight, through every switch, and after.
struct PathError {
  double worst = 0;  // in parts of the way, or of the turn, over a contact
  int compared = 0;
};

// Of the place after `at` instants by one number: the extrapolation of its differences.
std::pair<double, double> path_differences(const ImpactJob& job, const std::string& key,
                                           double scale, const std::vector<double>& times,
                                           std::size_t at, double BodyState::*part) {
  support::Differences table;
  double step = 2e-3 * scale;
  for (auto& row : table) {
    ImpactJob high = job, low = job;
    support::number_of(high, key) += step;
    support::number_of(low, key) -= step;
    row["place"] = (simulate_impact(high, {0, times}).trajectory[at].state.*part -
                    simulate_impact(low, {0, times}).trajectory[at].state.*part) /
                   (2 * step);
    step /= 2;
  }
  return support::extrapolated(table, "place");
}

PathError path_error(ImpactJob job, const std::vector<std::string>& keys) {
  job.solver.relative_tolerance = 1e-13;
  const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s);
  const ImpactResult plain = simulate_impact(job);
  if (!plain.separated) return {};
  std::vector<double> times;
  for (const double part : {-0.5, 0.3, 0.8, 1.6}) {
    times.push_back(plain.contact_start_s + part * plain.contact_s);
  }
  const ImpactResult path = simulate_impact(job, {0, times});
  ImpactJob asked = job;
  asked.solver.relative_tolerance = 1e-10;
  const auto slopes = sim::contact::path_slopes(asked, times, keys, path.trajectory);
  EXPECT_TRUE(slopes) << name_of(job.normal) << " " << name_of(job.friction);
  if (!slopes) return {};
  sim::contact::JobNumbers<double> numbers(job);
  const auto inputs = sim::contact::numbers_of(job, numbers);
  PathError error;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto input = std::find_if(inputs.begin(), inputs.end(),
                                    [&](const auto& each) { return each.key == keys[k]; });
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double way = speed * plain.contact_s;
      const auto compare = [&](double told, double BodyState::*part, double over) {
        const auto [best, moved] = path_differences(job, keys[k], input->scale, times, i, part);
        if (!(moved * input->scale < 1e-8 * over)) return;
        const double off = std::abs(told - best) * input->scale;
        error.worst = std::max(error.worst, off / std::max(over, std::abs(best * input->scale)));
        ++error.compared;
      };
      compare(slopes->t[i * keys.size() + k], &BodyState::qt_m, way);
      compare(slopes->n[i * keys.size() + k], &BodyState::qn_m, way);
      compare(slopes->angle[i * keys.size() + k], &BodyState::angle_rad, way / job.body.radius_m());
    }
  }
  return error;
}

TEST(Derivatives, OfThePathOfEveryLawMeetDifferences) {
  int compared = 0;
  for (const support::LawPair& laws : support::kSoundLaws) {
    support::RandomShots random(7);
    const ImpactJob job = random.next(laws);
    std::vector<std::string> keys{"initial.vt_m_s", "initial.vn_m_s"};
    if (laws.second != FrictionModel::kNone) keys.push_back("contact.friction_kinetic");
    const PathError error = path_error(job, keys);
    EXPECT_LT(error.worst, 1e-6) << name_of(laws.first) << " " << name_of(laws.second);
    compared += error.compared;
  }
  EXPECT_GT(compared, 900);
}

// A ball that its weight holds has no rebound, hence no derivatives.
TEST(Derivatives, OfABallThatStaysAreNotTold) {
  ImpactJob job = ball();
  job.gravity_m_s2 = 9.81;
  job.initial = {0, -0.01, 0};
  job.contact.damping_n_s_per_m = 1000;
  job.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  const ImpactResult plain = simulate_impact(job);
  ASSERT_FALSE(plain.separated);
  for (const double value : derivatives_of(job, plain).values) EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace impactdic
