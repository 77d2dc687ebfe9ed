#include "host/circle/rim/blurred_edge.h"

#include <impactdic/units.h>

#include <array>
#include <cmath>
#include <utility>

namespace impactdic::circle {
namespace {

constexpr int kNodes = 16;
typedef std::array<std::pair<double, double>, kNodes> Nodes;

// Places and weights of Catmull and Rom's cubic, for sums instead of integrals over it.
Nodes kernel_nodes() {
  Nodes at;
  double sum = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double u = (i + 0.5) * 4 / kNodes - 2, d = std::abs(u);
    const double h = d < 1 ? (1.5 * d - 2.5) * d * d + 1 : ((2.5 - 0.5 * d) * d - 4) * d + 2;
    at[i] = {u, h};
    sum += h;
  }
  for (auto& node : at) node.second /= sum;
  return at;
}

}  // namespace

BlurredEdge blurred_edge(double excess, double sigma, double kernel) {
  static const Nodes nodes = kernel_nodes();
  BlurredEdge e{SampleVector::Zero(), SampleVector::Zero(), SampleVector::Zero()};
  for (int k = 0; k < kSamples; ++k) {
    for (const auto& [u, h] : nodes) {
      const double z = (k - kInside - excess - kernel * u) / sigma;
      const double density = h * std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
      e.level[k] += h * 0.5 * std::erfc(z / std::sqrt(2.0));
      e.shift[k] += density / sigma;
      e.wider[k] += density * z;
    }
  }
  return e;
}

}  // namespace impactdic::circle
