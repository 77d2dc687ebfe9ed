// Fits of the viscoelastic laws: their own constants come back. What the fits differentiate by.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/fit/residuals/shot_model.h"
#include "sim/shot/shot.h"
#include "sim/shot/track_table.h"
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

// The contact's start and the rate move the instants only: their derivatives are velocities.
TEST(LawFit, DerivativesByTheInstantsAreThoseOfDifferences) {
  testing::ScratchFolder folder;
  testing::SyntheticTrack known{testing::tennis_shot(30, -1.6, -2.8)};
  known.position_noise_m = known.stated_sd_m = 13e-6;
  known.motion = true;
  known.motion_noise_m = 1.3e-6;
  known.turn_noise_rad = 3.5e-4;
  write_track(known, folder / "track.csv");
  MeasuredTrack track = sim::shot::read_track(folder / "track.csv");
  track.rate_sd = 1e-3;
  const MeasuredShot shot = sim::shot::measure_shot(track, {known.job.body, 30});
  const sim::fit::ShotModel model(track, shot, known.job, {FitParameter::kStiffness},
                                  {FitParameter::kContactTime});
  std::vector<double> values;
  for (const sim::fit::Unknown& u : model.unknowns()) values.push_back(u.start);
  const std::size_t rows = model.residuals();
  std::vector<double> here(rows), jacobian(rows * model.size()), high(rows), low(rows);
  ASSERT_TRUE(model.evaluate(values.data(), here.data(), jacobian.data()));
  for (const FitParameter parameter : {FitParameter::kContactTime, FitParameter::kRate}) {
    const std::size_t place = model.place_of(parameter);
    ASSERT_LT(place, model.size());
    const double step = model.unknowns()[place].step, value = values[place];
    values[place] = value + step;
    ASSERT_TRUE(model.evaluate(values.data(), high.data(), nullptr));
    values[place] = value - step;
    ASSERT_TRUE(model.evaluate(values.data(), low.data(), nullptr));
    values[place] = value;
    double largest = 0, off = 0;
    for (std::size_t r = 0; r < rows; ++r) {
      const double exact = jacobian[r * model.size() + place];
      largest = std::max(largest, std::abs(exact));
      off = std::max(off, std::abs((high[r] - low[r]) / (2 * step) - exact));
    }
    EXPECT_LT(off, 1e-5 * largest) << key_of(parameter, known.job.normal);
  }
}

}  // namespace
}  // namespace impactdic
