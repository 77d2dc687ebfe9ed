// Fits of the viscoelastic laws: their own constants come back.
#include <gtest/gtest.h>

#include "tests/support/fitted_shots.h"

namespace impactdic {
namespace {

// A shot at 2.8 m/s whose restitution is about 0.8.
ImpactJob shot_by(NormalModel normal) {
  ImpactJob job = testing::tennis_shot(30, -1.6, -2.8);
  job.normal = normal;
  job.contact.damping_n_s_per_m = 0;
  job.contact.stiffness = 2.2e5;
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  job.contact.damping_factor = 0.16;
  job.contact.dissipation_s = 3e-4;
  job.contact.damping_s_per_m = 0.06;
  return job;
}

TEST(LawFit, TheConstantsComeBackWithTheirOwnKeys) {
  for (const auto& [normal, key] : {std::pair{NormalModel::kTsuji, "damping_factor"},
                                    std::pair{NormalModel::kKuwabaraKono, "dissipation_s"},
                                    std::pair{NormalModel::kHuntCrossley, "damping_s_per_m"}}) {
    const ImpactJob truth = shot_by(normal);
    const ShotFit fit = testing::fit_of_shot(truth, truth, 3, false);
    ASSERT_EQ(fit.parameters.size(), 4u);
    EXPECT_EQ(fit.parameters[0].key, "stiffness_n_per_m1p5");
    EXPECT_EQ(fit.parameters[1].key, key);
    const double expected[] = {truth.contact.stiffness, truth.contact.damping(normal),
                               truth.contact.friction_kinetic};
    for (int i = 0; i < 3; ++i) {
      const ParameterEstimate& p = fit.parameters[i];
      EXPECT_TRUE(p.determined) << p.key;
      EXPECT_NEAR(p.value, expected[i], 4 * p.sd) << p.key;
      EXPECT_LT(p.sd, 0.1 * expected[i]) << p.key;
    }
    EXPECT_EQ(fit.adequacy, Adequacy::kAdequate) << name_of(normal);
  }
}

}  // namespace
}  // namespace impactdic
