#include "host/report/fields_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>

#include "host/base/error.h"
#include "host/report/hdf5.h"

namespace impactdic {
namespace {

// The windows of a frame.
struct Rows {
  std::span<const Window> windows;
  std::span<const WindowMotion> field;
  double half;
};

// One dataset of (time, window) floats: how it is called and what it holds.
struct Column {
  const char* name;
  const char* units;
  const char* meaning;
  void (*gather)(const Rows&, float* values);
};

// `place`: where the window stood, which is known whatever came of it; the rest only where it was
// measured.
template <bool place, typename Value>
constexpr Column column(const char* name, const char* units, const char* meaning, Value) {
  return {name, units, meaning, [](const Rows& rows, float* values) {
            constexpr Value kValue;
            for (std::size_t i = 0; i < rows.field.size(); ++i) {
              const bool known =
                  place || rows.field[i].status == static_cast<std::int32_t>(WindowStatus::ok);
              values[i] = known ? kValue(rows, i) : NAN;
            }
          }};
}

constexpr std::array kColumns = {
    column<true>("x_px", "px", "centre of the window in the frame, x right",
                 [](const Rows& rows, std::size_t i) {
                   return static_cast<float>(rows.windows[i].x0 + rows.half);
                 }),
    column<true>("y_px", "px", "centre of the window in the frame, y down",
                 [](const Rows& rows, std::size_t i) {
                   return static_cast<float>(rows.windows[i].y0 + rows.half);
                 }),
    column<false>("u_px", "px", "displacement of the window's centre, x right",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].u; }),
    column<false>("v_px", "px", "displacement of the window's centre, y down",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].v; }),
    column<false>("u_sd_px", "px", "one standard deviation of u_px",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].u_sd; }),
    column<false>("v_sd_px", "px", "one standard deviation of v_px",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].v_sd; }),
    column<false>("correlation", "1", "zero-mean normalised cross-correlation (ZNCC)",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].correlation; }),
    column<false>("peak_ratio", "1", "highest correlation peak over the highest one elsewhere",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].peak_ratio; }),
    column<false>("ux", "1", "displacement gradient du/dx",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].ux; }),
    column<false>("uy", "1", "displacement gradient du/dy",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].uy; }),
    column<false>("vx", "1", "displacement gradient dv/dx",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].vx; }),
    column<false>("vy", "1", "displacement gradient dv/dy",
                  [](const Rows& rows, std::size_t i) { return rows.field[i].vy; }),
};

// HDF5 has one state for the whole program: two files are not written at once, even by two threads.
std::recursive_mutex& hdf5_lock() {
  static std::recursive_mutex lock;
  return lock;
}
using Hdf5Guard = std::lock_guard<std::recursive_mutex>;

constexpr std::array kCentreNames = {"centre_u_px", "centre_v_px", "centre_u_sd_px",
                                     "centre_v_sd_px"};

}  // namespace

struct FieldsFile::Impl {
  hdf5::File file;
  double half;
  std::size_t windows = 0;
  hdf5::Table time, frame, window, status, mask;
  std::array<hdf5::Table, kColumns.size()> columns;
  std::array<hdf5::Table, kCentreNames.size()> centre;

  Impl(hdf5::File opened, int window_px) : file(std::move(opened)), half((window_px - 1) / 2.0) {}

  template <typename Fn>
  void each_table(Fn&& fn) {
    fn(time);
    fn(frame);
    fn(status);
    fn(mask);
    for (hdf5::Table& table : columns) fn(table);
    for (hdf5::Table& table : centre) fn(table);
  }

  // Puts the gathered rows into the file.
  void write() {
    each_table([](hdf5::Table& table) { table.write(); });
  }

  void make_tables(std::size_t count) {
    windows = count;
    time = hdf5::Table::create<double>(file, "time", 0, kNotMeasured);
    frame = hdf5::Table::create<std::int64_t>(file, "frame", 0, -1);
    window = hdf5::Table::create<std::int32_t>(file, "window", 0, -1);
    std::vector<std::int32_t> indices(count);
    std::iota(indices.begin(), indices.end(), 0);
    window.append<std::int32_t>(indices);
    window.write();
    time.become_scale("time");
    window.become_scale("window");
    status = hdf5::Table::create<std::uint8_t>(file, "status", count, 1);
    mask = hdf5::Table::create<std::uint8_t>(file, "mask", count, 0);
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      columns[i] = hdf5::Table::create<float>(file, kColumns[i].name, count, NAN);
      describe(kColumns[i].name, kColumns[i].units, kColumns[i].meaning);
    }
    for (std::size_t i = 0; i < kCentreNames.size(); ++i) {
      centre[i] = hdf5::Table::create<double>(file, kCentreNames[i], 0, kNotMeasured);
      describe(kCentreNames[i], "px", "the field interpolated at the ball's centre");
      centre[i].attach_scale(0, time);
    }
    frame.attach_scale(0, time);
    for (hdf5::Table* table : {&status, &mask}) attach(*table);
    for (hdf5::Table& table : columns) attach(table);
    describe("time", "s", "since the first analysed frame");
    describe("frame", "1", "number of the frame in the stored file");
    describe("mask", "1", "1: the window lies on the surface that is measured");
    describe("status", "1",
             "0 ok, 1 masked, 2 no_texture, 3 low_correlation, 4 at_search_edge, "
             "5 not_converged, 6 out_of_view");
  }

  void attach(hdf5::Table& table) {
    table.attach_scale(0, time);
    table.attach_scale(1, window);
  }

  void describe(const std::string& name, const char* units, const char* meaning) {
    file.set_attribute(name, "units", units);
    file.set_attribute(name, "description", meaning);
  }

  void open_tables() {
    time = hdf5::Table::open(file, "time");
    frame = hdf5::Table::open(file, "frame");
    window = hdf5::Table::open(file, "window");
    status = hdf5::Table::open(file, "status");
    mask = hdf5::Table::open(file, "mask");
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      columns[i] = hdf5::Table::open(file, kColumns[i].name);
    }
    for (std::size_t i = 0; i < kCentreNames.size(); ++i) {
      centre[i] = hdf5::Table::open(file, kCentreNames[i]);
    }
    windows = window.rows();
  }
};

FieldsFile::FieldsFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FieldsFile::~FieldsFile() {
  if (!impl_) return;
  const Hdf5Guard guard(hdf5_lock());
  try {
    impl_->write();
  } catch (const Error&) {
    // Who wants to know has called `flush`.
  }
  impl_.reset();
}
FieldsFile::FieldsFile(FieldsFile&&) noexcept = default;

FieldsFile FieldsFile::create(const std::filesystem::path& path, std::size_t window_count,
                              int window_px, const Attributes& attributes, int compression) {
  const Hdf5Guard guard(hdf5_lock());
  auto impl = std::make_unique<Impl>(hdf5::File::create(path.string(), compression), window_px);
  // Of a clip without a ball: one window, masked in every frame.
  impl->make_tables(std::max<std::size_t>(window_count, 1));
  for (const auto& [name, value] : attributes) {
    std::visit([&](const auto& v) { impl->file.set_attribute("/", name, v); }, value);
  }
  return FieldsFile(std::move(impl));
}

FieldsFile FieldsFile::resume(const std::filesystem::path& path, int window_px, std::size_t rows) {
  const Hdf5Guard guard(hdf5_lock());
  auto impl = std::make_unique<Impl>(hdf5::File::open(path.string()), window_px);
  impl->open_tables();
  impl->each_table([&](hdf5::Table& table) {
    if (table.rows() < rows) {
      throw FormatError(path.string(), -1,
                        "it holds " + std::to_string(table.rows()) + " frames, not the " +
                            std::to_string(rows) + " of track.csv");
    }
    table.truncate(rows);
  });
  return FieldsFile(std::move(impl));
}

void FieldsFile::add(std::int64_t frame, double time_s, std::span<const Window> windows,
                     std::span<const WindowMotion> field, const TrackRow* row) {
  const Hdf5Guard guard(hdf5_lock());
  Impl& file = *impl_;
  const bool measured = !field.empty();
  if (measured && (field.size() != file.windows || windows.size() != file.windows)) {
    throw InvalidArgument("the field has another number of windows than its file");
  }
  file.time.append<double>(std::span(&time_s, 1));
  file.frame.append<std::int64_t>(std::span(&frame, 1));
  std::vector<std::uint8_t> status(file.windows, static_cast<std::uint8_t>(WindowStatus::masked));
  std::vector<std::uint8_t> mask(file.windows, 0);
  if (measured) {
    for (std::size_t i = 0; i < file.windows; ++i) {
      status[i] = static_cast<std::uint8_t>(field[i].status);
      mask[i] = field[i].status != static_cast<std::int32_t>(WindowStatus::masked);
    }
  }
  file.status.append<std::uint8_t>(status);
  file.mask.append<std::uint8_t>(mask);
  std::vector<float> values(file.windows, NAN);
  const Rows rows = {windows, field, file.half};
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    kColumns[c].gather(rows, values.data());
    file.columns[c].append<float>(values);
  }
  const double nothing = kNotMeasured;
  const std::array<double, 4> centre =
      row != nullptr
          ? std::array{row->centre_u_px, row->centre_v_px, row->centre_u_sd_px, row->centre_v_sd_px}
          : std::array{nothing, nothing, nothing, nothing};
  for (std::size_t i = 0; i < centre.size(); ++i) {
    file.centre[i].append<double>(std::span(&centre[i], 1));
  }
}

void FieldsFile::flush() {
  const Hdf5Guard guard(hdf5_lock());
  impl_->write();
  impl_->file.flush();
}
void FieldsFile::set_source_digest(const ClipDigest& digest) {
  const Hdf5Guard guard(hdf5_lock());
  impl_->file.set_attribute("/", "source_sha256", digest.sha256);
  if (!digest.header_sha256.empty()) {
    impl_->file.set_attribute("/", "source_header_sha256", digest.header_sha256);
  }
  impl_->file.flush();
}
std::size_t FieldsFile::rows() const {
  const Hdf5Guard guard(hdf5_lock());
  return impl_->time.rows();
}

}  // namespace impactdic
