// Second chance for windows: what the correlation did not find is sought where the neighbours went.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/window_places.h"

namespace impactdic::dic {

// Whether a window was looked for and not found.
bool is_lost(const WindowMotion& motion);

// Refines windows from their seeds, one result a window.
using RefineWindows = std::function<void(
    std::span<const Window>, std::span<const WindowMotion> seeds, std::span<WindowMotion> results)>;

// Keeps its memory, and what it knows of the windows' grid, from one call to the next.
class Neighbours {
 public:
  Neighbours();
  ~Neighbours();

  // Windows that were not found (low_correlation, at_search_edge, not_converged) are refined from
  // what the nearest found windows of the same pair of frames say at their place, displacement and
  // gradient both (the reliability-guided walk of Pan 2009, all of a front at once), until no more
  // are found. A window that stays lost keeps its status, unless `refine` says no_texture. Windows
  // of one pair must follow each other.
  void refine_lost(std::span<const Window> windows, int window_px, const RefineWindows& refine,
                   std::span<WindowMotion> motions);

  // After refine_lost: those of the windows `which` that stayed lost and have too little texture to
  // be found at all get that status. `refine` says so of seeds that are lost; those that it has
  // refined already are not asked for again.
  void judge_lost(std::span<const Window> windows, std::span<const std::size_t> which,
                  const RefineWindows& refine, std::span<WindowMotion> motions);

 private:
  class Front;
  struct Proposals;
  void start_fronts(std::span<const Window> windows, int window_px,
                    std::span<WindowMotion> motions);

  std::shared_ptr<WindowPlaces> places_;  // of the last grid
  std::vector<Front> fronts_;             // of the pairs of this call, and what others left behind
  std::size_t pairs_ = 0;
  std::vector<std::uint8_t> state_;  // of every window: flags
  std::unique_ptr<Proposals> proposals_;
};

}  // namespace impactdic::dic
