// Equal windows: circular cross-correlation of mean-free windows of FFT_PX = 16 or 32, each value
// over the share of the windows that overlaps at its lag, and the Gaussian through the highest one
// and its neighbours (Westerweel 1997). Two windows a group, everything in one kernel.
#include "kernels/config.h"
#include "kernels/motion.h"
#include "kernels/pair.h"

#define PIXELS ((float)(FFT_PX * FFT_PX))
// The highest value and its neighbours left, right, above, below.
#define CROSS 5

typedef struct Place {
  int first, second;  // of the window's first pixel in the pictures
  int in_view;
} Place;

INLINE Place place_of(const Window window, const int width, const int height) {
  const int x1 = add_sat(window.x0, window.guess_u), y1 = add_sat(window.y0, window.guess_v);
  const int most_x = width - FFT_PX, most_y = height - FFT_PX;
  Place place;
  place.in_view = min(min(window.x0, window.y0), min(x1, y1)) >= 0 &&
                  max(window.x0, x1) <= most_x && max(window.y0, y1) <= most_y;
  place.first = place.in_view ? (window.first * height + window.y0) * width + window.x0 : 0;
  place.second = place.in_view ? (window.second * height + y1) * width + x1 : 0;
  return place;
}

#if VECTOR == 1
#define PIXELS_AT(p) ((float)*(p))
#else
#define PIXELS_AT(p) PASTE(convert_float, VECTOR)(LOAD(p))
#endif

// Columns x … of two windows, in fft_order. The pixels need not be mean-free: sums of integers are
// exact.
INLINE void get_windows(REAL* re, REAL* im, __global const PIXEL* a, __global const PIXEL* b,
                        const int width, const int x) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int at = fft_order(p, FFT_PX) * ROW + x;
    re[p] = PIXELS_AT(a + at);
    im[p] = PIXELS_AT(b + at);
  }
}

// What the rows y … give to a window's energy, times 2 · PIXELS, by Parseval's theorem; without the
// mean, which is frequency 0 of rows 0.
INLINE REAL row_energy(const REAL* re, const REAL* im, const int y) {
  const INTEGER packed = (y + COLUMN_NUMBERS) % HALF_PX == 0;
  const REAL mean = packed ? (REAL)(0.0f) : re[0];
  REAL sum = mean * mean + im[0] * im[0];
  UNROLL
  for (int k = 1; k < FFT_PX; ++k) sum += re[k] * re[k] + im[k] * im[k];
  return packed ? 2.0f * sum : sum;
}

// Columns x … of the correlation, re: of A, im: of B, into a plane, and their highest values.
INLINE void put_correlation(const REAL* re, const REAL* im, __local float* plane,
                            __local float* highest, const int x) {
  REAL most_a = re[0], most_b = im[0];
  UNROLL
  for (int y = 0; y < FFT_PX; ++y) {
    PUT(plane, x, y, re[y], im[y]);
    most_a = fmax(most_a, re[y]);
    most_b = fmax(most_b, im[y]);
  }
  PUT_VALUES(most_a, highest + x);
  PUT_VALUES(most_b, highest + FFT_PX + x);
}

INLINE void put_windows(__global const PIXEL* a, __global const PIXEL* b, const int width,
                        __local float* plane, const int lane) {
  for (int block = 0; block < BLOCKS; ++block) {
    REAL re[FFT_PX], im[FFT_PX];
    get_windows(re, im, a, b, width, COLUMN(block));
    put_column_spectra(re, im, plane, COLUMN(block));
  }
}

// Correlation of a pair of windows, times PAIR_SCALE: part 0 of the plane for A, part 1 for B.
// energies: those of the first windows by row, then those of the second. highest: the highest value
// of each column. f_plane: scratch, the plane itself where a work-item has one
// block. Passes barriers.
INLINE void correlate_pair(__global const PIXEL* pixels, const Place a, const Place b,
                           const int width, __local float* plane, __local float* f_plane,
                           __local float* energies, __local float* highest, const int lane) {
  REAL f_re[FFT_PX], f_im[FFT_PX], g_re[FFT_PX], g_im[FFT_PX], re[FFT_PX], im[FFT_PX];
  put_windows(pixels + a.first, pixels + b.first, width, plane, lane);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int block = 0; block < BLOCKS; ++block) {
    const int y = COLUMN(block);
    get_row_spectra(f_re, f_im, plane, y);
    PUT_VALUES(row_energy(f_re, f_im, y), energies + y);
#if BLOCKS > 1
    for (int k = 0; k < FFT_PX; ++k) PUT(f_plane, y, k, f_re[k], f_im[k]);
#endif
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  put_windows(pixels + a.second, pixels + b.second, width, plane, lane);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int block = 0; block < BLOCKS; ++block) {
    const int y = COLUMN(block);
    get_row_spectra(g_re, g_im, plane, y);
    PUT_VALUES(row_energy(g_re, g_im, y), energies + FFT_PX + y);
#if BLOCKS > 1
    for (int k = 0; k < FFT_PX; ++k) GET(f_plane, y, k, f_re[k], f_im[k]);
#endif
    row_product(f_re, f_im, g_re, g_im, re, im, y);
    ALL_HAVE_READ;
    put_rows_back(re, im, f_plane, y);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
    get_correlated_columns(re, im, f_plane, x);
    ALL_HAVE_READ;
    put_correlation(re, im, plane, highest, x);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

INLINE int lag_of(const int at) { return at < HALF_PX ? at : at - FFT_PX; }

// A window's peak: where its highest value stands (of equal ones the leftmost, of those the
// topmost), that value and its neighbours over the overlap.
typedef struct Peak {
  int x, y;
  float cross[CROSS];
} Peak;

// Peaks of both windows of a pair; their x and y must have been set to FFT_PX. Passes barriers.
INLINE void find_peaks(__local const float* plane, __local const float* highest,
                       __local Peak* peaks, const int lane) {
  float most[2];
  UNROLL
  for (int which = 0; which < 2; ++which) {
    float4 values = vload4(0, highest + which * FFT_PX);
    UNROLL
    for (int k = 1; k < FFT_PX / 4; ++k) values = fmax(values, vload4(k, highest + which * FFT_PX));
    most[which] = fmax(fmax(values.x, values.y), fmax(values.z, values.w));
    for (int x = lane; x < FFT_PX; x += LANES) {
      if (highest[which * FFT_PX + x] == most[which]) atomic_min(&peaks[which].x, x);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  UNROLL
  for (int which = 0; which < 2; ++which) {
    for (int y = lane; y < FFT_PX; y += LANES) {
      if (AT(plane, which, peaks[which].x, y) == most[which]) atomic_min(&peaks[which].y, y);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = lane; k < 2 * CROSS; k += LANES) {
    const int which = k / CROSS, arm = k % CROSS;
    const int x = (peaks[which].x + FFT_PX + (arm == 2) - (arm == 1)) % FFT_PX;
    const int y = (peaks[which].y + FFT_PX + (arm == 4) - (arm == 3)) % FFT_PX;
    const float overlap = (float)((FFT_PX - abs(lag_of(x))) * (FFT_PX - abs(lag_of(y))));
    peaks[which].cross[arm] = AT(plane, which, x, y) * (PIXELS / PAIR_SCALE) / overlap;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// energies: of its rows in the first picture, FFT_PX further on in the second.
INLINE WindowMotion motion_of(const Window window, const int in_view, __local const Peak* peak,
                              __local const float* energies, const float min_contrast,
                              const float min_correlation) {
  float f_energy = 0.0f, g_energy = 0.0f;
  for (int k = 0; k < HALF_PX; ++k) {
    f_energy += energies[k] * (0.5f / PIXELS);
    g_energy += energies[FFT_PX + k] * (0.5f / PIXELS);
  }
  const float centre = peak->cross[0];
  const float correlation = fmin(centre / (sqrt(f_energy) * sqrt(g_energy)), 1.0f);
  const int lag_x = lag_of(peak->x), lag_y = lag_of(peak->y);
  float shift[2], bend[2];
  int is_peak = 1;
  UNROLL
  for (int axis = 0; axis < 2; ++axis) {
    const float before = peak->cross[1 + 2 * axis] / centre;
    const float after = peak->cross[2 + 2 * axis] / centre;
    const float left = log(before), right = log(after);
    bend[axis] = -(left + right);
    shift[axis] = 0.5f * (right - left) / bend[axis];
    is_peak &= before > 0.0f && after > 0.0f && bend[axis] > 0.0f;
  }
  const float least = min_contrast * min_contrast * PIXELS;
  const int status = !in_view                                 ? STATUS_OUT_OF_VIEW
                     : fmin(f_energy, g_energy) < least       ? STATUS_NO_TEXTURE
                     : lag_x == -HALF_PX || lag_y == -HALF_PX ? STATUS_AT_SEARCH_EDGE
                     : correlation < min_correlation          ? STATUS_LOW_CORRELATION
                     : !is_peak                               ? STATUS_NOT_CONVERGED
                                                              : STATUS_OK;
  WindowMotion motion = no_motion(status, correlation);
  if (status != STATUS_OK) return motion;
  // As in peak.cl, with the Gaussian's bend; u and v apart.
  const float residual = 2.0f * (1.0f - correlation) / (PIXELS - 4.0f);
  motion.u = (float)(window.guess_u + lag_x) + shift[0];
  motion.v = (float)(window.guess_v + lag_y) + shift[1];
  motion.u_sd = sqrt(residual / (correlation * bend[0]));
  motion.v_sd = sqrt(residual / (correlation * bend[1]));
  motion.ux = motion.uy = motion.vx = motion.vy = 0.0f;
  return motion;
}

// pixels: (slots, height, width), each slot a picture; windows, motions: (count), these written. A
// group of LANES measures 2 · PAIRS windows and ends with one window a work-item. FFT_PX ≤ width,
// height; a batch's pixels are at most 2³¹.
__kernel GROUP_SIZE void equal_windows(__global const PIXEL* pixels, const int width,
                                       const int height, __global const Window* windows,
                                       const uint count, const float min_contrast,
                                       const float min_correlation,
                                       __global WindowMotion* motions) {
  __local float plane[2 * PLANE] __attribute__((aligned(16)));
#if BLOCKS == 1
  __local float* f_plane = plane;
#else
  __local float f_plane[2 * PLANE];
#endif
  __local float highest[2 * FFT_PX] __attribute__((aligned(16)));
  __local float energies[PAIRS][2 * FFT_PX];
  __local Peak peaks[2 * PAIRS];
  const int lane = (int)get_local_id(0);
  const uint begin = 2 * PAIRS * (uint)get_group_id(0);
  for (int k = lane; k < 2 * PAIRS; k += LANES) peaks[k].x = peaks[k].y = FFT_PX;
  for (uint pair = 0; pair < PAIRS && begin + 2 * pair < count; ++pair) {
    const uint at = begin + 2 * pair;
    const Place a = place_of(windows[at], width, height);
    const Place b = place_of(windows[min(at + 1, count - 1)], width, height);
    correlate_pair(pixels, a, b, width, plane, f_plane, energies[pair], highest, lane);
    find_peaks(plane, highest, peaks + 2 * pair, lane);
  }
  for (uint k = (uint)lane; k < 2 * PAIRS && begin + k < count; k += LANES) {
    const Window window = windows[begin + k];
    motions[begin + k] =
        motion_of(window, place_of(window, width, height).in_view, peaks + k,
                  energies[k / 2] + k % 2 * HALF_PX, min_contrast, min_correlation);
  }
}
