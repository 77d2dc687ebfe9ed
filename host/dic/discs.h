// The disc of every frame slot within which pixels are on the surface.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "host/dic/field.h"

namespace impactdic::dic {

class Discs {
 public:
  explicit Discs(int slots) : discs_(static_cast<std::size_t>(slots)) {}
  void set(int slot, double cx_px, double cy_px, double radius_px) {
    discs_.at(static_cast<std::size_t>(slot)) = {cx_px, cy_px, radius_px * radius_px};
  }
  // Whether a pixel of the window lies outside its first frame's disc.
  bool cuts(const Window& window, int window_px) const {
    const Disc& disc = discs_[static_cast<std::size_t>(window.first)];
    const double half = (window_px - 1) / 2.0;
    const double dx = std::abs(window.x0 + half - disc.cx_px) + half;
    const double dy = std::abs(window.y0 + half - disc.cy_px) + half;
    return dx * dx + dy * dy > disc.radius2_px;
  }

 private:
  struct Disc {
    double cx_px = 0, cy_px = 0, radius2_px = std::numeric_limits<double>::infinity();
  };
  std::vector<Disc> discs_;
};

using SearchWindows = std::function<void(std::span<const Window>, std::span<WindowMotion>)>;

// Has those windows searched that no disc cuts; the others get a status instead. What is beyond the
// rim stands still or moves otherwise: a correlation would find that. Keeps its memory from one
// call to the next.
class WholeWindows {
 public:
  void search(std::span<const Window> windows, int window_px, const Discs& discs,
              WindowStatus of_cut, std::span<WindowMotion> motions, const SearchWindows& search);
  // The others, of the last search.
  std::span<const std::size_t> cut() const { return cut_; }

 private:
  // Of windows that follow each other and are whole.
  struct Run {
    std::size_t begin, end;
  };
  std::vector<Run> runs_;
  std::vector<std::size_t> cut_;
  std::vector<Window> whole_;
};

}  // namespace impactdic::dic
