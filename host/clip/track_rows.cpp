#include "host/clip/track_rows.h"

#include <algorithm>
#include <utility>

namespace impactdic {

TrackRows TrackRows::part(std::size_t begin, std::size_t end) const {
  TrackRows rows = *this;
  if (array_ != nullptr) {
    rows.array_ += begin;
  } else {
    rows.first_ += begin;
  }
  rows.size_ = end - begin;
  return rows;
}

std::optional<std::size_t> TrackRows::find_frame(std::int64_t frame) const {
  std::size_t low = 0, high = size_;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if ((*this)[middle].frame < frame) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == size_ || (*this)[low].frame != frame) return std::nullopt;
  return low;
}

EvenRows::EvenRows(const TrackRows& rows, std::function<void(TrackRow&)> change)
    : rows_(rows), change_(std::move(change)) {
  for (std::size_t i = 0; i < rows.size(); ++i, ++size_) {
    const int periods = rows[i].periods;
    if (periods == 1 || i + 1 == rows.size()) continue;
    gaps_.push_back({size_, i, static_cast<std::size_t>(periods)});
    size_ += gaps_.back().periods - 1;
  }
}

TrackRow EvenRows::row(std::size_t i) const {
  TrackRow row = even_row(i);
  if (change_) change_(row);
  return row;
}

TrackRow EvenRows::even_row(std::size_t i) const {
  const auto behind = std::upper_bound(
      gaps_.begin(), gaps_.end(), i, [](std::size_t at, const Gap& gap) { return at < gap.even; });
  if (behind == gaps_.begin()) return rows_[i];
  const Gap& gap = *(behind - 1);
  const std::size_t since = i - gap.even;
  if (since >= gap.periods) return rows_[gap.row + since - gap.periods + 1];
  TrackRow before = rows_[gap.row];
  if (since == 0) {
    before.motion_ok = false;
    before.dx_px = before.dy_px = before.rot_deg = kNotMeasured;
    return before;
  }
  TrackRow missing;
  missing.frame = before.frame;
  return missing;
}

}  // namespace impactdic
