// Free flight in a measured motion: which frames lie on it, and its velocities.
#pragma once

#include <cstddef>
#include <vector>

namespace impactdic::sim::rod {

// A polynomial in (time - reference_s) by least squares.
struct PolynomialFit {
  std::vector<double> coefficients;  // lowest power first
  std::vector<double> cofactor;      // their covariance for unit noise, row-major
  double reference_s = 0;
  double rms = 0;  // of the residuals, degrees of freedom taken off
  std::size_t count = 0;

  double at(double time_s) const;
  double slope_at(double time_s) const;
  // Variance of at(time_s) for unit noise.
  double leverage(double time_s) const;
  double cofactor_at(std::size_t i, std::size_t j) const {
    return cofactor[i * coefficients.size() + j];
  }
};

// Through the frames first..last, those with NaN left out. Fewer than degree + 1 frames: `count`
// says so and the coefficients are zero.
PolynomialFit fit_polynomial(const std::vector<double>& time_s, const std::vector<double>& value,
                             std::size_t first, std::size_t last, std::size_t degree,
                             double reference_s);

// Noise of one frame (one standard deviation) from third differences, variance 20 sigma^2: smooth
// motion has none, and the median does not see an impact. At least `least`.
double frame_noise(const std::vector<double>& value, double least);

// A coordinate that is straight in free flight (gravity's parabola taken off), and its noise.
struct FlightChannel {
  std::vector<double> value;
  double noise = 0;
};

class FreeFlight {
 public:
  FreeFlight(const std::vector<double>& time_s, std::vector<FlightChannel> channels)
      : time_s_(time_s), channels_(std::move(channels)) {}

  // Whether `frame` lies within five standard deviations, in every channel, of the line through
  // first..last. A frame without a measurement does not speak against it.
  bool continues(std::size_t first, std::size_t last, std::size_t frame) const;
  // Widens first..last frame by frame, down to `lowest` and up to `highest`, while it continues.
  void widen_down(std::size_t& first, std::size_t last, std::size_t lowest) const;
  void widen_up(std::size_t first, std::size_t& last, std::size_t highest) const;

 private:
  const std::vector<double>& time_s_;
  std::vector<FlightChannel> channels_;
};

}  // namespace impactdic::sim::rod
