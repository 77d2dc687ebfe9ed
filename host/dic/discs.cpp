#include "host/dic/discs.h"

#include <algorithm>

namespace impactdic::dic {

void WholeWindows::search(std::span<const Window> windows, int window_px, const Discs& discs,
                          WindowStatus of_cut, std::span<WindowMotion> motions,
                          const SearchWindows& search) {
  runs_.clear();
  cut_.clear();
  whole_.clear();
  for (std::size_t begin = 0; begin < windows.size();) {
    for (; begin < windows.size() && discs.cuts(windows[begin], window_px); ++begin) {
      cut_.push_back(begin);
    }
    std::size_t end = begin;
    while (end < windows.size() && !discs.cuts(windows[end], window_px)) ++end;
    runs_.push_back({begin, end});
    whole_.insert(whole_.end(), windows.begin() + static_cast<std::ptrdiff_t>(begin),
                  windows.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
  // What was found goes to the end of the results, and from there forward to its place.
  const auto found = motions.last(whole_.size());
  search(whole_, found);
  auto from = found.begin();
  for (const Run& run : runs_) {
    const auto length = static_cast<std::ptrdiff_t>(run.end - run.begin);
    std::copy(from, from + length, motions.begin() + static_cast<std::ptrdiff_t>(run.begin));
    from += length;
  }
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const WindowMotion not_searched = {
      kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, static_cast<idic_int>(of_cut)};
  for (const std::size_t i : cut_) motions[i] = not_searched;
}

}  // namespace impactdic::dic
