#include "host/dic/device/ring.h"

#include <impactdic/error.h>

#include <cmath>
#include <numbers>

#include "host/dic/frames/bspline.h"

namespace impactdic::dic {

RingMotion ring_reference(const Frame& first, const Frame& second, const RingTask& task,
                          const RingOptions& options) {
  options.validate();
  const BSplineImage f(to_double(first), options.spline_degree, options.presmooth_sigma_px);
  const BSplineImage g(to_double(second), options.spline_degree, options.presmooth_sigma_px);
  const auto angles = static_cast<std::size_t>(options.angles);
  const double step = 2 * std::numbers::pi / options.angles;
  std::vector<std::complex<double>> roots(angles);
  for (std::size_t k = 0; k < angles; ++k) {
    roots[k] = std::polar(1.0, step * static_cast<double>(k));
  }
  std::vector<std::complex<double>> cross(angles);
  std::vector<std::complex<float>> energy(angles), cross_float(angles), correlation(angles);
  std::vector<double> along_f(angles), along_g(angles);
  for (int ring = 0; ring < options.rings; ++ring) {
    const double radius = task.inner + (task.outer - task.inner) * (ring + 0.5) / options.rings;
    for (std::size_t k = 0; k < angles; ++k) {
      const double x = radius * roots[k].real(), y = -radius * roots[k].imag();
      along_f[k] = f.value(task.cx_first + x, task.cy_first + y);
      along_g[k] = g.value(task.cx_second + x, task.cy_second + y);
    }
    for (std::size_t k = 1; k < angles; ++k) {
      std::complex<double> transform_f = 0, transform_g = 0;
      for (std::size_t j = 0; j < angles; ++j) {
        const std::complex<double> root = std::conj(roots[j * k % angles]);
        transform_f += along_f[j] * root;
        transform_g += along_g[j] * root;
      }
      cross[k] += radius * std::conj(transform_f) * transform_g;
      energy[k] += std::complex<float>(static_cast<float>(radius * std::norm(transform_f)),
                                       static_cast<float>(radius * std::norm(transform_g)));
    }
  }
  for (std::size_t j = 0; j < angles; ++j) {
    std::complex<double> sum = 0;
    for (std::size_t k = 0; k < angles; ++k) sum += cross[k] * roots[j * k % angles];
    correlation[j] = std::complex<float>(sum / static_cast<double>(angles));
    cross_float[j] = std::complex<float>(cross[j]);
  }
  return ring_peak({cross_float, energy, correlation}, task, options);
}

}  // namespace impactdic::dic
