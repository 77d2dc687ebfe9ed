#include <impactdic/error.h>

#include <cmath>

#include "host/dic/field.h"

namespace impactdic::dic {

namespace {
void check_grid(int window_px, int spacing_px) {
  if (window_px < 1) throw InvalidArgument("the window must have pixels", "--window");
  if (spacing_px < 1) throw InvalidArgument("the spacing must be at least 1 px", "--spacing");
}

// How many pixels of the window whose first one is at (x, y) from a disc's centre lie within it.
int pixels_inside(double x, double y, double radius_px, int window_px) {
  if (!(radius_px >= 0)) return 0;
  // Only near the rim is the distance needed to the last bit, which takes ten times as long.
  const double surely = (1 - 1e-9) * radius_px * radius_px;
  const double perhaps = (1 + 1e-9) * radius_px * radius_px;
  int count = 0;
  for (int j = 0; j < window_px; ++j) {
    for (int i = 0; i < window_px; ++i) {
      const double square = (x + i) * (x + i) + (y + j) * (y + j);
      count += square < surely || (square <= perhaps && std::hypot(x + i, y + j) <= radius_px);
    }
  }
  return count;
}

}  // namespace

std::vector<Window> disc_grid(double cx_px, double cy_px, double radius_px, int window_px,
                              int spacing_px, double inside) {
  check_grid(window_px, spacing_px);
  std::vector<Window> windows;
  const double half = (window_px - 1) / 2.0;
  const double fewest = inside * window_px * window_px;
  const int middle_x = static_cast<int>(std::lround(cx_px - half));
  const int middle_y = static_cast<int>(std::lround(cy_px - half));
  const int steps = static_cast<int>((std::max(0.0, radius_px) + half) / spacing_px) + 1;
  for (int j = -steps; j <= steps; ++j) {
    for (int i = -steps; i <= steps; ++i) {
      Window window{};
      window.x0 = middle_x + i * spacing_px;
      window.y0 = middle_y + j * spacing_px;
      const double x = window.x0 - cx_px, y = window.y0 - cy_px;
      if (pixels_inside(x, y, radius_px, window_px) >= fewest) windows.push_back(window);
    }
  }
  return windows;
}

std::vector<Window> rectangle_grid(int x, int y, int width, int height, int window_px,
                                   int spacing_px) {
  check_grid(window_px, spacing_px);
  std::vector<Window> windows;
  for (int y0 = y; y0 + window_px <= y + height; y0 += spacing_px) {
    for (int x0 = x; x0 + window_px <= x + width; x0 += spacing_px) {
      Window window{};
      window.x0 = x0;
      window.y0 = y0;
      windows.push_back(window);
    }
  }
  return windows;
}

}  // namespace impactdic::dic
