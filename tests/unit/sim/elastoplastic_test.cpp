// Elastic-plastic contact laws against closed forms, printed constants and each other.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

#include "sim/contact/law/normal_elastoplastic.h"

namespace impactdic {
namespace {

// The rod and flat of Table 5.1.
const ElasticPlasticSurface kSteel{
    0.0088, sim::contact::effective_modulus_pa(200e9, 0.29, 200e9, 0.29), 300e6, 0.29};
constexpr double kMass_kg = 0.5784;

sim::contact::ElasticPlasticLaw law(PlasticLoading loading, ResidualLaw residual) {
  return {kSteel, loading, residual};
}

// Largest compression whose elastic energy is m V_y^2 / 2 is the critical one.
double yield_speed(const sim::contact::ElasticPlasticLaw& law) {
  return std::sqrt(0.8 * law.critical_force_n() * law.critical_compression_m() / kMass_kg);
}

TEST(ElasticPlastic, CriticalPointOfTheSource) {
  const auto l = law(PlasticLoading::kJacksonGreen, ResidualLaw::kJackson);
  EXPECT_NEAR(kSteel.effective_modulus_pa, 109.18e9, 0.005e9);
  EXPECT_NEAR(l.critical_compression_m(), 4.213e-7, 0.0005e-7);
  EXPECT_NEAR(l.critical_force_n(), 3.7344, 0.00005);
}

TEST(ElasticPlastic, EveryLawIsHertzBeforeYield) {
  for (auto loading :
       {PlasticLoading::kJacksonGreen, PlasticLoading::kKogutEtsion, PlasticLoading::kThornton}) {
    const auto l = law(loading, ResidualLaw::kKogutEtsion);
    const double w = 0.7 * l.critical_compression_m();
    const double hertz =
        4.0 / 3 * kSteel.effective_modulus_pa * std::sqrt(kSteel.radius_m) * std::pow(w, 1.5);
    EXPECT_NEAR(l.loading_force_n(w) / hertz, 1, 1e-12);
    EXPECT_EQ(l.residual_m(w), 0);
    EXPECT_NEAR(l.unloading_force_n(w / 2, w) / l.loading_force_n(w / 2), 1, 1e-12);
    EXPECT_NEAR(l.restitution(kMass_kg, 0.5 * yield_speed(l)), 1, 1e-12);
  }
}

TEST(ElasticPlastic, KogutEtsionJumpsAsPrinted) {
  const auto l = law(PlasticLoading::kKogutEtsion, ResidualLaw::kKogutEtsion);
  const double w_c = l.critical_compression_m();
  const auto jump = [&](double x) {
    return l.loading_force_n(w_c * x * (1 + 1e-9)) / l.loading_force_n(w_c * x * (1 - 1e-9)) - 1;
  };
  EXPECT_NEAR(jump(1), 0.03, 1e-6);
  EXPECT_NEAR(jump(6), 1.40 * std::pow(6, 1.263) / (1.03 * std::pow(6, 1.425)) - 1, 1e-6);
  EXPECT_NEAR(jump(6), 0.017, 5e-4);
  EXPECT_NEAR(jump(110), 0, 1e-6);
}

// Thornton's closed form is the ratio of the two energies that our law integrates.
TEST(ElasticPlastic, ThorntonIntegratesToItsClosedForm) {
  EXPECT_NEAR(sim::contact::thornton_restitution(0.5), 0.930626, 5e-7);
  EXPECT_EQ(sim::contact::thornton_restitution(1.5), 1);
  const auto l = law(PlasticLoading::kThornton, ResidualLaw::kJackson);
  for (double ratio : {0.9, 0.5, 0.1, 0.01}) {
    EXPECT_NEAR(l.restitution(kMass_kg, yield_speed(l) / ratio),
                sim::contact::thornton_restitution(ratio), 1e-10)
        << ratio;
  }
}

TEST(ElasticPlastic, JohnsonFallsWithTheQuarterPowerOfSpeed) {
  const double slow = sim::contact::johnson_restitution(kSteel, kMass_kg, 1);
  EXPECT_NEAR(sim::contact::johnson_restitution(kSteel, kMass_kg, 16) / slow, 0.5, 1e-12);
  // Thornton's law reaches the same exponent far past yield.
  const auto l = law(PlasticLoading::kThornton, ResidualLaw::kJackson);
  const double fast = 1e4 * yield_speed(l);
  EXPECT_NEAR(l.restitution(kMass_kg, 16 * fast) / l.restitution(kMass_kg, fast), 0.5, 1e-4);
}

TEST(ElasticPlastic, EnergyIsTheAreaUnderTheCurve) {
  for (auto loading :
       {PlasticLoading::kJacksonGreen, PlasticLoading::kKogutEtsion, PlasticLoading::kThornton}) {
    const auto l = law(loading, ResidualLaw::kKogutEtsion);
    const double top = 300 * l.critical_compression_m();
    // Between the seams of the published fits, where the force jumps or bends.
    double in = 0, out = 0, from = 0;
    for (const double x : {1.0, 1.9, 6.0, 110.0, 300.0}) {
      using boost::math::quadrature::gauss_kronrod;
      const double to = x * l.critical_compression_m();
      const auto area = [&](const auto& force) {
        return gauss_kronrod<double, 31>::integrate(force, from, to, 12, 1e-9);
      };
      in += area([&](double w) { return l.loading_force_n(w); });
      out += area([&](double w) { return l.unloading_force_n(w, top); });
      from = to;
    }
    EXPECT_NEAR(l.loading_energy_j(top) / in, 1, 1e-8);
    EXPECT_NEAR(l.released_energy_j(top) / out, 1, 1e-8);
    EXPECT_LT(out, in);
  }
}

TEST(ElasticPlastic, UnloadingStartsAtTheLoadingCurveAndEndsAtTheResidual) {
  for (auto residual : {ResidualLaw::kJackson, ResidualLaw::kKogutEtsion}) {
    const auto l = law(PlasticLoading::kJacksonGreen, residual);
    double before = -1;
    for (double x : {2.0, 5.0, 20.0, 100.0, 500.0}) {
      const double top = x * l.critical_compression_m();
      EXPECT_DOUBLE_EQ(l.unloading_force_n(top, top), l.loading_force_n(top));
      EXPECT_EQ(l.unloading_force_n(l.residual_m(top), top), 0);
      EXPECT_GT(l.residual_m(top), before);
      EXPECT_LT(l.residual_m(top), top);
      before = l.residual_m(top);
    }
  }
}

TEST(ElasticPlastic, ImpossibleSurfacesNameTheirKey) {
  ElasticPlasticSurface bad = kSteel;
  bad.yield_strength_pa = -1;
  try {
    sim::contact::ElasticPlasticLaw(bad, PlasticLoading::kThornton, ResidualLaw::kJackson);
    FAIL();
  } catch (const InvalidArgument& error) {
    EXPECT_EQ(error.where(), "yield_strength_pa");
  }
}

}  // namespace
}  // namespace impactdic
