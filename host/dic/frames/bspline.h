// B-spline interpolation in double precision by the textbook's definitions: the reference of
// kernels/spline.h and kernels/frames/prefilter.cl, with which it shares no formula.
#pragma once

#include <impactdic/image.h>

#include <array>

namespace impactdic::dic {

// Weights of the degree + 1 coefficients from floor(x) − (degree − 1)/2 on, t = x − floor(x), by
// the Cox–de Boor recursion. Elements beyond `degree` are 0.
std::array<double, 8> bspline_weights(int degree, double t);
// Their derivatives by t.
std::array<double, 8> bspline_slopes(int degree, double t);

// A picture as a spline, mirrored beyond its border.
class BSplineImage {
 public:
  struct Sample {
    double value, slope_x, slope_y;
  };
  BSplineImage() = default;
  // Coefficients by the recursive filter of Unser, Aldroubi and Eden (1993), after smoothing by a
  // sampled Gaussian. Throws InvalidArgument as check_spline does.
  BSplineImage(const Image<double>& picture, int degree, double presmooth_sigma_px = 0);

  int width() const { return coefficients_.width(); }
  int height() const { return coefficients_.height(); }
  double coefficient(int x, int y) const;  // mirrored beyond the border
  double value(double x_px, double y_px) const;
  Sample sample(double x_px, double y_px) const;

 private:
  int degree_ = 5;
  Image<double> coefficients_;
};

// The frame's grey levels; (height, width).
Image<double> to_double(const Frame& frame);

}  // namespace impactdic::dic
