// Arrays of numpy out of what the library measured.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <initializer_list>
#include <memory>
#include <numeric>
#include <vector>

namespace impactdic::python {

// Hands `values` over without a copy; row-major, of the given shape.
template <typename T>
nanobind::object to_numpy(std::vector<T> values, std::vector<std::size_t> shape) {
  auto held = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = held->data();
  const nanobind::capsule owner(held.release(),
                                [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nanobind::cast(
      nanobind::ndarray<nanobind::numpy, T>(data, shape.size(), shape.data(), owner));
}

template <typename T>
nanobind::object to_numpy(std::vector<T> values) {
  const std::size_t count = values.size();
  return to_numpy(std::move(values), {count});
}

}  // namespace impactdic::python
