// Displacement fields as columns, one field after the other.
#pragma once

#include <impactdic/field.h>
#include <nanobind/nanobind.h>

#include <cstdint>
#include <string>
#include <vector>

namespace impactdic::python {

class FieldColumns {
 public:
  // Appends every window of a field.
  void add(const FieldView& field);
  // Arrays by name, of the given shape; empties itself.
  nanobind::dict take(const std::vector<std::size_t>& shape);

 private:
  void add(const WindowResult& window);

  std::vector<std::int8_t> status_;
  std::vector<float> x_px_, y_px_, u_px_, v_px_, u_sd_px_, v_sd_px_, correlation_, peak_ratio_, ux_,
      uy_, vx_, vy_;
};

}  // namespace impactdic::python
