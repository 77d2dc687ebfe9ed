// The public view of a field; see api/impactdic/field.h.
#include <impactdic/field.h>

#include <limits>

#include "kernels/types.h"

namespace impactdic {

FieldView::FieldView(std::span<const Window> windows, std::span<const WindowMotion> motions,
                     int window_px)
    : windows_(windows.data()),
      motions_(motions.data()),
      count_(motions.size()),
      window_px_(window_px) {}

WindowResult FieldView::operator[](std::size_t index) const {
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  const Window& window = windows_[index];
  const WindowMotion& motion = motions_[index];
  WindowResult result;
  result.status = static_cast<WindowStatus>(motion.status);
  result.x_px = window.x0 + (window_px_ - 1) / 2.0;
  result.y_px = window.y0 + (window_px_ - 1) / 2.0;
  const bool ok = result.status == WindowStatus::kOk;
  const auto measured = [ok](float value) { return ok ? value : kNothing; };
  result.u_px = measured(motion.u);
  result.v_px = measured(motion.v);
  result.u_sd_px = measured(motion.u_sd);
  result.v_sd_px = measured(motion.v_sd);
  result.correlation = measured(motion.correlation);
  result.peak_ratio = measured(motion.peak_ratio);
  result.ux = measured(motion.ux);
  result.uy = measured(motion.uy);
  result.vx = measured(motion.vx);
  result.vy = measured(motion.vy);
  return result;
}

std::vector<WindowResult> FieldView::windows() const {
  std::vector<WindowResult> all;
  all.reserve(count_);
  for (std::size_t i = 0; i < count_; ++i) all.push_back((*this)[i]);
  return all;
}

}  // namespace impactdic
