#include "host/impact/evidence/path_shapes.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::impact {
namespace {

// Legendre's polynomials, from -1 to 1 within the span.
double legendre(int degree, double x) {
  double last = 1, value = x;
  if (degree == 0) return 1;
  for (int n = 1; n < degree; ++n) {
    const double next = ((2 * n + 1) * x * value - n * last) / (n + 1);
    last = value, value = next;
  }
  return value;
}

double cubic_b_spline(double x) {
  x = std::abs(x);
  if (x >= 2) return 0;
  return x >= 1 ? (2 - x) * (2 - x) * (2 - x) / 6 : 2.0 / 3 - x * x + x * x * x / 2;
}

double positive_square(double x) { return x > 0 ? x * x : 0; }
double positive_cube(double x) { return x > 0 ? x * x * x : 0; }

}  // namespace

Basis Paths::polynomial(int degree) const {
  Basis basis;
  for (int n = 0; n <= degree; ++n) {
    basis.emplace_back([this, n](double t) { return legendre(n, unit(t)); });
  }
  return basis;
}

Basis Paths::spline(int pieces) const {
  Basis basis;
  for (int n = -1; n <= pieces + 1; ++n) {
    basis.emplace_back(
        [this, n, pieces](double t) { return cubic_b_spline((unit(t) + 1) / 2 * pieces - n); });
  }
  return basis;
}

Basis Paths::circle(double rate, int harmonics) const {
  Basis basis = polynomial(1);
  for (int n = 1; n <= harmonics; ++n) {
    basis.emplace_back([this, n, rate](double t) { return std::cos(n * rate * (t - middle_)); });
    basis.emplace_back([this, n, rate](double t) { return std::sin(n * rate * (t - middle_)); });
  }
  return basis;
}

Basis Paths::released(double at) const {
  Basis basis = polynomial(2);
  basis.emplace_back([at](double t) { return positive_square(t - at); });
  return basis;
}

Basis Paths::broken(int pieces, double more, bool constant) const {
  Basis basis = polynomial(2);
  const double first = static_cast<double>(span_.first) - more;
  const double width = (static_cast<double>(span_.last) + more - first) / pieces;
  for (int n = 0; n < pieces - (constant ? 0 : 1); ++n) {
    const double from = first + n * width;
    basis.emplace_back([=](double t) {
      const double x = (t - from) / width;
      if (constant) return positive_square(x) - positive_square(x - 1);
      return positive_cube(x) - 2 * positive_cube(x - 1) + positive_cube(x - 2);
    });
  }
  return basis;
}

Basis Paths::pulse(double first, double last, int most_waves, bool with_step) const {
  Basis basis = polynomial(2);
  const double width = last - first;
  for (int waves = with_step ? 0 : 1; waves <= most_waves; ++waves) {
    basis.emplace_back([=](double t) {
      if (t <= first) return 0.0;
      const double x = std::min((t - first) / width, 1.0), w = waves * kPi;
      const double on = std::max(t - last, 0.0) / width;
      if (waves == 0) return x * x / 2 + on;
      const double speed = waves % 2 == 0 ? 0 : 2 / w;  // at the end
      return x < 1 ? x / w - std::sin(w * x) / (w * w) : 1 / w + on * speed;
    });
  }
  return basis;
}

}  // namespace impactdic::impact
