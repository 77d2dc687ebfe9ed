#include <impactdic/error.h>

#include <algorithm>

#include "host/pipeline/correlate_clip.h"

namespace impactdic::pipeline {
namespace {

bool on_surface(const Window& window, int window_px, const Image<std::uint8_t>& mask) {
  if (mask.size() == 0) return true;
  for (int y = window.y0; y < window.y0 + window_px; ++y) {
    for (int x = window.x0; x < window.x0 + window_px; ++x) {
      if (mask(x, y) == 0) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<Window> region_grid(const CorrelateOptions& options) {
  std::vector<Window> windows =
      dic::rectangle_grid(options.roi.x, options.roi.y, options.roi.width, options.roi.height,
                          options.field.window_px, options.effective_spacing_px());
  std::erase_if(windows, [&](const Window& window) {
    return !on_surface(window, options.field.window_px, options.mask);
  });
  if (windows.empty()) {
    throw InvalidArgument("no interrogation window fits into the region", "--roi, --mask, --window",
                          "take a smaller window or a larger region");
  }
  return windows;
}

}  // namespace impactdic::pipeline
