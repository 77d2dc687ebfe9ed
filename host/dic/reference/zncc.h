// Zero-mean normalised cross-correlation by its definition, in double precision.
#pragma once

#include <impactdic/image.h>

#include "host/dic/field.h"

namespace impactdic::dic {

// Displacement of `window` from picture `first` to picture `second` (equal sizes; grey levels of
// the file, white being `full_scale`): ZNCC at every lag by direct sums, highest value, highest
// point of the quintic spline through the PEAK_PATCH_PX² values about it. `window.first` and
// `window.second` are not looked at.
WindowMotion zncc_reference(ImageView<const float> first, ImageView<const float> second,
                            const Window& window, const FieldOptions& options, double full_scale);

// A result that holds only a status and a correlation; all else NaN.
WindowMotion without_motion(WindowStatus status, double correlation);

// The rms contrast below which a window has no texture, in grey levels of the file.
double min_contrast(const FieldOptions& options, double full_scale);

// Highest value of `map` (row-major, `width` entries a row) that is at least its eight neighbours
// and more than 2 entries from (x, y) along one axis, among columns x0 … x1 and rows y0 … y1; −2
// where there is none.
double second_peak(const std::vector<double>& map, int width, int x0, int x1, int y0, int y1, int x,
                   int y);

// Highest peak over the second, at most 1000.
double peak_ratio(double highest, double second);

}  // namespace impactdic::dic
