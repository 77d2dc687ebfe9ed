#include "sim/contact/law/normal_elastoplastic.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <boost/math/differentiation/autodiff.hpp>
#include <boost/math/quadrature/gauss.hpp>
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

template <typename Real>
Real jackson_residual(const Real& x) {
  return 1.02 * (1.0 - pow((x + 5.9) / 6.9, -0.54));
}

// What numbers of these kinds give together.
template <typename First, typename... Others>
using Of = boost::math::differentiation::promote<First, Others...>;

// Jackson & Green 2005, Eqs. 2.17-2.20.
template <typename Real, typename C, typename Y>
auto jackson_contact_over_radius(const Real& x, const C& yield_constant,
                                 const Y& yield_over_modulus) {
  const auto exponent = 0.14 * exp(23.0 * yield_over_modulus);
  return kPi * yield_constant / 2.0 * yield_over_modulus *
         sqrt(x * pow(x / kJacksonElasticLimit, exponent));
}

// The pressure falls as the contact circle nears the radius.
template <typename Real, typename C, typename Y>
auto jackson_hardness_over_yield(const Real& x, const C& yield_constant,
                                 const Y& yield_over_modulus) {
  const auto contact_over_radius =
      jackson_contact_over_radius(x, yield_constant, yield_over_modulus);
  return 2.84 * (1.0 - exp(-0.82 * pow(contact_over_radius, -0.7)));
}

template <typename Result, typename Real, typename C, typename Y>
Result jackson_green(const Real& x, const C& yield_constant, const Y& yield_over_modulus) {
  if (x < kJacksonElasticLimit) return Result(x * sqrt(x));
  const auto hardness = jackson_hardness_over_yield(x, yield_constant, yield_over_modulus);
  return exp(-pow(x, 5.0 / 12) / 4.0) * x * sqrt(x) +
         4.0 * hardness / yield_constant * (1.0 - exp(-pow(x, 5.0 / 9) / 25.0)) * x;
}

// Beyond x = 110 the last fit is continued until it meets the fully plastic line P = 2 pi R w H.
template <typename Result, typename Real, typename C>
Result kogut_etsion(const Real& x, const C& yield_constant) {
  if (x < 1.0) return Result(x * sqrt(x));
  if (x < 6.0) return Result(1.03 * pow(x, 1.425));
  const Real fitted = 1.40 * pow(x, 1.263);
  const Result plastic = 3 * kHardnessOverYield / yield_constant * x;
  const double least = 1.40 * std::pow(110, 1.263);
  const Result line = plastic < least ? Result(least) : plastic;
  return fitted < line ? Result(fitted) : line;
}

// Where that line leaves its least value, and where it takes over: beyond x = 110, ascending.
std::array<double, 2> kogut_etsion_corners(double yield_constant) {
  const double slope = 3 * kHardnessOverYield / yield_constant, least = 1.40 * std::pow(110, 1.263);
  const double leaves = least / slope, takes_over = std::pow(slope / 1.40, 1 / 0.263);
  return {std::max(110.0, std::min(leaves, takes_over)),
          std::max(110.0, std::max(leaves, takes_over))};
}

// Stronge 2000, chapter 6: beyond yield the contact's area grows as X = 2 x - 1 and its mean
// pressure as 1 + ln(X) / (3 theta), theta = 1.1, until it is 2.8 Sy.
constexpr double kStrongeYield = 1.1;

template <typename Real>
Real stronge(const Real& x) {
  if (x < 1.0) return x * sqrt(x);
  const Real area = 2.0 * x - 1.0, growing = 1.0 + log(area) / (3 * kStrongeYield);
  const Real most(kHardnessOverYield / kStrongeYield);
  return area * (growing < most ? growing : most);
}

// Where the pressure stops growing: x = 82.5.
double stronge_plastic() { return (1 + std::exp(3 * (kHardnessOverYield - kStrongeYield))) / 2; }

// int from 1 to x of it.
template <typename Real>
Real stronge_energy(const Real& x) {
  const auto growing = [](const Real& area) -> Real {
    const Real square = area * area;
    return square / 4.0 + (square * log(area) / 2.0 - square / 4.0) / (6 * kStrongeYield);
  };
  const Real end = std::min(x, Real(stronge_plastic()));
  const Real beyond = at_least(x - end, 0), area = 2.0 * end - 1.0;
  return growing(area) - growing(Real(1)) +
         kHardnessOverYield / kStrongeYield * beyond * (area + beyond);
}

// Thornton 1997: Hertz up to yield, then the slope of yield is kept: dP/dw = pi p_y R.
template <typename Real>
Real thornton(const Real& x) {
  if (x < 1.0) return x * sqrt(x);
  return 1.0 + 1.5 * (x - 1.0);
}

// Any of the loadings, over the critical force. `Result`: the kind of number that those of x, the
// yield constant and yield strength over modulus give together.
template <typename Result, typename Real, typename C, typename Y>
Result any_loading(PlasticLoading loading, const Real& x, const C& yield_constant,
                   const Y& yield_over_modulus) {
  if (loading == PlasticLoading::kThornton) return Result(thornton(x));
  if (loading == PlasticLoading::kStronge) return Result(stronge(x));
  if (loading == PlasticLoading::kKogutEtsion) return kogut_etsion<Result>(x, yield_constant);
  return jackson_green<Result>(x, yield_constant, yield_over_modulus);
}

}  // namespace

double effective_modulus_pa(double young1_pa, double poisson1, double young2_pa, double poisson2) {
  return 1 / ((1 - poisson1 * poisson1) / young1_pa + (1 - poisson2 * poisson2) / young2_pa);
}

template <typename Real>
ElasticPlasticLawOf<Real>::ElasticPlasticLawOf(const Numbers& surface, PlasticLoading loading,
                                               ResidualLaw residual)
    : surface_(surface), loading_(loading), residual_(residual) {
  ElasticPlasticSurface{value_of(surface.radius_m), value_of(surface.effective_modulus_pa),
                        value_of(surface.yield_strength_pa), value_of(surface.poisson)}
      .validate();
  yield_constant_ = loading_ == PlasticLoading::kStronge
                        ? Real(1.5 * kStrongeYield)
                        : Real(1.295 * exp(0.736 * surface_.poisson));
  const Real pressure = kPi * yield_constant_ * surface_.yield_strength_pa / 2.0;
  const Real ratio = pressure / surface_.effective_modulus_pa;
  critical_compression_m_ = ratio * ratio * surface_.radius_m;
  critical_force_n_ = 4.0 / 3 * surface_.radius_m * surface_.radius_m * ratio * ratio * pressure;
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::normalised_loading(const Real& x) const {
  return any_loading<Real>(loading_, x, yield_constant_, yield_over_modulus());
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::loading_force_n(const Real& w_m) const {
  if (!(w_m > 0)) return Real(0);
  return critical_force_n_ * normalised_loading(w_m / critical_compression_m_);
}

template <typename Real>
auto ElasticPlasticLawOf<Real>::loading_slopes(const Real& w_m) const -> LoadingSlopes {
  namespace diff = boost::math::differentiation;
  if (!(w_m > 0)) return {};
  const Real x = w_m / critical_compression_m_, scale = critical_force_n_ / critical_compression_m_;
  if constexpr (kHasDerivatives<Real>) {
    // Those by the numbers of the law as well, of each slope.
    const Real strength = yield_over_modulus();
    const auto [at, c, y] = diff::make_ftuple<double, 3, 1, 1>(
        value_of(x), value_of(yield_constant_), value_of(strength));
    using All =
        Of<std::decay_t<decltype(at)>, std::decay_t<decltype(c)>, std::decay_t<decltype(y)>>;
    const auto force = any_loading<All>(loading_, at, c, y);
    const auto slope = [&](int order) -> Real {
      return {force.derivative(order, 0, 0), force.derivative(order + 1, 0, 0) * x.v +
                                                 force.derivative(order, 1, 0) * yield_constant_.v +
                                                 force.derivative(order, 0, 1) * strength.v};
    };
    return {scale * slope(1), scale / critical_compression_m_ * slope(2)};
  } else {
    using At = decltype(diff::make_fvar<double, 2>(x));
    const At force = any_loading<At>(loading_, diff::make_fvar<double, 2>(x), yield_constant_,
                                     yield_over_modulus());
    return {scale * force.derivative(1), scale / critical_compression_m_ * force.derivative(2)};
  }
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::next_kink_m(const Real& w_m) const {
  for (const double x : {1.0, kJacksonElasticLimit, 6.0, stronge_plastic(), 110.0}) {
    // Only his law has that one; the others are smooth there.
    if (x == stronge_plastic() && loading_ != PlasticLoading::kStronge) continue;
    // A little beyond, so that who has come there is on the far side whatever the rounding.
    const Real kink_m = x * critical_compression_m_ * (1 + 1e-15);
    if (kink_m > w_m) return kink_m;
  }
  return Real(std::numeric_limits<double>::infinity());
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::residual_m(const Real& largest_m) const {
  const Real fitted = fitted_residual_m(largest_m);
  if (!(largest_m > 0)) return fitted;
  // Just above yield the fits' jumps would give back more than was put in: there the rebound is
  // elastic. released = P_m (w_m - w_r)/(n + 1) = loaded.
  const Real recovered = (unloading_exponent(largest_m) + 1.0) * loading_energy_j(largest_m) /
                         loading_force_n(largest_m);
  const Real least = largest_m - recovered;
  return least > fitted && least > 1e-13 * largest_m ? least : fitted;
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::fitted_residual_m(const Real& largest_m) const {
  const Real x = largest_m / critical_compression_m_;
  if (!(x > 1)) return Real(0);
  if (loading_ == PlasticLoading::kThornton) {
    // Unloading is Hertz over the radius R_p that gives the same contact circle at P_m.
    const Real force = thornton(x);
    const Real radius_ratio = pow((2.0 * force + 1.0) / 3.0, 1.5) / force;
    return largest_m - critical_compression_m_ * cbrt(force * force / radius_ratio);
  }
  if (loading_ == PlasticLoading::kStronge) {
    // What recovers is in proportion to the contact's radius, a^2 = (2 x - 1) a_c^2.
    return largest_m - critical_compression_m_ * sqrt(2.0 * x - 1.0);
  }
  if (residual_ == ResidualLaw::kKogutEtsion) {
    return largest_m * (1.0 - pow(x, -0.28)) * (1.0 - pow(x, -0.69));
  }
  // Jackson's fit holds from x = 1.9; below, the loading is Hertz and nothing stays.
  if (x < kJacksonElasticLimit && loading_ == PlasticLoading::kJacksonGreen) return Real(0);
  if (x <= kJacksonTurn) return largest_m * jackson_residual(x);
  // Beyond, the fit would let less recover the deeper the contact, and then exceed w_m.
  return largest_m - critical_compression_m_ * kJacksonTurn * (1 - jackson_residual(kJacksonTurn));
}

template <typename Real>
std::string ElasticPlasticLawOf<Real>::out_of_range(double largest_m) const {
  const double x = largest_m / value_of(critical_compression_m_);
  if (loading_ == PlasticLoading::kKogutEtsion && x > 110) {
    return beyond_limit("the largest deflection over the critical one", x, 110);
  }
  if (loading_ == PlasticLoading::kJacksonGreen && x > kJacksonElasticLimit) {
    const double width =
        jackson_contact_over_radius(x, value_of(yield_constant_), value_of(yield_over_modulus()));
    if (width > 0.41) return beyond_limit("the contact's radius over the body's", width, 0.41);
  }
  if (largest_m > 0.2 * value_of(surface_.radius_m)) {
    return beyond_limit("the largest deflection over the radius",
                        largest_m / value_of(surface_.radius_m), 0.2);
  }
  return "";
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::unloading_exponent(const Real& largest_m) const {
  const Real x = largest_m / critical_compression_m_;
  const bool own = loading_ == PlasticLoading::kThornton || loading_ == PlasticLoading::kStronge;
  if (own || residual_ == ResidualLaw::kJackson || x <= 1) {
    return Real(1.5);
  }
  return 1.5 * pow(x, -0.0331);
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::unloading_force_n(const Real& w_m, const Real& largest_m) const {
  return unloading_force_n(w_m, largest_m, residual_m(largest_m));
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::unloading_force_n(const Real& w_m, const Real& largest_m,
                                                  const Real& residual) const {
  if (!(w_m > residual)) return Real(0);
  return loading_force_n(largest_m) *
         pow((w_m - residual) / (largest_m - residual), unloading_exponent(largest_m));
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::loading_energy_j(const Real& w_m) const {
  if (!(w_m > 0)) return Real(0);
  const Real x = w_m / critical_compression_m_;
  Real sum = 0.4 * pow(std::min(x, Real(1)), 2.5);
  if (loading_ == PlasticLoading::kStronge) {
    if (x > 1) sum += stronge_energy(x);
  } else {
    sum += loading_work(x);
  }
  return sum * critical_force_n_ * critical_compression_m_;
}

// int from 1 to x of the loading.
template <typename Real>
Real ElasticPlasticLawOf<Real>::loading_work(const Real& x) const {
  // Integrated between the kinks, so that each piece is smooth.
  const double c = value_of(yield_constant_), y = value_of(yield_over_modulus());
  const double to = value_of(x);
  const bool kogut = loading_ == PlasticLoading::kKogutEtsion;
  const std::array<double, 2> corners = kogut ? kogut_etsion_corners(c) : std::array{110.0, 110.0};
  const std::array<double, 6> kinks{1, kJacksonElasticLimit, 6, 110, corners[0], corners[1]};
  const auto force = [&](double s) { return any_loading<double>(loading_, s, c, y); };
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
  Real sum{};
  for (std::size_t i = 0; i < kinks.size() && to > kinks[i]; ++i) {
    const bool last = i + 1 == kinks.size();
    const double end = last ? to : std::min(to, kinks[i + 1]);
    // Just inside the piece: the published fits jump at the kinks.
    const double start = std::nextafter(kinks[i], end);
    if (!(end > start)) continue;
    if (kinks[i] >= 110) {  // over decades
      const auto by_log = [&](double t) { return force(std::exp(t)) * std::exp(t); };
      sum += Real(Kronrod::integrate(by_log, std::log(start), std::log(end), 12, 1e-14));
    } else {
      sum += Real(Kronrod::integrate(force, start, std::nextafter(end, start), 12, 1e-12));
    }
    if constexpr (kHasDerivatives<Real>) {  // by the law's own numbers, at the same compressions
      using Rule = boost::math::quadrature::gauss<double, 30>;
      const double middle = (end + start) / 2, half = (end - start) / 2;
      for (std::size_t n = 0; n < Rule::abscissa().size(); ++n) {
        for (const double side : {-half, half}) {
          const Real s(middle + side * Rule::abscissa()[n]);
          sum.v += half * Rule::weights()[n] * normalised_loading(s).v;
        }
      }
    }
  }
  if constexpr (kHasDerivatives<Real>) {
    if (to > 1) sum.v += force(to) * x.v;
  }
  return sum;
}

template <typename Real>
Real ElasticPlasticLawOf<Real>::released_energy_j(const Real& largest_m) const {
  if (!(largest_m > 0)) return Real(0);
  return loading_force_n(largest_m) * (largest_m - residual_m(largest_m)) /
         (unloading_exponent(largest_m) + 1.0);
}

template <typename Real>
double ElasticPlasticLawOf<Real>::largest_compression_m(double mass_kg, double speed_m_s) const {
  const double energy = mass_kg * speed_m_s * speed_m_s / 2;
  if (!(energy > 0)) return 0;
  const auto missing = [&](double w) { return value_of(loading_energy_j(Real(w))) - energy; };
  double high = value_of(critical_compression_m_);
  while (missing(high) < 0) high *= 2;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      missing, 0.0, high, boost::math::tools::eps_tolerance<double>(50), iterations);
  return (bracket.first + bracket.second) / 2;
}

template <typename Real>
double ElasticPlasticLawOf<Real>::restitution(double mass_kg, double speed_m_s) const {
  const double largest = largest_compression_m(mass_kg, speed_m_s);
  if (!(largest > 0)) return 1;
  return std::sqrt(
      std::min(1.0, value_of(released_energy_j(Real(largest)) / loading_energy_j(Real(largest)))));
}

template class ElasticPlasticLawOf<double>;
template class ElasticPlasticLawOf<Sensitive>;

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
