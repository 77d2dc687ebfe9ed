#include "host/report/hdf5.h"

#include <hdf5_hl.h>
#include <impactdic/error.h>

#include <algorithm>
#include <array>

#include "host/report/hdf5_driver.h"

namespace impactdic::report::hdf5 {
namespace {

void check(herr_t status, const std::string& what) {
  if (status < 0) throw FileError("HDF5 cannot write", what, "is the disk full?");
}

// HDF5 must not print. Nor may it clean up when the program ends: a file that could not be written
// because the disk is full is tried once more then, and that crashes. Our handles close everything.
void begin() {
  static const bool once = H5dont_atexit() >= 0;
  (void)once;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // of this thread
}

Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file access");
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V110), "file access");
  check(use_journal(access.get()), "file access");
  return access;
}

// Of a file's root, a group or a table: without the hour at which it was made, so that the same
// results are the same bytes.
Handle without_time(hid_t kind, const std::string& what) {
  Handle properties(H5Pcreate(kind), H5Pclose, what);
  check(H5Pset_obj_track_times(properties.get(), false), what);
  return properties;
}

}  // namespace

std::recursive_mutex& lock() {
  static std::recursive_mutex mutex;
  return mutex;
}

Handle::Handle(hid_t id, Close close, const std::string& what) : id_(id), close_(close) {
  if (id < 0) throw FileError("HDF5 cannot open or make it", what);
}

Handle& Handle::operator=(Handle&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(close_, other.close_);
  return *this;
}

Handle::~Handle() {
  if (id_ >= 0) close_(id_);
}

File File::create(const std::string& path, int compression) {
  begin();
  const Handle access = file_access(), root = without_time(H5P_FILE_CREATE, path);
  File file(path, Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, root.get(), access.get()), H5Fclose,
                         path));
  file.compression_ = compression;
  return file;
}

File File::open(const std::string& path) {
  begin();
  const Handle access = file_access();
  return {path, Handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, access.get()), H5Fclose, path)};
}

File File::open_to_read(const std::string& path) {
  begin();
  return {path, Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, path)};
}

void File::flush() { check(H5Fflush(get(), H5F_SCOPE_GLOBAL), path_); }

void File::set_attribute(const std::string& object, const std::string& name,
                         const std::string& text) {
  check(H5LTset_attribute_string(get(), object.c_str(), name.c_str(), text.c_str()), name);
}

void File::set_attribute(const std::string& object, const std::string& name, double value) {
  check(H5LTset_attribute_double(get(), object.c_str(), name.c_str(), &value, 1), name);
}

void File::set_attribute(const std::string& object, const std::string& name,
                         const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::string cells;
  for (const std::string& text : texts) cells += text + std::string(longest - text.size(), '\0');
  const hsize_t count = texts.size();
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, name);
  check(H5Tset_size(type.get(), longest), name);
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), name);
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, name);
  const Handle attribute(H5Acreate_by_name(get(), object.c_str(), name.c_str(), type.get(),
                                           space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, name);
  check(H5Awrite(attribute.get(), type.get(), cells.data()), name);
}

void File::set_attribute(const std::string& object, const std::string& name,
                         const std::vector<std::uint8_t>& values) {
  check(H5LTset_attribute_uchar(get(), object.c_str(), name.c_str(), values.data(), values.size()),
        name);
}

void File::make_group(const std::string& path) {
  const Handle properties = without_time(H5P_GROUP_CREATE, path);
  const Handle group(H5Gcreate2(get(), path.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                     H5Gclose, path);
}

void File::link(const std::string& target, const std::string& path) {
  check(H5Lcreate_soft(target.c_str(), get(), path.c_str(), H5P_DEFAULT, H5P_DEFAULT), path);
}

Table Table::create(File& file, const std::string& name, std::size_t columns, hid_t type,
                    const void* fill) {
  // Chunks of about 256 KiB: few enough to index, small enough to read one window's history.
  const hsize_t width = std::max<std::size_t>(columns, 1);
  const hsize_t depth = std::clamp<hsize_t>((1u << 18) / (width * H5Tget_size(type)), 1, 16384);
  const int rank = columns == 0 ? 1 : 2;
  const std::array<hsize_t, 2> none = {0, width}, most = {H5S_UNLIMITED, width},
                               chunk = {depth, width};
  const Handle space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose, name);
  const Handle properties = without_time(H5P_DATASET_CREATE, name);
  check(H5Pset_chunk(properties.get(), rank, chunk.data()), name);
  check(H5Pset_fill_value(properties.get(), type, fill), name);
  if (file.compression() > 0) {
    check(H5Pset_shuffle(properties.get()), name);
    check(H5Pset_deflate(properties.get(), static_cast<unsigned>(file.compression())), name);
  }
  // Rows come a chunk at a time: a cache would only copy them once more, and what fills a new chunk
  // is overwritten at once.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose, name);
  if (file.compression() == 0) {
    check(H5Pset_chunk_cache(access.get(), 0, 0, 1), name);
    check(H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER), name);
  }
  Table table;
  table.name_ = name;
  table.columns_ = columns;
  table.chunk_rows_ = depth;
  table.dataset_ = Handle(H5Dcreate2(file.get(), name.c_str(), type, space.get(), H5P_DEFAULT,
                                     properties.get(), access.get()),
                          H5Dclose, file.path() + ", " + name);
  return table;
}

Table Table::open(File& file, const std::string& name) {
  Table table;
  table.name_ = name;
  table.dataset_ =
      Handle(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose, file.path() + ", " + name);
  const Handle space(H5Dget_space(table.get()), H5Sclose, name);
  std::array<hsize_t, 2> size = {0, 0};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > 2) throw FormatError(file.path(), -1, name + " has another shape");
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  table.written_ = size[0];
  table.columns_ = rank == 2 ? size[1] : 0;
  const Handle properties(H5Dget_create_plist(table.get()), H5Pclose, name);
  std::array<hsize_t, 2> chunk = {1, 1};
  H5Pget_chunk(properties.get(), rank, chunk.data());
  table.chunk_rows_ = chunk[0];
  return table;
}

void* Table::append(std::size_t count, std::size_t element_bytes) {
  const std::size_t begin = gathered_values_.size();
  gathered_values_.resize(begin + count * std::max<std::size_t>(columns_, 1) * element_bytes);
  gathered_ += count;
  return gathered_values_.data() + begin;
}

void Table::set_aside() {
  if (aside_ == 0) {
    aside_values_.swap(gathered_values_);
  } else {
    aside_values_.insert(aside_values_.end(), gathered_values_.begin(), gathered_values_.end());
  }
  gathered_values_.clear();
  aside_ += gathered_;
  gathered_ = 0;
}

void Table::write() {
  if (aside_ == 0) return;
  begin();
  const hsize_t width = std::max<std::size_t>(columns_, 1);
  const int rank = columns_ == 0 ? 1 : 2;
  const std::array<hsize_t, 2> size = {written_ + aside_, width}, start = {written_, 0},
                               block = {aside_, width};
  check(H5Dset_extent(get(), size.data()), name_);
  const Handle target(H5Dget_space(get()), H5Sclose, name_);
  check(H5Sselect_hyperslab(target.get(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr),
        name_);
  const Handle source(H5Screate_simple(rank, block.data(), nullptr), H5Sclose, name_);
  check(H5Dwrite(get(), type_(), source.get(), target.get(), H5P_DEFAULT, aside_values_.data()),
        name_);
  written_ += aside_;
  aside_ = 0;
}

void Table::truncate(std::size_t rows) {
  const std::array<hsize_t, 2> size = {rows, std::max<std::size_t>(columns_, 1)};
  check(H5Dset_extent(get(), size.data()), name_);
  written_ = rows;
}

void Table::attach_scale(unsigned dimension, const Table& scale) {
  check(H5DSattach_scale(get(), scale.get(), dimension), name_);
}

void Table::become_scale(const std::string& name) {
  check(H5DSset_scale(get(), name.c_str()), name_);
}

}  // namespace impactdic::report::hdf5
