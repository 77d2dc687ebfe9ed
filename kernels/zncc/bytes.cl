// Zero-mean normalised cross-correlation (Lewis 1995) of a window of 8-bit pixels with a search
// area in one kernel, without transforms: Σ t g at every lag as products of matrices of bytes
// (byte_products.h), and the sums over each displaced window g in whole numbers, so that nothing is
// rounded before the map. One group of 32 work-items a window; WINDOW_PX ≤ 31, LAGS ≤ 33.
//
// Pixels are taken about their middle, 128, to be signed bytes. With q, the template's mean
// rounded:
//   Σ (t − t̄)(g − ḡ) = Σ t g − q Σ g − (t̄ − q) Σ g,  Σ (g − ḡ)² = Σ (g − q)² − (Σ (g − q))²/N,
// where every sum but the last terms is a whole number.
//
// A template that is turned first has no 8-bit pixels: they are rounded to parts of TURNED_PARTS of
// a grey level and lessened by their mean, 16 bits, which are two bytes and two passes.
#include "kernels/config.h"
#define MAP_SPACE __local
#include "kernels/zncc/byte_products.h"
#include "kernels/zncc/map_peaks.h"

// Cubic convolution of 0 … 255 stays within −72 … 327: 399 · 80 fits into two signed bytes.
#define TURNED_PARTS 80

// Sums down a column of a window, of pixels and of their squares, in one word each: the pixels are
// in the upper bits. 31 · 128² < 2^19.
#define SQUARE_BITS 19
#define SUM_PITCH (AREA_PX | 1)
#define SUM_WORDS (LAGS * SUM_PITCH)
#define COLUMN_SETS ((AREA_PX + LANES - 1) / LANES)

#define STORE_WORDS (AREA_WORDS + TAP_WORDS > SUM_WORDS ? AREA_WORDS + TAP_WORDS : SUM_WORDS)
#define MAP_FLOATS (LAGS > WINDOW_PX ? LAGS * LAGS : WINDOW_PIXELS)

// Sums of a template's pixels, and of the squares of their low bytes, of their high bytes and of
// the products of both: a pixel is 256 high + low.
enum { SUM, LOW_LOW, HIGH_HIGH, HIGH_LOW, TOTALS };

INLINE void put_area(const Task* task, const int width, const int height, __local uint* area,
                     const int lane) {
  const SearchPlace place = task->place;
  if (place.x0 >= 0 && place.y0 >= 0 && place.x0 <= width - AREA_PX &&
      place.y0 <= height - AREA_PX) {
    const int words = 4 * AREA_CHUNKS, word = lane % words;
    const Pixels pixels =
        pixels_from(task->second + (place.y0 + lane / words) * ROW + place.x0 + 4 * word);
    UNROLL
    for (int i = 0; i < AREA_PX * words; i += LANES) {
      const int y = i / words + lane / words;
      if (y < AREA_PX) area[y * AREA_PITCH + word] = four_pixels(pixels, width, i / words);
    }
    return;
  }
  __local char* bytes = (__local char*)area;
  for (int k = lane; k < AREA_PX * AREA_PX; k += LANES) {
    const int x = k % AREA_PX, y = k / AREA_PX;
    const float pixel = clamped_pixel(task->second, width, height, place.x0 + x, place.y0 + y);
    bytes[y * 4 * AREA_PITCH + x] = (char)((int)pixel - MIDDLE);
  }
}

// The template as it stands in the picture, zero about it; adds to its totals.
INLINE void put_window(const Task* task, const int width, __local uint* window, __local int* totals,
                       const int lane) {
  const int words = 4 * TAP_CHUNKS, word = lane % words;
  const Pixels pixels = pixels_from(task->first + (task->window.y0 + lane / words) * ROW +
                                    task->window.x0 + 4 * word);
  // Bits behind the window's last column.
  const uint behind = 8 * (uint)clamp(4 * word + 4 - WINDOW_PX, 0, 3);
  int sum = 0, squares = 0;
  UNROLL
  for (int i = 0; i < TAP_ROWS * words; i += LANES) {
    const int y = i / words + lane / words;
    uint four = 0;
    if (y < WINDOW_PX && 4 * word < WINDOW_PX) {
      four = four_pixels(pixels, width, i / words) << behind >> behind;
    }
    if (y < TAP_ROWS) window[y * TAP_PITCH + TAP_MARGIN + word] = four;
    sum = add_dot(four, 0x01010101u, sum);
    squares = add_dot(four, four, squares);
  }
  atomic_add(&totals[SUM], sum);
  atomic_add(&totals[LOW_LOW], squares);
}

INLINE void clear_margins(__local uint* window, const int lane) {
  for (int k = lane; k < 2 * TAP_ROWS; k += LANES) {
    const int behind = k % 2 * (TAP_MARGIN + 4 * TAP_CHUNKS);
    *(__local uint4*)(window + k / 2 * TAP_PITCH + behind) = 0;
  }
}

// Byte `high` (0: low, 1) of a pixel of a turned template.
INLINE int byte_of(const int pixel, const int high) {
  return high ? (pixel + 128) >> 8 : (int)(char)(uchar)(pixel & 255);
}

// A turned template's pixels about their mean, in parts of a grey level; sets its totals, which
// must be 0. Passes barriers; `is_turned` is the same for the whole group, which calls it in any
// case.
INLINE void put_turned(const Task* task, const int width, const int height, const int is_turned,
                       __local int* pixels, __local int* mean, __local int* totals,
                       const int lane) {
  const float2 turn = guessed_turn(task->window);
  int sum = 0;
#pragma unroll 1
  for (int k = lane; k < WINDOW_PIXELS * is_turned; k += LANES) {
    const float pixel = template_pixel(task->first, width, height, task->window, turn,
                                       k % WINDOW_PX, k / WINDOW_PX);
    pixels[k] = (int)rint(TURNED_PARTS * pixel);
    sum += pixels[k];
  }
  if (is_turned) atomic_add(mean, sum);
  GROUP_BARRIER;
  const int level = (int)rint((float)*mean * (1.0f / WINDOW_PIXELS));
  int own[TOTALS] = {0, 0, 0, 0};
#pragma unroll 1
  for (int k = lane; k < WINDOW_PIXELS * is_turned; k += LANES) {
    const int pixel = pixels[k] - level, low = byte_of(pixel, 0), high = byte_of(pixel, 1);
    pixels[k] = pixel;
    own[SUM] += pixel;
    own[LOW_LOW] += low * low;
    own[HIGH_HIGH] += high * high;
    own[HIGH_LOW] += high * low;
  }
  UNROLL
  for (int i = 0; i < TOTALS; ++i) {
    if (is_turned) atomic_add(&totals[i], own[i]);
  }
}

// One byte of each of those pixels, as a window.
INLINE void put_bytes(__local const int* pixels, const int high, __local uint* window,
                      const int lane) {
  __local char* bytes = (__local char*)window;
#pragma unroll 1
  for (int k = lane; k < TAP_ROWS * 16 * TAP_CHUNKS; k += LANES) {
    const int x = k % (16 * TAP_CHUNKS), y = k / (16 * TAP_CHUNKS);
    const int is_in = x < WINDOW_PX && y < WINDOW_PX;
    bytes[4 * (y * TAP_PITCH + TAP_MARGIN) + x] =
        (char)(is_in ? byte_of(pixels[y * WINDOW_PX + x], high) : 0);
  }
}

// Sums down the columns of every displaced window, in the place of the area: passes a barrier.
INLINE void put_column_sums(__local const uint* area, __local int* sums, const int lane) {
  const int bit = 1 << SQUARE_BITS;
  int own[COLUMN_SETS][LAGS];
  UNROLL
  for (int set = 0; set < COLUMN_SETS; ++set) {
    __local const char* column = (__local const char*)area + min(set * LANES + lane, AREA_PX - 1);
    int sum = 0;
    UNROLL
    for (int y = 0; y < WINDOW_PX; ++y) {
      const int pixel = column[y * 4 * AREA_PITCH];
      sum += pixel * (pixel + bit);
    }
    own[set][0] = sum;
    UNROLL
    for (int y = 1; y < LAGS; ++y) {
      const int in = column[(y + WINDOW_PX - 1) * 4 * AREA_PITCH];
      const int out = column[(y - 1) * 4 * AREA_PITCH];
      sum += (in - out) * (in + out + bit);
      own[set][y] = sum;
    }
  }
  GROUP_BARRIER;
  UNROLL
  for (int set = 0; set < COLUMN_SETS; ++set) {
    const int x = set * LANES + lane;
    UNROLL
    for (int y = 0; y < LAGS; ++y) {
      if (x < AREA_PX) sums[y * SUM_PITCH + x] = own[set][y];
    }
  }
}

// What turns sums into a correlation.
typedef struct Norming {
  int level;         // the template's mean, rounded
  float rest;        // what it lacks of the mean
  float energy;      // of the template about its mean
  float min_energy;  // of a displaced window
} Norming;

// Sums over a displaced window g of N pixels: Σ (g − level); and modulo 2^32 the packed sums, so
// that packed − sum (2^SQUARE_BITS + 2 level) is Σ (g − level)².
typedef struct WindowSums {
  int sum;
  uint packed;
} WindowSums;

INLINE WindowSums no_sums(const int level) {
  const int all = WINDOW_PIXELS * level;
  const WindowSums sums = {-all, 0u - (uint)all * ((1u << SQUARE_BITS) + (uint)level)};
  return sums;
}

INLINE void add_column(WindowSums* sums, const int column) {
  sums->sum += column >> SQUARE_BITS;
  sums->packed += (uint)column;
}

INLINE void step_columns(WindowSums* sums, const int in, const int out) {
  sums->sum += (in >> SQUARE_BITS) - (out >> SQUARE_BITS);
  sums->packed += (uint)in - (uint)out;
}

// products: Σ (t − level) g less what a constant g would give.
INLINE float correlation_of(const int products, const WindowSums sums, const Norming norming) {
  const int weight = (1 << SQUARE_BITS) + 2 * norming.level;
  const float sum = (float)sums.sum;
  const float energy = (float)(int)(sums.packed - (uint)sums.sum * (uint)weight) -
                       sum * sum * (1.0f / WINDOW_PIXELS);
  const float product = (float)(products - norming.level * sums.sum) - norming.rest * sum;
  const float correlation = product * rsqrt(energy * norming.energy);
  return energy > norming.min_energy ? correlation : 0.0f;
}

// Row y of the map, which holds the products, out of the sums along it; returns its highest value.
INLINE float put_map_row(__local const int* columns, __local float* map, const Norming norming,
                         const int y) {
  __local const int* row = columns + y * SUM_PITCH;
  __local float* out = map + y * LAGS;
  WindowSums sums = no_sums(norming.level);
  UNROLL
  for (int x = 0; x < WINDOW_PX; ++x) add_column(&sums, row[x]);
  float highest = -2.0f;
  UNROLL
  for (int x = 0; x < LAGS; ++x) {
    const float value = correlation_of(((__local const int*)out)[x], sums, norming);
    out[x] = value;
    highest = fmax(highest, value);
    if (x + 1 < LAGS) step_columns(&sums, row[x + WINDOW_PX], row[x]);
  }
  return highest;
}

// The rows for which there is no work-item, two entries a work-item.
INLINE void put_rows_beyond(__local const int* columns, __local float* map, const Norming norming,
                            const int lane) {
  const int pairs = (LAGS + 1) / 2;
#pragma unroll 1
  for (int k = lane; k < (LAGS - LANES) * pairs; k += LANES) {
    const int y = LANES + k / pairs, x = 2 * (k % pairs);
    __local const int* row = columns + y * SUM_PITCH + x;
    __local float* out = map + y * LAGS + x;
    WindowSums sums = no_sums(norming.level);
    UNROLL
    for (int i = 0; i < WINDOW_PX; ++i) add_column(&sums, row[i]);
    out[0] = correlation_of(((__local const int*)out)[0], sums, norming);
    if (x + 1 == LAGS) continue;
    step_columns(&sums, row[WINDOW_PX], row[0]);
    out[1] = correlation_of(((__local const int*)out)[1], sums, norming);
  }
}

INLINE int is_all_in_view(const SearchPlace place) {
  return place.min_x == 0 && place.min_y == 0 && place.max_x == LAGS - 1 && place.max_y == LAGS - 1;
}

// −2 at the lags that take the window out of the picture.
INLINE void mark_out_of_view(__local float* map, const SearchPlace place, const int lane) {
  if (is_all_in_view(place)) return;
#pragma unroll 1
  for (int k = lane; k < LAGS * LAGS; k += LANES) {
    const int x = k % LAGS, y = k / LAGS;
    if (x < place.min_x || x > place.max_x || y < place.min_y || y > place.max_y) map[k] = -2.0f;
  }
}

// Finds the highest value of the map: of equal ones the topmost, of those the leftmost. highest: of
// row `lane`, as it was before lags were marked. Passes barriers.
INLINE void find_highest(__local const float* map, __local Found* found, const SearchPlace place,
                         const float highest, const int lane) {
  float own = lane < LAGS ? highest : -2.0f, beyond = -2.0f;
  if (!is_all_in_view(place) && lane < LAGS) {
    own = -2.0f;
#pragma unroll 1
    for (int x = 0; x < LAGS; ++x) own = fmax(own, map[lane * LAGS + x]);
  }
  for (int k = LANES * LAGS + lane; k < LAGS * LAGS; k += LANES) beyond = fmax(beyond, map[k]);
  atomic_max(&found->most, in_order(fmax(own, beyond)));
  GROUP_BARRIER;
  if (in_order(beyond) == found->most) atomic_min(&found->y, LANES);
  if (in_order(own) == found->most) atomic_min(&found->y, lane);
  GROUP_BARRIER;
  for (int x = lane; x < LAGS; x += LANES) {
    if (in_order(map[found->y * LAGS + x]) == found->most) atomic_min(&found->x, x);
  }
  GROUP_BARRIER;
}

// As zncc_single (single.cl).
__kernel GROUP_SIZE void zncc_bytes(__global const uchar* pixels, const int width, const int height,
                                    __global const Window* windows, const uint start,
                                    const float min_contrast, __global const float* weights,
                                    __global CorrelationPeak* peaks) {
  __local uint store[STORE_WORDS] __attribute__((aligned(32)));
  __local uint* area = store;
  __local uint* window = store + AREA_WORDS;
  __local int* sums = (__local int*)store;         // later
  __local float8* lines = (__local float8*)store;  // in the end
  __local float map[MAP_FLOATS] __attribute__((aligned(16)));
  __local Found found[1];
  __local int totals[TOTALS], mean[1];
  const int lane = (int)get_local_id(0);
  __global CorrelationPeak* peak = peaks + get_group_id(0);
  const Task task = task_of(pixels, width, height, windows[start + get_group_id(0)]);
  if (!task.place.in_view) {
    if (lane == 0) {
      peak->status = STATUS_OUT_OF_VIEW;
      peak->value = NAN;
    }
    return;
  }
  const int is_turned = task.window.guess_rot_rad != 0.0f;
  clear_found(found, 1, lane);
  for (int i = lane; i < TOTALS; i += LANES) totals[i] = 0;
  if (lane == 0) mean[0] = 0;
  GROUP_BARRIER;
  put_area(&task, width, height, area, lane);
  clear_margins(window, lane);
  if (!is_turned) put_window(&task, width, window, totals, lane);
  put_turned(&task, width, height, is_turned, (__local int*)map, mean, totals, lane);
  GROUP_BARRIER;

  // The template about its mean, of which a turned one lacks little.
  const int sum = totals[SUM];
  const int level = is_turned ? 0 : (int)rint((float)sum * (1.0f / WINDOW_PIXELS));
  const int rest = sum - WINDOW_PIXELS * level;
  const int squares = totals[LOW_LOW] - level * (sum + rest);
  const float energy = (float)squares + 512.0f * (float)totals[HIGH_LOW] +
                       65536.0f * (float)totals[HIGH_HIGH] -
                       (float)rest * (float)rest * (1.0f / WINDOW_PIXELS);
  const float contrast =
      sqrt(energy * (1.0f / WINDOW_PIXELS)) * (is_turned ? 1.0f / TURNED_PARTS : 1.0f);
  const float min_energy = 0.01f * WINDOW_PIXELS * min_contrast * min_contrast;
  const Norming norming = {level, (float)rest * (1.0f / WINDOW_PIXELS), energy,
                           energy > 0.0f ? min_energy : INFINITY};
  const int begin = -level * sum;
  int held[HELD];
  UNROLL
  for (int k = 0; k < HELD; ++k) held[k] = begin;
#pragma unroll 1
  for (int high = is_turned; high >= 0; --high) {
    if (is_turned) put_bytes((__local const int*)map, high, window, lane);
    GROUP_BARRIER;
    add_products(area, window, held, lane);
    UNROLL
    for (int k = 0; k < HELD && high; ++k) held[k] *= 256;
    GROUP_BARRIER;
  }
  put_products(held, (__local int*)map, lane);
  put_column_sums(area, sums, lane);
  GROUP_BARRIER;
  float highest = -2.0f;
  if (lane < LAGS) highest = put_map_row(sums, map, norming, lane);
  put_rows_beyond(sums, map, norming, lane);
  GROUP_BARRIER;
  mark_out_of_view(map, task.place, lane);
  GROUP_BARRIER;
  find_highest(map, found, task.place, highest, lane);
  const Patch patch = patch_about(task.place, found[0].x, found[0].y);
  atomic_max(&found[0].second, in_order(second_of_parts(map, found[0].x, found[0].y, lane)));
  for (int k = lane; k < PEAK_PATCH_PX; k += LANES) put_line(map, 1, patch, weights, lines, k);
  GROUP_BARRIER;
  for (int k = lane; k < PEAK_PARTS; k += LANES) write_part(lines, patch, weights, k, peak);
  for (int k = lane; k == 0; k += LANES) {
    write_head(map, 1, task.window, task.place, found[0].x, found[0].y, from_order(found[0].second),
               contrast, min_contrast, peak);
  }
}
