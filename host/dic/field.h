// Displacement fields: what is asked for and what comes back. The same for every implementation
// (double-precision reference on the host, OpenCL kernels on a device).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernels/types.h"

namespace impactdic::dic {

// How a window's displacement is measured.
enum class FieldMethod : std::uint8_t {
  // The dissertation's section 2.2: both windows mean-free, spline interpolation with N points
  // between pixels, FFT cross-correlation of equal zero-padded windows, largest value. Biased
  // towards zero; kept so that the published numbers can be remade.
  published,
  // Template window in a larger search area, ZNCC (Lewis 1995) with the numerator by FFT, peak of
  // the spline through the correlation map. Unbiased.
  zncc,
  // ZNCC seed, then inverse-compositional Gauss–Newton on an affine warp with B-spline
  // interpolation (Pan, Li and Tong 2013).
  icgn,
};
const char* to_string(FieldMethod method);
FieldMethod parse_field_method(const std::string& name);  // throws InvalidArgument

struct FieldOptions {
  FieldMethod method = FieldMethod::icgn;
  int window_px = 15;            // interrogation window (subset), odd or even, 5 … 129
  int search_px = 8;             // largest displacement searched about the guess, each way
  int interp_points = 5;         // spline points between pixels of the published method, 0 … 9
  int spline_degree = 5;         // B-spline of the IC-GN warp: 3, 5 or 7
  int max_iterations = 30;       // of IC-GN
  double min_correlation = 0.6;  // ZNCC below which a window is low_correlation
  double min_texture = 1.0;  // rms contrast of a window, grey levels of 255, below which no_texture
  // Of IC-GN: the camera's noise (standard deviation of a pixel, grey levels of 255; 0: rounding to
  // whole grey levels alone), and the expected standard deviation of a window's displacement, px,
  // above which no_texture. What is expected is the Cramér–Rao bound of an affine window in two
  // pictures of that noise, whose own slopes are taken out of the information.
  double noise = 0;
  double max_sd_px = 0.07;
  void validate() const;  // throws InvalidArgument naming the option
};
// Variance of a pixel, grey levels of a file whose white is `full_scale`.
double pixel_variance(const FieldOptions& options, double full_scale);

// The values stand in WindowMotion::status and in files.
enum class WindowStatus : std::int32_t {
  ok = 0,
  masked = 1,           // not (wholly) on the surface to be measured
  no_texture = 2,       // too little contrast, or none that tells of both components
  low_correlation = 3,  // best ZNCC below the threshold
  at_search_edge = 4,   // the peak lies on the edge of the search area: it may be larger
  not_converged = 5,    // IC-GN left its window or ran out of iterations
  out_of_view = 6,      // the window or its search area leaves the picture
};
const char* to_string(WindowStatus status);

// Grid of windows with centres every `spacing_px`, symmetric about (cx, cy) to the nearest pixel,
// of whose pixels at least the share `inside` lies within `radius_px` of it. Row by row from the
// top; frames and guess are 0.
std::vector<Window> disc_grid(double cx_px, double cy_px, double radius_px, int window_px,
                              int spacing_px, double inside = 1);
// Grid that fills the rectangle (x, y, width, height).
std::vector<Window> rectangle_grid(int x, int y, int width, int height, int window_px,
                                   int spacing_px);

}  // namespace impactdic::dic
