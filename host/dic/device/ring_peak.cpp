#include <impactdic/error.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "host/dic/device/ring.h"
#include "host/dic/frames/spline_taps.h"

namespace impactdic::dic {
namespace {

constexpr double kPi = std::numbers::pi;
// Correlations nearer than this to the peak belong to it.
constexpr double kOtherPeakRad = 3 * kPi / 180;

// Σ cross[k] exp(ikφ) / angles over −angles/2 < k < angles/2, and its first two derivatives.
struct Polynomial {
  double value = 0, slope = 0, curvature = 0;
};
Polynomial evaluate(const RingSpectrum& spectrum, double angle_rad) {
  const std::size_t angles = spectrum.cross.size();
  const std::complex<double> turn = std::polar(1.0, angle_rad);
  std::complex<double> phase = 1;
  Polynomial sum;
  for (std::size_t k = 1; k < (angles + 1) / 2; ++k) {
    phase *= turn;
    // Both signs of k are conjugates: twice the real part.
    const std::complex<double> term = std::complex<double>(spectrum.cross[k]) * phase;
    const auto order = static_cast<double>(k);
    sum.value += 2 * term.real();
    sum.slope -= 2 * order * term.imag();
    sum.curvature -= 2 * order * order * term.real();
  }
  const auto count = static_cast<double>(angles);
  return {sum.value / count, sum.slope / count, sum.curvature / count};
}

double wrap(double angle_rad) { return std::remainder(angle_rad, 2 * kPi); }

std::size_t highest(const RingSpectrum& spectrum) {
  std::size_t best = 0;
  for (std::size_t j = 1; j < spectrum.correlation.size(); ++j) {
    if (spectrum.correlation[j].real() > spectrum.correlation[best].real()) best = j;
  }
  return best;
}

double second_highest(const RingSpectrum& spectrum, double angle_rad) {
  const auto count = static_cast<double>(spectrum.correlation.size());
  double second = 0;
  for (std::size_t j = 0; j < spectrum.correlation.size(); ++j) {
    if (std::abs(wrap(2 * kPi * static_cast<double>(j) / count - angle_rad)) < kOtherPeakRad) {
      continue;
    }
    second = std::max(second, static_cast<double>(spectrum.correlation[j].real()));
  }
  return second;
}

// From the residual and Σ (∂f/∂θ)²: see BallRegistration, whose only parameter this is. All sums
// are over samples weighted by their radius, which stands for pixels of area r Δr Δθ.
double deviation(const RingSpectrum& spectrum, double peak, double energy_first,
                 double energy_second, const RingTask& task, const RingOptions& options) {
  const auto angles = static_cast<double>(options.angles);
  const double spacing = (task.outer - task.inner) / options.rings;
  double slopes = 0;
  for (std::size_t k = 1; k < (spectrum.energy.size() + 1) / 2; ++k) {
    slopes += 2 * static_cast<double>(k * k) * spectrum.energy[k].real() / angles;
  }
  const double area_element = spacing * 2 * kPi / angles;
  double radii = 0;
  for (int ring = 0; ring < options.rings; ++ring) radii += task.inner + spacing * (ring + 0.5);
  const double gain = std::sqrt(energy_second / energy_first);
  const double residual = energy_first + energy_second / (gain * gain) - 2 * peak / gain;
  // Every position between pixels is as frequent: mean of A + B c + C c², for each axis.
  const auto noise = interpolation_noise(options.spline_degree, options.presmooth_sigma_px);
  const double passed = std::pow(noise[0] + noise[2] / 2, 2);
  const double variance =
      std::max(std::max(residual, 0.0) / (radii * angles) / (2 * passed), 1.0 / 12);
  return std::sqrt(2 * variance / (slopes * area_element));
}

}  // namespace

void RingOptions::validate() const {
  check_spline(spline_degree, presmooth_sigma_px);
  if (rings < 1) throw InvalidArgument("the ball must be sampled on at least one ring");
  if (angles < 16 || opencl::FftPlan::good_size(static_cast<std::size_t>(angles)) !=
                         static_cast<std::size_t>(angles)) {
    throw InvalidArgument("samples of a ring must be 16 or more and a product of small primes");
  }
}

RingMotion ring_peak(const RingSpectrum& spectrum, const RingTask& task,
                     const RingOptions& options) {
  RingMotion motion;
  const auto count = static_cast<double>(spectrum.cross.size());
  double energy_first = 0, energy_second = 0;
  for (const auto& energy : spectrum.energy) {
    energy_first += energy.real() / count;
    energy_second += energy.imag() / count;
  }
  motion.rot_rad = motion.rot_sd_rad = std::numeric_limits<double>::quiet_NaN();
  if (!(energy_first > 0 && energy_second > 0)) {
    motion.status = WindowStatus::kNoTexture;
    return motion;
  }
  const double step = 2 * kPi / count;
  const double start = step * static_cast<double>(highest(spectrum));
  double angle = start;
  Polynomial at = evaluate(spectrum, angle);
  for (int iteration = 0; iteration < 20 && at.curvature < 0; ++iteration) {
    const double move = -at.slope / at.curvature;
    angle += move;
    at = evaluate(spectrum, angle);
    if (std::abs(move) < 1e-10) break;
  }
  if (!(at.curvature < 0) || std::abs(angle - start) > step) {
    motion.status = WindowStatus::kNotConverged;
    return motion;
  }
  motion.correlation = at.value / std::sqrt(energy_first * energy_second);
  const double second = second_highest(spectrum, angle);
  motion.peak_ratio = second > 0.001 * at.value ? at.value / second : 1000;
  if (motion.correlation < options.min_correlation) {
    motion.status = WindowStatus::kLowCorrelation;
    return motion;
  }
  motion.rot_rad = wrap(angle);
  motion.rot_sd_rad = deviation(spectrum, at.value, energy_first, energy_second, task, options);
  return motion;
}

}  // namespace impactdic::dic
