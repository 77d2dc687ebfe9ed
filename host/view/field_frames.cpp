#include "host/view/field_frames.h"

#include <impactdic/error.h>

#include <string>

namespace impactdic::view {

using report::hdf5::Guard;
using report::hdf5::Handle;

FieldFrames::FieldFrames(const std::filesystem::path& path) : path_(path.string()) {
  const Guard guard(report::hdf5::lock());
  file_ = report::hdf5::File::open_to_read(path_);
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const std::string what = path_ + ", " + kColumns[i];
    columns_[i] = Handle(H5Dopen2(file_->get(), kColumns[i], H5P_DEFAULT), H5Dclose, what);
    const Handle space(H5Dget_space(columns_[i].get()), H5Sclose, what);
    std::array<hsize_t, 2> size = {0, 0};
    if (H5Sget_simple_extent_ndims(space.get()) != 2) {
      throw FormatError(path_, -1, std::string(kColumns[i]) + " has another shape");
    }
    H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
    if (i > 0 && (size[0] != rows_ || size[1] != windows_)) {
      throw FormatError(path_, -1, std::string(kColumns[i]) + " has another shape than the others");
    }
    rows_ = size[0];
    windows_ = size[1];
  }
  const Handle frames(H5Dopen2(file_->get(), "frame", H5P_DEFAULT), H5Dclose, path_ + ", frame");
  const Handle space(H5Dget_space(frames.get()), H5Sclose, path_);
  if (H5Sget_simple_extent_npoints(space.get()) != static_cast<hssize_t>(rows_)) {
    throw FormatError(path_, -1, "frame has another length than the fields");
  }
  frames_.resize(rows_);
  if (H5Dread(frames.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, frames_.data()) < 0) {
    throw FileError("HDF5 cannot read", path_);
  }
}

FieldFrames::~FieldFrames() {
  const Guard guard(report::hdf5::lock());
  for (Handle& column : columns_) column = Handle();
  file_.reset();
}

std::vector<float> FieldFrames::frame(std::size_t row) const {
  if (row >= rows_) throw InvalidArgument("fields.h5 has no row " + std::to_string(row), path_);
  return read(row, 1, 0, windows_);
}

std::vector<float> FieldFrames::history(std::size_t window) const {
  if (window >= windows_) {
    throw InvalidArgument("fields.h5 has no window " + std::to_string(window), path_);
  }
  return read(0, rows_, window, 1);
}

std::vector<float> FieldFrames::read(std::size_t row, std::size_t rows, std::size_t window,
                                     std::size_t windows) const {
  const Guard guard(report::hdf5::lock());
  const std::size_t count = rows * windows;
  std::vector<float> values(count * kColumns.size());
  const std::array<hsize_t, 2> start = {row, window}, size = {rows, windows};
  const Handle memory(H5Screate_simple(2, size.data(), nullptr), H5Sclose, path_);
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const Handle space(H5Dget_space(columns_[i].get()), H5Sclose, path_);
    if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(),
                            nullptr) < 0 ||
        H5Dread(columns_[i].get(), H5T_NATIVE_FLOAT, memory.get(), space.get(), H5P_DEFAULT,
                values.data() + i * count) < 0) {
      throw FileError("HDF5 cannot read", path_ + ", " + kColumns[i]);
    }
  }
  return values;
}

}  // namespace impactdic::view
