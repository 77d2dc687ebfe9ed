#include "host/dic/field_columns.h"

#include <impactdic/field.h>

#include <limits>
#include <utility>

namespace impactdic::dic {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

// All columns in one look at every window.
template <std::size_t... k>
void gather(std::span<const Window> windows, std::span<const WindowMotion> field, double half,
            const std::array<float*, FieldColumns::kCount>& columns, std::index_sequence<k...>) {
  for (std::size_t i = 0; i < field.size(); ++i) {
    const WindowMotion& motion = field[i];
    const bool measured = motion.status == static_cast<std::int32_t>(WindowStatus::kOk);
    columns[0][i] = static_cast<float>(windows[i].x0 + half);
    columns[1][i] = static_cast<float>(windows[i].y0 + half);
    ((columns[FieldColumns::kPlaces + k][i] = measured ? motion.*kMeasuredValues[k] : kNothing),
     ...);
  }
}

}  // namespace

FieldColumns::FieldColumns(std::span<const Window> windows, std::span<const WindowMotion> field,
                           int window_px)
    : values_(kCount * field.size()), status_(field.size()) {
  std::array<float*, kCount> columns{};
  for (std::size_t c = 0; c < kCount; ++c) columns[c] = values_.data() + c * field.size();
  gather(windows, field, (window_px - 1) / 2.0, columns,
         std::make_index_sequence<kMeasuredValues.size()>());
  for (std::size_t i = 0; i < field.size(); ++i) {
    status_[i] = static_cast<std::uint8_t>(field[i].status);
  }
}

}  // namespace impactdic::dic
