// The highest and the second peak of two correlation maps of which a work-item holds the same
// column in registers, while they lie side by side in local memory, LAGS × LAGS pairs row by row;
// and the second peak of one map that lies there.
#ifndef IMPACTDIC_KERNELS_MAP_PEAKS_H_
#define IMPACTDIC_KERNELS_MAP_PEAKS_H_

#include "kernels/zncc/task.h"

// Lines of coefficients of both maps, 8 floats each (see put_line).
#define PEAK_LINES (PEAK_PATCH_PX)

// Of a map: its highest value and that of the second peak, both in_order, and where the highest
// stands: of equal ones the leftmost, of those the topmost.
typedef struct Found {
  int most, x, y, second;
} Found;

INLINE void clear_found(__local Found* found, const int count, const int lane) {
  if (lane >= count) return;
  found[lane].most = INT_MIN;
  found[lane].x = found[lane].y = LAGS;
  found[lane].second = in_order(-2.0f);
}

// −2 at the lags of column x that take the window out of the picture.
INLINE void mark_lags_out_of_view(float* column, const SearchPlace place, const int x) {
  if (place.min_x == 0 && place.min_y == 0 && place.max_x == LAGS - 1 && place.max_y == LAGS - 1) {
    return;
  }
  const int in_range = x >= place.min_x && x <= place.max_x;
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    if (!in_range || y < place.min_y || y > place.max_y) column[y] = -2.0f;
  }
}

// Writes the columns x into the maps and finds their highest values. All work-items of the group
// call it (several may hold the same column); passes barriers.
INLINE void find_peaks(const float* a, const float* b, __local float2* maps, __local Found* found,
                       const int x) {
  float2 most = (float2)(a[0], b[0]);
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    maps[y * LAGS + x] = (float2)(a[y], b[y]);
    most = fmax(most, (float2)(a[y], b[y]));
  }
  const int most_a = in_order(most.x), most_b = in_order(most.y);
  atomic_max(&found[0].most, most_a);
  atomic_max(&found[1].most, most_b);
  GROUP_BARRIER;
  if (most_a == found[0].most) atomic_min(&found[0].x, x);
  if (most_b == found[1].most) atomic_min(&found[1].x, x);
  GROUP_BARRIER;
  // Of the column found, each work-item looks at one row.
  for (int y = (int)get_local_id(0); y < LAGS; y += LANES) {
    if (in_order(maps[y * LAGS + found[0].x].x) == found[0].most) atomic_min(&found[0].y, y);
    if (in_order(maps[y * LAGS + found[1].x].y) == found[1].most) atomic_min(&found[1].y, y);
  }
  GROUP_BARRIER;
}

// The highest entry of column x that is no lower than its neighbours and more than 2 px away from
// the highest of the map along an axis; −2 where there is none. beside: of every entry of the
// column the higher one of its neighbours left and right.
INLINE float second_of_column(const float* column, const float* beside, const int x,
                              const int far_x, const int far_y) {
  const int first_near = abs(x - far_x) <= 2 ? far_y - 2 : LAGS;
  float second = -2.0f;
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    float around = beside[y];
    if (y > 0) around = fmax(around, fmax(beside[y - 1], column[y - 1]));
    if (y < LAGS - 1) around = fmax(around, fmax(beside[y + 1], column[y + 1]));
    const int is_far = (uint)(y - first_near) > 4;
    if (is_far && column[y] >= around) second = fmax(second, column[y]);
  }
  return second;
}

// Sets the second peaks of both maps; they may be read after a barrier.
INLINE void put_second_peaks(const float* a, const float* b, __local const float2* maps,
                             __local Found* found, const int x) {
  __local const float2* left = maps + max(x - 1, 0);
  __local const float2* right = maps + min(x + 1, LAGS - 1);
  float beside_a[LAGS], beside_b[LAGS];
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    const float2 beside = fmax(left[y * LAGS], right[y * LAGS]);
    beside_a[y] = beside.x;
    beside_b[y] = beside.y;
  }
  atomic_max(&found[0].second, in_order(second_of_column(a, beside_a, x, found[0].x, found[0].y)));
  atomic_max(&found[1].second, in_order(second_of_column(b, beside_b, x, found[1].x, found[1].y)));
}

// The highest entry of the map that is no lower than its neighbours and more than 2 px away from
// (far_x, far_y) along an axis, among those that are this work-item's: parts of columns. −2 where
// there is none.
#define PARTS 3
#define PART_PX ((LAGS + PARTS - 1) / PARTS)
INLINE float second_of_parts(__local const float* map, const int far_x, const int far_y,
                             const int lane) {
  float second = -2.0f;
#pragma unroll 1
  for (int k = lane; k < PARTS * LAGS; k += LANES) {
    const int x = k % LAGS, begin = min(k / LAGS * PART_PX, LAGS - PART_PX);
    const int left = max(x - 1, 0), right = min(x + 1, LAGS - 1);
    const int from_near = abs(x - far_x) <= 2 ? begin - far_y + 2 : LAGS;
    __local const float* row = map + max(begin - 1, 0) * LAGS;
    float above = fmax(fmax(row[left], row[right]), row[x]);
    row = map + begin * LAGS;
    float beside = fmax(row[left], row[right]), value = row[x];
    UNROLL
    for (int i = 0; i < PART_PX; ++i) {
      if (i + 1 < PART_PX || begin + PART_PX < LAGS) row += LAGS;
      const float next_beside = fmax(row[left], row[right]), next = row[x];
      const float around = fmax(fmax(above, beside), fmax(next_beside, next));
      if ((uint)(from_near + i) > 4 && value >= around) second = fmax(second, value);
      above = fmax(beside, value);
      beside = next_beside;
      value = next;
    }
  }
  return second;
}

#endif  // IMPACTDIC_KERNELS_MAP_PEAKS_H_
