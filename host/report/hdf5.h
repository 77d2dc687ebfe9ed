// The few things that we need of HDF5, with errors as exceptions and handles that close.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace impactdic::report::hdf5 {

// HDF5 has one state for the whole program: two files are not used at once, even by two threads.
std::recursive_mutex& lock();
using Guard = std::lock_guard<std::recursive_mutex>;

// An HDF5 identifier that is closed once.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  // Throws FileError naming `what` where `id` is invalid.
  Handle(hid_t id, Close close, const std::string& what);
  Handle(Handle&& other) noexcept { *this = std::move(other); }
  Handle& operator=(Handle&& other) noexcept;
  ~Handle();
  hid_t get() const { return id_; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

// The element type of a C++ scalar in memory.
template <typename T>
hid_t native_type();
template <>
inline hid_t native_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t native_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
inline hid_t native_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}

class File {
 public:
  // Creates the file anew, or opens it for writing. HDF5 must not print: errors are ours.
  // Tables made in it are compressed at `compression` (deflate, 1 … 9, behind shuffled bytes); 0:
  // not at all.
  static File create(const std::string& path, int compression = 0);
  static File open(const std::string& path);
  // For reading alone; what a killed run left in its journal is not seen.
  static File open_to_read(const std::string& path);
  hid_t get() const { return handle_.get(); }
  const std::string& path() const { return path_; }
  int compression() const { return compression_; }
  void flush();

  void set_attribute(const std::string& object, const std::string& name, const std::string& text);
  void set_attribute(const std::string& object, const std::string& name, double value);
  void set_attribute(const std::string& object, const std::string& name,
                     const std::vector<std::string>& texts);
  void set_attribute(const std::string& object, const std::string& name,
                     const std::vector<std::uint8_t>& values);
  void make_group(const std::string& path);
  // `path` shows the same as `target`, both from the root on.
  void link(const std::string& target, const std::string& path);

 private:
  File(std::string path, Handle handle) : path_(std::move(path)), handle_(std::move(handle)) {}
  std::string path_;
  Handle handle_;
  int compression_ = 0;
};

// A dataset that grows along its first dimension: (rows, columns), or (rows) where columns is 0.
// Rows are gathered in memory; `set_aside` and `write` bring them into the file, the latter beside
// further appends, on another thread.
class Table {
 public:
  Table() = default;
  // `fill` marks cells never written.
  template <typename T>
  static Table create(File& file, const std::string& name, std::size_t columns, T fill) {
    return create(file, name, columns, native_type<T>(), &fill);
  }
  static Table open(File& file, const std::string& name);

  // Appends `count` rows whose max(columns, 1) elements each are put where this points to, before
  // the next call.
  template <typename T>
  T* append(std::size_t count = 1) {
    type_ = &native_type<T>;
    return static_cast<T*>(append(count, sizeof(T)));
  }
  // Those gathered and set aside included.
  std::size_t rows() const { return written_ + aside_ + gathered_; }
  std::size_t chunk_rows() const { return chunk_rows_; }
  // Beside what was set aside before and could not be written.
  void set_aside();
  // Puts the rows set aside into the file.
  void write();
  // Forgets the rows from `rows` on.
  void truncate(std::size_t rows);
  // Makes `scale` the dimension scale of this table's dimension `dimension`.
  void attach_scale(unsigned dimension, const Table& scale);
  // Marks this one-dimensional table as the dimension scale `name`.
  void become_scale(const std::string& name);
  hid_t get() const { return dataset_.get(); }

 private:
  static Table create(File& file, const std::string& name, std::size_t columns, hid_t type,
                      const void* fill);
  void* append(std::size_t count, std::size_t element_bytes);
  std::string name_;
  Handle dataset_;
  std::size_t columns_ = 0, chunk_rows_ = 1;
  std::size_t written_ = 0, aside_ = 0, gathered_ = 0;  // rows
  // Of the gathered values; asked for when they are written, since HDF5 answers one thread at a
  // time.
  hid_t (*type_)() = nullptr;
  std::vector<unsigned char> gathered_values_, aside_values_;
};

}  // namespace impactdic::report::hdf5
