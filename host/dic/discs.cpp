#include "host/dic/discs.h"

#include <cmath>

namespace impactdic {

bool Discs::cuts(const Window& window, int window_px) const {
  const Disc& disc = discs_[static_cast<std::size_t>(window.first)];
  if (!std::isfinite(disc.radius_px)) return false;
  const double half = (window_px - 1) / 2.0;
  const double dx = std::abs(window.x0 + half - disc.cx_px) + half;
  const double dy = std::abs(window.y0 + half - disc.cy_px) + half;
  return dx * dx + dy * dy > disc.radius_px * disc.radius_px;
}

void WholeWindows::search(std::span<const Window> windows, int window_px, const Discs& discs,
                          WindowStatus of_cut, std::span<WindowMotion> motions,
                          const SearchWindows& search) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const WindowMotion not_searched = {
      kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, static_cast<idic_int>(of_cut)};
  index_.clear();
  cut_.clear();
  whole_.clear();
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (discs.cuts(windows[i], window_px)) {
      motions[i] = not_searched;
      cut_.push_back(i);
    } else {
      index_.push_back(i);
      whole_.push_back(windows[i]);
    }
  }
  if (whole_.size() == windows.size()) {
    search(windows, motions);
    return;
  }
  found_.resize(whole_.size());
  search(whole_, found_);
  for (std::size_t k = 0; k < index_.size(); ++k) motions[index_[k]] = found_[k];
}

}  // namespace impactdic
