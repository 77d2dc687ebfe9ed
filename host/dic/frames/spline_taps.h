// Numbers that belong to a B-spline interpolation: the impulse response of its prefilter and the
// noise that it passes on.
#pragma once

#include <array>
#include <vector>

namespace impactdic::dic {

// Throws InvalidArgument unless degree is 3, 5 or 7 and the smoothing lies in 0 … 3 px.
void check_spline(int degree, double presmooth_sigma_px);

// A Gaussian sampled at whole pixels, of sum 1: weights of distance 0 … ⌈4σ⌉. σ = 0: {1}.
std::vector<double> gaussian_taps(double sigma_px);

// Impulse response at distances 0, 1, … of the filter that turns samples into coefficients of the
// B-spline of `degree` through them (Unser, Aldroubi and Eden 1993) after smoothing by the
// Gaussian. Cut where the magnitudes beyond sum to less than `tolerance`: the largest error of a
// coefficient, relative to the largest sample.
std::vector<double> prefilter_taps(int degree, double presmooth_sigma_px, double tolerance = 1e-8);

// Variance of the smoothed spline at t between pixels along one axis, for white noise of variance
// 1 in the samples, as A + B c + C c² with c = cos 2πt: {A, B, C}. Exact at t = 0, 1/4 and 1/2; a
// test bounds the rest by 0.3 %.
std::array<double, 3> interpolation_noise(int degree, double presmooth_sigma_px);

// Between pixels, and in its slopes, a spline errs as if hard edges stood elsewhere by this.
inline constexpr double kInterpolationPx = 0.02;

// Variance of a slope at a pixel in units of the variance of the picture's noise.
double slope_noise(int degree);

}  // namespace impactdic::dic
