// Whether a fit says that its model does not describe the data, and which law does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/fitted_shots.h"

namespace impactdic {
namespace {

const ParameterEstimate& parameter(const ShotFit& fit, FitParameter which) {
  return *std::find_if(fit.parameters.begin(), fit.parameters.end(),
                       [&](const ParameterEstimate& p) { return p.parameter == which; });
}

TEST(Adequacy, TheRightLawIsAdequate) {
  const ImpactJob truth = testing::tennis_shot(30, -1.6, -2.8);
  int inadequate = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    inadequate += testing::fit_of_shot(truth, truth, seed, false).adequacy != Adequacy::kAdequate;
  }
  EXPECT_LE(inadequate, 1);  // 0.12 are to be expected
}

TEST(Adequacy, AnotherLawIsInadequateAndTheTruthIsNamed) {
  ImpactJob truth = testing::tennis_shot(30, -1.6, -2.8);
  truth.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  const ImpactJob wrong = testing::tennis_shot(30, -1.6, -2.8);
  // Eleven laws are fitted to each shot.
  for (const unsigned seed : {1u}) {
    const ShotFit fit = testing::fit_of_shot(truth, wrong, seed, true);
    for (const NormalModel law : {NormalModel::kHertzDamper, NormalModel::kTsuji,
                                  NormalModel::kKuwabaraKono, NormalModel::kHuntCrossley}) {
      EXPECT_TRUE(std::any_of(fit.rivals.begin(), fit.rivals.end(), [&](const RivalFit& rival) {
        return rival.normal == law;
      })) << name_of(law);
    }
    EXPECT_EQ(fit.adequacy, Adequacy::kInadequate) << seed;
    EXPECT_LT(fit.p_value, 0.01) << seed;
    ASSERT_GE(fit.rivals.size(), 6u);
    EXPECT_EQ(fit.rivals[0].normal, truth.normal) << seed;
    EXPECT_EQ(fit.rivals[0].restitution_damping, RestitutionDamping::kToZeroForce) << seed;
    EXPECT_EQ(fit.rivals[0].above_best, 0);
    EXPECT_TRUE(
        std::is_sorted(fit.rivals.begin(), fit.rivals.end(),
                       [](const RivalFit& a, const RivalFit& b) { return a.aicc < b.aicc; }));
    EXPECT_NE(parameter(fit, FitParameter::kStiffness).verdict, "determined by the data");
    const bool named =
        std::any_of(fit.warnings.begin(), fit.warnings.end(), [](const std::string& warning) {
          return warning.find("another law describes the data better") != std::string::npos;
        });
    EXPECT_TRUE(named) << seed;
  }
}

TEST(Adequacy, AModelWithoutFrictionIsInadequateWhereThereIsSome) {
  const ImpactJob truth = testing::tennis_shot(30, -1.6, -2.8);
  ImpactJob smooth = truth;
  smooth.friction = FrictionModel::kNone;
  const ShotFit fit = testing::fit_of_shot(truth, smooth, 1, true);
  EXPECT_EQ(fit.adequacy, Adequacy::kInadequate);
  EXPECT_GT(fit.reduced_chi_square, 10);
  EXPECT_EQ(fit.rivals[0].friction, FrictionModel::kCoulomb);
}

// A ball that rolls as it arrives: any friction above some thousandth fits.
TEST(Adequacy, FrictionOfARollingBallHasNoUpperBound) {
  ImpactJob truth = testing::tennis_shot(30, -1.76, -3.4);
  truth.contact.friction_kinetic = 0.3;
  truth.initial.omega_rad_s = -truth.initial.vt_m_s / truth.body.radius_m();
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const ShotFit fit = testing::fit_of_shot(truth, truth, seed, false);
    const ParameterEstimate& friction = parameter(fit, FitParameter::kFrictionKinetic);
    EXPECT_FALSE(friction.determined) << seed << ": " << friction.value;
    EXPECT_TRUE(std::isnan(friction.ci95_high)) << seed;
    EXPECT_TRUE(parameter(fit, FitParameter::kStiffness).determined) << seed;
    EXPECT_EQ(fit.adequacy, Adequacy::kAdequate) << seed;
  }
}

}  // namespace
}  // namespace impactdic
