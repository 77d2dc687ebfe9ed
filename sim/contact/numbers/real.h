// The numbers that laws and motion compute with: a double, or a double with its derivatives.
//
// The same code serves both. Where it chooses (a comparison, the size of a step) the value decides,
// and the derivatives are those of the branch that was taken.
#pragma once

#include <ceres/jet.h>

#include <array>
#include <cmath>
#include <type_traits>

namespace impactdic::sim::contact {

// Derivatives by so many inputs at once, and by time along the motion.
inline constexpr int kInputsAtOnce = 7;
inline constexpr int kByTime = kInputsAtOnce;
using Sensitive = ceres::Jet<double, kInputsAtOnce + 1>;

template <typename Real>
inline constexpr bool kHasDerivatives = std::is_same_v<Real, Sensitive>;

// How a law is given one.
template <typename Real>
using In = std::conditional_t<kHasDerivatives<Real>, const Real&, Real>;

// Those of a Sensitive are found by its arguments.
using std::abs, std::cbrt, std::copysign, std::cos, std::exp, std::hypot, std::log, std::pow,
    std::sin, std::sqrt;

inline double value_of(double number) { return number; }
inline double value_of(const Sensitive& number) { return number.a; }

template <typename Real, std::size_t N>
std::array<double, N> values_of(const std::array<Real, N>& numbers) {
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) values[i] = value_of(numbers[i]);
  return values;
}

// A time a while after another one, which moves with that as an input changes.
inline double later(double, double value) { return value; }
inline Sensitive later(const Sensitive& moment, double value) { return {value, moment.v}; }

// The square root. At zero, where its slope is infinite, it has none: what is zero there stays so.
inline double root(double number) { return std::sqrt(number); }
inline Sensitive root(const Sensitive& number) {
  return number.a > 0 ? ceres::sqrt(number) : Sensitive(std::sqrt(number.a));
}

// The number itself, of both kinds, where std::max and std::min ask for one type.
template <typename Real>
Real at_least(const Real& number, double least) {
  return number < least ? Real(least) : number;
}

}  // namespace impactdic::sim::contact
