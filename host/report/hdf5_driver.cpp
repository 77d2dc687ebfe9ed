#include "host/report/hdf5_driver.h"

#include <algorithm>
#include <compare>
#include <cstdint>
#include <exception>
#include <iterator>
#include <utility>

#include "host/report/journaled_file.h"
#if H5_VERSION_GE(1, 14, 0)
#include <H5FDdevelop.h>
#endif

namespace impactdic::report::hdf5 {
namespace {

constexpr haddr_t kMost = (haddr_t{1} << 63) - 1;

// HDF5 keeps its own part at the beginning.
struct Driven {
  H5FD_t head;
  JournaledFile file;
  haddr_t end_of_allocated = 0;
  std::pair<std::uint64_t, std::uint64_t> identity;  // device and inode
  // What HDF5 believes to be written is not: nothing is committed from here on.
  bool failed = false;
};

Driven& of(H5FD_t* file) { return *reinterpret_cast<Driven*>(file); }
const Driven& of(const H5FD_t* file) { return *reinterpret_cast<const Driven*>(file); }

// HDF5 is C: exceptions end here.
template <typename Fn>
herr_t guarded(Driven& driven, Fn fn) {
  if (driven.failed) return -1;
  try {
    fn(driven.file);
    return 0;
  } catch (const std::exception&) {
    driven.failed = true;
    return -1;
  }
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t, haddr_t) {
  try {
    auto file =
        (flags & H5F_ACC_TRUNC) != 0 ? JournaledFile::create(name) : JournaledFile::open(name);
    const auto identity = file.identity();
    return &(new Driven{{}, std::move(file), 0, identity})->head;
  } catch (const std::exception&) {
    return nullptr;
  }
}

herr_t close_file(H5FD_t* file) {
  delete &of(file);
  return 0;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const auto order = of(a).identity <=> of(b).identity;
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
  }
  return 0;
}

haddr_t end_of_allocated(const H5FD_t* file, H5FD_mem_t) { return of(file).end_of_allocated; }
herr_t set_end_of_allocated(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  of(file).end_of_allocated = end;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) { return of(file).file.size(); }

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t count, void* out) {
  return guarded(of(file), [&](JournaledFile& journaled) {
    journaled.read(at, {static_cast<std::uint8_t*>(out), count});
  });
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t count, const void* bytes) {
  return guarded(of(file), [&](JournaledFile& journaled) {
    journaled.write(at, {static_cast<const std::uint8_t*>(bytes), count});
  });
}

herr_t flush(H5FD_t* file, hid_t, hbool_t) {
  return guarded(of(file), [](JournaledFile& journaled) { journaled.commit(); });
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  Driven& driven = of(file);
  return guarded(driven,
                 [&](JournaledFile& journaled) { journaled.resize(driven.end_of_allocated); });
}

H5FD_class_t describe() {
  H5FD_class_t driver = {};
#if H5_VERSION_GE(1, 14, 0)
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(511);  // of those for use within a laboratory
#endif
  driver.name = "journal";
  driver.maxaddr = kMost;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.open = open_file;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = query;
  driver.get_eoa = end_of_allocated;
  driver.set_eoa = set_end_of_allocated;
  driver.get_eof = end_of_file;
  driver.read = read;
  driver.write = write;
  driver.flush = flush;
  driver.truncate = truncate;
  const H5FD_mem_t kinds[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kinds), std::end(kinds), std::begin(driver.fl_map));
  return driver;
}

}  // namespace

herr_t use_journal(hid_t access) {
  static const H5FD_class_t driver = describe();
  static const hid_t id = H5FDregister(&driver);
  return id < 0 ? -1 : H5Pset_driver(access, id, nullptr);
}

}  // namespace impactdic::report::hdf5
