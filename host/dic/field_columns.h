// The windows of a field as columns, as files hold them: made by whoever measured the field, for
// whom it is still at hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/types.h"

namespace impactdic::dic {

// What a window of the kind kOk has measured, in the order of the columns.
inline constexpr std::array kMeasuredValues = {
    &WindowMotion::u,           &WindowMotion::v,          &WindowMotion::u_sd, &WindowMotion::v_sd,
    &WindowMotion::correlation, &WindowMotion::peak_ratio, &WindowMotion::ux,   &WindowMotion::uy,
    &WindowMotion::vx,          &WindowMotion::vy};

class FieldColumns {
 public:
  // The centre of the window, x and y; behind them what was measured.
  static constexpr std::size_t kPlaces = 2, kCount = kPlaces + kMeasuredValues.size();

  FieldColumns() = default;
  // `windows` and `field` are as many. Where a window stood is known whatever came of it, the rest
  // only where it was measured: NaN elsewhere.
  FieldColumns(std::span<const Window> windows, std::span<const WindowMotion> field, int window_px);

  std::size_t windows() const { return status_.size(); }
  bool empty() const { return status_.empty(); }
  std::span<const float> column(std::size_t index) const {
    return std::span(values_).subspan(index * windows(), windows());
  }
  std::span<const std::uint8_t> status() const { return status_; }

 private:
  std::vector<float> values_;  // a column after the other
  std::vector<std::uint8_t> status_;
};

}  // namespace impactdic::dic
