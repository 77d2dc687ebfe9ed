#include "sim/contact/law/normal_elastoplastic.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <boost/math/differentiation/autodiff.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "sim/contact/law/normal_law.h"

namespace impactdic {
namespace {

void require(bool good, const char* key, const char* hint) {
  if (!good) throw InvalidArgument("impossible value", key, hint);
}

}  // namespace

void ElasticPlasticSurface::validate() const {
  require(radius_m > 0 && std::isfinite(radius_m), "radius_m", "must be a positive length");
  require(effective_modulus_pa > 0 && std::isfinite(effective_modulus_pa), "reduced_modulus_pa",
          "must be positive");
  require(yield_strength_pa > 0 && std::isfinite(yield_strength_pa), "yield_strength_pa",
          "must be positive");
  require(poisson >= 0 && poisson <= 0.5, "poisson", "must lie in 0..0.5");
}

}  // namespace impactdic

namespace impactdic::sim::contact {
namespace {

// Kogut & Etsion and Johnson: hardness over yield strength once the contact is fully plastic.
constexpr double kHardnessOverYield = 2.8;
// Jackson & Green: elastic below, in units of the critical compression.
constexpr double kJacksonElasticLimit = 1.9;

// Jackson, Green & Marghitu 2010: up to here the recovered deflection x (1 - fit) grows with x.
constexpr double kJacksonTurn = 2400;

double jackson_residual(double x) { return 1.02 * (1 - std::pow((x + 5.9) / 6.9, -0.54)); }

// Jackson & Green 2005, Eqs. 2.17-2.20.
template <typename Real>
Real jackson_contact_over_radius(const Real& x, double yield_constant, double yield_over_modulus) {
  using std::pow, std::sqrt;
  const double exponent = 0.14 * std::exp(23 * yield_over_modulus);
  return kPi * yield_constant / 2 * yield_over_modulus *
         sqrt(x * pow(x / kJacksonElasticLimit, exponent));
}

// The pressure falls as the contact circle nears the radius.
template <typename Real>
Real jackson_hardness_over_yield(const Real& x, double yield_constant, double yield_over_modulus) {
  using std::exp, std::pow;
  const Real contact_over_radius =
      jackson_contact_over_radius(x, yield_constant, yield_over_modulus);
  return 2.84 * (1 - exp(-0.82 * pow(contact_over_radius, -0.7)));
}

template <typename Real>
Real jackson_green(const Real& x, double yield_constant, double yield_over_modulus) {
  using std::exp, std::pow, std::sqrt;
  if (x < kJacksonElasticLimit) return x * sqrt(x);
  const Real hardness = jackson_hardness_over_yield(x, yield_constant, yield_over_modulus);
  return exp(-pow(x, 5.0 / 12) / 4) * x * sqrt(x) +
         4 * hardness / yield_constant * (1 - exp(-pow(x, 5.0 / 9) / 25)) * x;
}

// Beyond x = 110 the last fit is continued until it meets the fully plastic line P = 2 pi R w H.
template <typename Real>
Real kogut_etsion(const Real& x, double yield_constant) {
  using std::pow, std::sqrt;
  if (x < 1) return x * sqrt(x);
  if (x < 6) return 1.03 * pow(x, 1.425);
  const Real fitted = 1.40 * pow(x, 1.263), plastic = 3 * kHardnessOverYield / yield_constant * x;
  const Real least(1.40 * std::pow(110, 1.263));
  const Real line = plastic < least ? least : plastic;
  return fitted < line ? fitted : line;
}

// Stronge 2000, chapter 6: beyond yield the contact's area grows as X = 2 x - 1 and its mean
// pressure as 1 + ln(X) / (3 theta), theta = 1.1, until it is 2.8 Sy.
constexpr double kStrongeYield = 1.1;

template <typename Real>
Real stronge(const Real& x) {
  using std::log, std::sqrt;
  if (x < 1) return x * sqrt(x);
  const Real area = 2 * x - 1, growing = 1 + log(area) / (3 * kStrongeYield);
  const Real most(kHardnessOverYield / kStrongeYield);
  return area * (growing < most ? growing : most);
}

// Where the pressure stops growing: x = 82.5.
double stronge_plastic() { return (1 + std::exp(3 * (kHardnessOverYield - kStrongeYield))) / 2; }

// int from 1 to x of it.
double stronge_energy(double x) {
  const auto growing = [](double area) {
    const double square = area * area;
    return square / 4 + (square * std::log(area) / 2 - square / 4) / (6 * kStrongeYield);
  };
  const double end = std::min(x, stronge_plastic());
  const double beyond = std::max(x - end, 0.0), area = 2 * end - 1;
  return growing(area) - growing(1) + kHardnessOverYield / kStrongeYield * beyond * (area + beyond);
}

// Thornton 1997: Hertz up to yield, then the slope of yield is kept: dP/dw = pi p_y R.
template <typename Real>
Real thornton(const Real& x) {
  using std::sqrt;
  if (x < 1) return x * sqrt(x);
  return 1 + 1.5 * (x - 1);
}

}  // namespace

double effective_modulus_pa(double young1_pa, double poisson1, double young2_pa, double poisson2) {
  return 1 / ((1 - poisson1 * poisson1) / young1_pa + (1 - poisson2 * poisson2) / young2_pa);
}

ElasticPlasticLaw::ElasticPlasticLaw(const ElasticPlasticSurface& surface, PlasticLoading loading,
                                     ResidualLaw residual)
    : surface_(surface), loading_(loading), residual_(residual) {
  surface_.validate();
  yield_constant_ = loading_ == PlasticLoading::kStronge
                        ? 1.5 * kStrongeYield
                        : 1.295 * std::exp(0.736 * surface_.poisson);
  const double pressure = kPi * yield_constant_ * surface_.yield_strength_pa / 2;
  const double ratio = pressure / surface_.effective_modulus_pa;
  critical_compression_m_ = ratio * ratio * surface_.radius_m;
  critical_force_n_ = 4.0 / 3 * surface_.radius_m * surface_.radius_m * ratio * ratio * pressure;
}

template <typename Real>
Real ElasticPlasticLaw::normalised_loading(const Real& x) const {
  if (loading_ == PlasticLoading::kThornton) return thornton(x);
  if (loading_ == PlasticLoading::kStronge) return stronge(x);
  if (loading_ == PlasticLoading::kKogutEtsion) return kogut_etsion(x, yield_constant_);
  return jackson_green(x, yield_constant_,
                       surface_.yield_strength_pa / surface_.effective_modulus_pa);
}

double ElasticPlasticLaw::loading_force_n(double w_m) const {
  if (!(w_m > 0)) return 0;
  return critical_force_n_ * normalised_loading(w_m / critical_compression_m_);
}

ElasticPlasticLaw::LoadingSlopes ElasticPlasticLaw::loading_slopes(double w_m) const {
  using boost::math::differentiation::make_fvar;
  if (!(w_m > 0)) return {};
  const auto force = normalised_loading(make_fvar<double, 2>(w_m / critical_compression_m_));
  const double scale = critical_force_n_ / critical_compression_m_;
  return {scale * force.derivative(1), scale / critical_compression_m_ * force.derivative(2)};
}

double ElasticPlasticLaw::next_kink_m(double w_m) const {
  for (const double x : {1.0, kJacksonElasticLimit, 6.0, stronge_plastic(), 110.0}) {
    // Only his law has that one; the others are smooth there.
    if (x == stronge_plastic() && loading_ != PlasticLoading::kStronge) continue;
    // A little beyond, so that who has come there is on the far side whatever the rounding.
    const double kink_m = x * critical_compression_m_ * (1 + 1e-15);
    if (kink_m > w_m) return kink_m;
  }
  return std::numeric_limits<double>::infinity();
}

double ElasticPlasticLaw::residual_m(double largest_m) const {
  const double fitted = fitted_residual_m(largest_m);
  if (!(largest_m > 0)) return fitted;
  // Just above yield the fits' jumps would give back more than was put in: there the rebound is
  // elastic. released = P_m (w_m - w_r)/(n + 1) = loaded.
  const double recovered = (unloading_exponent(largest_m) + 1) * loading_energy_j(largest_m) /
                           loading_force_n(largest_m);
  const double least = largest_m - recovered;
  return least > fitted && least > 1e-13 * largest_m ? least : fitted;
}

double ElasticPlasticLaw::fitted_residual_m(double largest_m) const {
  const double x = largest_m / critical_compression_m_;
  if (!(x > 1)) return 0;
  if (loading_ == PlasticLoading::kThornton) {
    // Unloading is Hertz over the radius R_p that gives the same contact circle at P_m.
    const double force = thornton(x);
    const double radius_ratio = std::pow((2 * force + 1) / 3, 1.5) / force;
    return largest_m - critical_compression_m_ * std::cbrt(force * force / radius_ratio);
  }
  if (loading_ == PlasticLoading::kStronge) {
    // What recovers is in proportion to the contact's radius, a^2 = (2 x - 1) a_c^2.
    return largest_m - critical_compression_m_ * std::sqrt(2 * x - 1);
  }
  if (residual_ == ResidualLaw::kKogutEtsion) {
    return largest_m * (1 - std::pow(x, -0.28)) * (1 - std::pow(x, -0.69));
  }
  // Jackson's fit holds from x = 1.9; below, the loading is Hertz and nothing stays.
  if (x < kJacksonElasticLimit && loading_ == PlasticLoading::kJacksonGreen) return 0;
  if (x <= kJacksonTurn) return largest_m * jackson_residual(x);
  // Beyond, the fit would let less recover the deeper the contact, and then exceed w_m.
  return largest_m - critical_compression_m_ * kJacksonTurn * (1 - jackson_residual(kJacksonTurn));
}

std::string ElasticPlasticLaw::out_of_range(double largest_m) const {
  const double x = largest_m / critical_compression_m_;
  if (loading_ == PlasticLoading::kKogutEtsion && x > 110) {
    return beyond_limit("the largest deflection over the critical one", x, 110);
  }
  if (loading_ == PlasticLoading::kJacksonGreen && x > kJacksonElasticLimit) {
    const double width = jackson_contact_over_radius(
        x, yield_constant_, surface_.yield_strength_pa / surface_.effective_modulus_pa);
    if (width > 0.41) return beyond_limit("the contact's radius over the body's", width, 0.41);
  }
  if (largest_m > 0.2 * surface_.radius_m) {
    return beyond_limit("the largest deflection over the radius", largest_m / surface_.radius_m,
                        0.2);
  }
  return "";
}

double ElasticPlasticLaw::unloading_exponent(double largest_m) const {
  const double x = largest_m / critical_compression_m_;
  const bool own = loading_ == PlasticLoading::kThornton || loading_ == PlasticLoading::kStronge;
  if (own || residual_ == ResidualLaw::kJackson || x <= 1) {
    return 1.5;
  }
  return 1.5 * std::pow(x, -0.0331);
}

double ElasticPlasticLaw::unloading_force_n(double w_m, double largest_m) const {
  return unloading_force_n(w_m, largest_m, residual_m(largest_m));
}

double ElasticPlasticLaw::unloading_force_n(double w_m, double largest_m, double residual) const {
  if (!(w_m > residual)) return 0;
  return loading_force_n(largest_m) *
         std::pow((w_m - residual) / (largest_m - residual), unloading_exponent(largest_m));
}

double ElasticPlasticLaw::loading_energy_j(double w_m) const {
  if (!(w_m > 0)) return 0;
  // Integrated between the kinks, so that each piece is smooth.
  const std::array<double, 4> kinks{1, kJacksonElasticLimit, 6, 110};
  const double x = w_m / critical_compression_m_;
  const auto force = [this](double s) { return normalised_loading(s); };
  double sum = 0.4 * std::pow(std::min(x, 1.0), 2.5);
  if (loading_ == PlasticLoading::kStronge) {
    if (x > 1) sum += stronge_energy(x);
    return sum * critical_force_n_ * critical_compression_m_;
  }
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
  for (std::size_t i = 0; i < kinks.size() && x > kinks[i]; ++i) {
    const bool last = i + 1 == kinks.size();
    const double end = last ? x : std::min(x, kinks[i + 1]);
    // Just inside the piece: the published fits jump at the kinks.
    const double start = std::nextafter(kinks[i], end);
    if (last) {  // over decades
      const auto by_log = [&](double t) { return force(std::exp(t)) * std::exp(t); };
      sum += Kronrod::integrate(by_log, std::log(start), std::log(x), 12, 1e-14);
    } else {
      sum += Kronrod::integrate(force, start, std::nextafter(end, start), 12, 1e-12);
    }
  }
  return sum * critical_force_n_ * critical_compression_m_;
}

double ElasticPlasticLaw::released_energy_j(double largest_m) const {
  if (!(largest_m > 0)) return 0;
  return loading_force_n(largest_m) * (largest_m - residual_m(largest_m)) /
         (unloading_exponent(largest_m) + 1);
}

double ElasticPlasticLaw::largest_compression_m(double mass_kg, double speed_m_s) const {
  const double energy = mass_kg * speed_m_s * speed_m_s / 2;
  if (!(energy > 0)) return 0;
  const auto missing = [&](double w) { return loading_energy_j(w) - energy; };
  double high = critical_compression_m_;
  while (missing(high) < 0) high *= 2;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      missing, 0.0, high, boost::math::tools::eps_tolerance<double>(50), iterations);
  return (bracket.first + bracket.second) / 2;
}

double ElasticPlasticLaw::restitution(double mass_kg, double speed_m_s) const {
  const double largest = largest_compression_m(mass_kg, speed_m_s);
  if (!(largest > 0)) return 1;
  return std::sqrt(std::min(1.0, released_energy_j(largest) / loading_energy_j(largest)));
}

double johnson_restitution(const ElasticPlasticSurface& surface, double mass_kg, double speed_m_s) {
  const double pressure = 3 * surface.yield_strength_pa;
  const double energy = mass_kg * speed_m_s * speed_m_s / 2;
  const double volume = surface.radius_m * surface.radius_m * surface.radius_m;
  return std::sqrt(3 * std::pow(kPi, 1.25) * std::pow(4, 0.75) / 10 * pressure /
                   surface.effective_modulus_pa * std::pow(energy / (pressure * volume), -0.25));
}

double thornton_restitution(double yield_speed_over_speed) {
  const double y = yield_speed_over_speed;
  if (y >= 1) return 1;
  return std::sqrt(6 * std::sqrt(3.0) / 5) * std::sqrt(1 - y * y / 6) *
         std::pow(y / (y + 2 * std::sqrt(1.2 - y * y / 5)), 0.25);
}

}  // namespace impactdic::sim::contact
