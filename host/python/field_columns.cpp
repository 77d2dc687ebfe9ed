#include "host/python/field_columns.h"

#include <utility>

#include "host/python/arrays.h"

namespace nb = nanobind;

namespace impactdic::python {

void FieldColumns::add(const FieldView& field) {
  for (std::size_t i = 0; i < field.size(); ++i) add(field[i]);
}

void FieldColumns::add(const WindowResult& window) {
  status_.push_back(static_cast<std::int8_t>(window.status));
  x_px_.push_back(static_cast<float>(window.x_px));
  y_px_.push_back(static_cast<float>(window.y_px));
  u_px_.push_back(window.u_px);
  v_px_.push_back(window.v_px);
  u_sd_px_.push_back(window.u_sd_px);
  v_sd_px_.push_back(window.v_sd_px);
  correlation_.push_back(window.correlation);
  peak_ratio_.push_back(window.peak_ratio);
  ux_.push_back(window.ux);
  uy_.push_back(window.uy);
  vx_.push_back(window.vx);
  vy_.push_back(window.vy);
}

nb::dict FieldColumns::take(const std::vector<std::size_t>& shape) {
  nb::dict columns;
  const std::pair<const char*, std::vector<float>*> floats[] = {{"x_px", &x_px_},
                                                                {"y_px", &y_px_},
                                                                {"u_px", &u_px_},
                                                                {"v_px", &v_px_},
                                                                {"u_sd_px", &u_sd_px_},
                                                                {"v_sd_px", &v_sd_px_},
                                                                {"correlation", &correlation_},
                                                                {"peak_ratio", &peak_ratio_},
                                                                {"ux", &ux_},
                                                                {"uy", &uy_},
                                                                {"vx", &vx_},
                                                                {"vy", &vy_}};
  for (const auto& [name, values] : floats) columns[name] = to_numpy(std::move(*values), shape);
  columns["status"] = to_numpy(std::move(status_), shape);
  *this = {};
  return columns;
}

}  // namespace impactdic::python
