// Shapes seen through a lens: a disc, and a straight edge, under a Gaussian point spread function.
// Plus the rules with which the renderer integrates over pixels and exposures.
#pragma once

#include <vector>

namespace impactdic::sim::speckle {

// Share of a Gaussian spot (standard deviation `sigma_px` per axis, centre `distance_px` from the
// disc's centre) that falls on a disc of `radius_px`: 1 − Q₁(d/σ, r/σ) with the Marcum Q function,
// that is the cdf of the noncentral χ² of two degrees of freedom (Marcum 1960). Tabulated by
// integrating its derivative (Nuttall 1975, ∂Q₁(a, b)/∂a = b e^{−(a²+b²)/2} I₁(ab))
//   ∂/∂d = −(r/σ²) exp(−(d − r)²/2σ²) · e^{−rd/σ²} I₁(rd/σ²)
// inward from where it vanishes. Absolute error below 1e-5 (a test compares with the integral).
class BlurredDisc {
 public:
  // Both lengths > 0, px. The table is made from outside inwards. `least_px`: only distances from
  // there on will be asked for. `most`: where more than that is covered it need not be known by how
  // much, and counts as 1.
  BlurredDisc(double radius_px, double sigma_px, double least_px = 0, double most = 2);

  // `distance_px` >= 0. Exactly 0 from reach_px() on, constant inside core_px().
  float operator()(double distance_px) const {
    if (distance_px >= reach_px_) return 0.0F;
    const double u = (distance_px - core_px_) * per_step_;
    if (u <= 0) return cells_.front().c0;
    const int i = static_cast<int>(u);
    const Cell& c = cells_[static_cast<std::size_t>(i)];
    const auto t = static_cast<float>(u - i);
    return ((c.c3 * t + c.c2) * t + c.c1) * t + c.c0;
  }
  // clear[i] *= 1 − coverage at the distance √squared[i], px, of `count` samples; a negative square
  // counts as 0. The same bits as one by one; the compiler makes vectors of it.
  void cover(const double* squared, int count, float* clear) const;
  double reach_px() const { return reach_px_; }
  double core_px() const { return core_px_; }

 private:
  struct Cell {
    float c0, c1, c2, c3;  // cubic in the position within the cell, 0 … 1
  };
  double core_px_, reach_px_, per_step_;
  std::vector<Cell> cells_;
};

// Share of the same spot beyond a straight edge: Φ(t/σ), t = signed distance into the shape.
double blurred_edge(double into_px, double sigma_px);

// Standard deviations beyond which a blurred edge counts as 0 or 1 (error 3e-6).
inline constexpr double kEdgeReach = 4.5;

struct Quadrature {
  std::vector<double> node;    // ascending
  std::vector<double> weight;  // sums to 1
};
// Gauss–Legendre rule of `count` >= 1 nodes on (−1/2, 1/2).
Quadrature gauss_legendre(int count);

// Mean over (−1/2, 1/2) from `taps` samples 1/per_pixel apart, symmetric about 0: the integral of
// the polynomial through them. The samples lie outside the interval too, where they serve the
// neighbouring pixels, so that a smooth picture costs per_pixel² samples a pixel at a far higher
// order than per_pixel Gauss–Legendre nodes have. `taps` − `per_pixel` must be even and >= 0.
Quadrature shared_samples(int per_pixel, int taps);

}  // namespace impactdic::sim::speckle
