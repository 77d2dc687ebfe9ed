// Displacement fields: what is asked for and what comes back. The same for every implementation
// (double-precision reference on the host, OpenCL kernels on a device).
#pragma once

#include <impactdic/field.h>

#include <vector>

#include "kernels/types.h"

namespace impactdic::dic {

// Variance of a pixel, grey levels of a file whose white is `full_scale`.
double pixel_variance(const FieldOptions& options, double full_scale);

// Where IC-GN is to start: the displacement of a window's centre, px.
WindowMotion seed_at(double u_px, double v_px);

// Grid of windows with centres every `spacing_px`, symmetric about (cx, cy) to the nearest pixel,
// of whose pixels at least the share `inside` lies within `radius_px` of it. Row by row from the
// top; frames and guess are 0.
std::vector<Window> disc_grid(double cx_px, double cy_px, double radius_px, int window_px,
                              int spacing_px, double inside = 1);
// Grid that fills the rectangle (x, y, width, height).
std::vector<Window> rectangle_grid(int x, int y, int width, int height, int window_px,
                                   int spacing_px);

}  // namespace impactdic::dic
