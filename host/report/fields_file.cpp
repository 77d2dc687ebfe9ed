#include "host/report/fields_file.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <numeric>
#include <utility>

#include "host/report/hdf5.h"

namespace impactdic::report {
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
  float WindowMotion::*value = nullptr;
};

// Where the window stood is known whatever came of it; the rest only where it was measured.
constexpr std::array kPlaces = {
    Column{"x_px", "px", "centre of the window in the frame, x right"},
    Column{"y_px", "px", "centre of the window in the frame, y down"},
};
constexpr std::array kMeasured = {
    Column{"u_px", "px", "displacement of the window's centre, x right", &WindowMotion::u},
    Column{"v_px", "px", "displacement of the window's centre, y down", &WindowMotion::v},
    Column{"u_sd_px", "px", "one standard deviation of u_px", &WindowMotion::u_sd},
    Column{"v_sd_px", "px", "one standard deviation of v_px", &WindowMotion::v_sd},
    Column{"correlation", "1", "zero-mean normalised cross-correlation (ZNCC)",
           &WindowMotion::correlation},
    Column{"peak_ratio", "1", "highest correlation peak over the highest one elsewhere",
           &WindowMotion::peak_ratio},
    Column{"ux", "1", "displacement gradient du/dx", &WindowMotion::ux},
    Column{"uy", "1", "displacement gradient du/dy", &WindowMotion::uy},
    Column{"vx", "1", "displacement gradient dv/dx", &WindowMotion::vx},
    Column{"vy", "1", "displacement gradient dv/dy", &WindowMotion::vy},
};
constexpr std::size_t kColumnCount = kPlaces.size() + kMeasured.size();

constexpr const Column& column(std::size_t index) {
  return index < kPlaces.size() ? kPlaces[index] : kMeasured[index - kPlaces.size()];
}

// Puts a frame's values where each column has its place for them, all in one look at every window:
// what another thread has measured is slow to fetch.
template <std::size_t... k>
void gather(const Rows& rows, const std::array<float*, kColumnCount>& columns,
            std::index_sequence<k...>) {
  for (std::size_t i = 0; i < rows.field.size(); ++i) {
    const WindowMotion& motion = rows.field[i];
    const bool measured = motion.status == static_cast<std::int32_t>(WindowStatus::kOk);
    columns[0][i] = static_cast<float>(rows.windows[i].x0 + rows.half);
    columns[1][i] = static_cast<float>(rows.windows[i].y0 + rows.half);
    ((columns[kPlaces.size() + k][i] = measured ? motion.*kMeasured[k].value : NAN), ...);
  }
}

// In a camera's plane of motion.
struct PlaneColumn {
  const char* name;
  const char* meaning;
  double PlaneResult::*value;
};
constexpr std::array kPlaneColumns = {
    PlaneColumn{"x_m", "centre of the window in the plane of motion, X right", &PlaneResult::x_m},
    PlaneColumn{"y_m", "centre of the window in the plane of motion, Y up", &PlaneResult::y_m},
    PlaneColumn{"u_m", "displacement in the plane of motion, X right", &PlaneResult::u_m},
    PlaneColumn{"v_m", "displacement in the plane of motion, Y up", &PlaneResult::v_m},
    PlaneColumn{"u_sd_m", "one standard deviation of u_m without the camera's",
                &PlaneResult::u_sd_m},
    PlaneColumn{"v_sd_m", "one standard deviation of v_m without the camera's",
                &PlaneResult::v_sd_m},
};

// Grows where a reader must know of a change; datasets and attributes are only ever added.
constexpr double kSchemaVersion = 1;

constexpr std::array kCentreNames = {"centre_u_px", "centre_v_px", "centre_u_sd_px",
                                     "centre_v_sd_px"};

}  // namespace

struct FieldsFile::Impl {
  hdf5::File file;
  double half;
  std::size_t windows = 0;
  std::size_t rows = 0, gathered = 0;  // frames, and those of them that are only in memory
  std::future<void> writing;
  hdf5::Table time, frame, window, status, mask;
  std::array<hdf5::Table, kColumnCount> columns;
  std::array<hdf5::Table, kCentreNames.size()> centre;
  std::vector<hdf5::Table> plane;  // none without a camera

  Impl(hdf5::File opened, int window_px) : file(std::move(opened)), half((window_px - 1) / 2.0) {}

  template <typename Fn>
  void each_table(Fn&& fn) {
    fn(time);
    fn(frame);
    fn(status);
    fn(mask);
    for (hdf5::Table& table : columns) fn(table);
    for (hdf5::Table& table : centre) fn(table);
    for (hdf5::Table& table : plane) fn(table);
  }

  // Puts the gathered rows into the file beside what comes next.
  void write_behind() {
    wait();
    each_table([](hdf5::Table& table) { table.set_aside(); });
    gathered = 0;
    writing = std::async(std::launch::async, [this] {
      const hdf5::Guard guard(hdf5::lock());
      each_table([](hdf5::Table& table) { table.write(); });
    });
  }
  // Until all that was to be written is. Throws what went wrong there.
  void wait() {
    if (writing.valid()) writing.get();
  }

  void make_tables(std::size_t count) {
    windows = count;
    time = hdf5::Table::create<double>(file, "time", 0, kNotMeasured);
    frame = hdf5::Table::create<std::int64_t>(file, "frame", 0, -1);
    window = hdf5::Table::create<std::int32_t>(file, "window", 0, -1);
    auto* const indices = window.append<std::int32_t>(count);
    std::iota(indices, indices + count, 0);
    window.set_aside();
    window.write();
    time.become_scale("time");
    window.become_scale("window");
    status = hdf5::Table::create<std::uint8_t>(file, "status", count, 1);
    mask = hdf5::Table::create<std::uint8_t>(file, "mask", count, 0);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      columns[i] = hdf5::Table::create<float>(file, column(i).name, count, NAN);
      describe(column(i).name, column(i).units, column(i).meaning);
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
    explain_flags();
    show_to_viewers();
  }

  void make_plane_tables() {
    for (const PlaneColumn& one : kPlaneColumns) {
      plane.push_back(hdf5::Table::create<double>(file, one.name, windows, kNotMeasured));
      describe(one.name, "m", one.meaning);
      attach(plane.back());
    }
  }

  // As the CF conventions write flags, which readers of them turn into words.
  void explain_flags() {
    std::string words;
    std::vector<std::uint8_t> values;
    for (int k = 0; k <= static_cast<int>(WindowStatus::kOutOfView); ++k) {
      words += (k > 0 ? " " : "") + std::string(to_string(static_cast<WindowStatus>(k)));
      values.push_back(static_cast<std::uint8_t>(k));
    }
    file.set_attribute("status", "flag_meanings", words);
    file.set_attribute("status", "flag_values", values);
  }

  // NXdata of the NeXus format: a viewer plots the group that `default` names, with its errors.
  void show_to_viewers() {
    file.make_group("displacement");
    for (const char* name : {"time", "window", "u_px", "v_px"}) {
      file.link(std::string("/") + name, std::string("displacement/") + name);
    }
    file.link("/u_sd_px", "displacement/u_px_errors");
    file.link("/v_sd_px", "displacement/v_px_errors");
    file.set_attribute("displacement", "NX_class", "NXdata");
    file.set_attribute("displacement", "signal", "u_px");
    file.set_attribute("displacement", "auxiliary_signals", std::vector<std::string>{"v_px"});
    file.set_attribute("displacement", "axes", std::vector<std::string>{"time", "window"});
    file.set_attribute("/", "NX_class", "NXroot");
    file.set_attribute("/", "default", "displacement");
    file.set_attribute("/", "schema_version", kSchemaVersion);
  }

  void attach(hdf5::Table& table) {
    table.attach_scale(0, time);
    table.attach_scale(1, window);
  }

  void describe(const std::string& name, const char* units, const char* meaning) {
    file.set_attribute(name, "units", units);
    file.set_attribute(name, "description", meaning);
  }

  void open_tables(bool with_plane) {
    time = hdf5::Table::open(file, "time");
    frame = hdf5::Table::open(file, "frame");
    window = hdf5::Table::open(file, "window");
    status = hdf5::Table::open(file, "status");
    mask = hdf5::Table::open(file, "mask");
    for (std::size_t i = 0; i < columns.size(); ++i) {
      columns[i] = hdf5::Table::open(file, column(i).name);
    }
    for (std::size_t i = 0; i < kCentreNames.size(); ++i) {
      centre[i] = hdf5::Table::open(file, kCentreNames[i]);
    }
    windows = window.rows();
    if (!with_plane) return;
    for (const PlaneColumn& one : kPlaneColumns) plane.push_back(hdf5::Table::open(file, one.name));
  }
};

FieldsFile::FieldsFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FieldsFile::~FieldsFile() {
  if (!impl_) return;
  try {
    impl_->write_behind();
    impl_->wait();
  } catch (const Error&) {
    // Who wants to know has called `flush`.
  }
  const hdf5::Guard guard(hdf5::lock());
  impl_.reset();
}
FieldsFile::FieldsFile(FieldsFile&&) noexcept = default;

FieldsFile FieldsFile::create(const std::filesystem::path& path, std::size_t window_count,
                              int window_px, const Attributes& attributes, int compression,
                              bool plane) {
  const hdf5::Guard guard(hdf5::lock());
  auto impl = std::make_unique<Impl>(hdf5::File::create(path.string(), compression), window_px);
  // Of a clip without a ball: one window, masked in every frame.
  impl->make_tables(std::max<std::size_t>(window_count, 1));
  if (plane) impl->make_plane_tables();
  for (const auto& attribute : attributes) {
    std::visit([&](const auto& v) { impl->file.set_attribute("/", attribute.first, v); },
               attribute.second);
  }
  impl->file.flush();  // a file without frames, from which on it is never half written
  return FieldsFile(std::move(impl));
}

FieldsFile FieldsFile::resume(const std::filesystem::path& path, int window_px, std::size_t rows,
                              bool plane) {
  const hdf5::Guard guard(hdf5::lock());
  auto impl = std::make_unique<Impl>(hdf5::File::open(path.string()), window_px);
  impl->open_tables(plane);
  impl->each_table([&](hdf5::Table& table) {
    if (table.rows() < rows) {
      throw FormatError(path.string(), -1,
                        "it holds " + std::to_string(table.rows()) + " frames, not the " +
                            std::to_string(rows) + " of track.csv");
    }
    table.truncate(rows);
  });
  impl->rows = rows;
  return FieldsFile(std::move(impl));
}

void FieldsFile::add(std::int64_t frame, double time_s, std::span<const Window> windows,
                     std::span<const WindowMotion> field, const TrackRow* row,
                     std::span<const PlaneResult> plane) {
  Impl& file = *impl_;
  const std::size_t count = file.windows;
  if (!field.empty() && (field.size() != count || windows.size() != count)) {
    throw InvalidArgument("the field has another number of windows than its file");
  }
  *file.time.append<double>() = time_s;
  *file.frame.append<std::int64_t>() = frame;
  auto* const status = file.status.append<std::uint8_t>();
  auto* const mask = file.mask.append<std::uint8_t>();
  std::array<float*, kColumnCount> columns{};
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = file.columns[c].append<float>();
  if (field.empty()) {
    std::fill_n(status, count, static_cast<std::uint8_t>(WindowStatus::kMasked));
    std::fill_n(mask, count, std::uint8_t{0});
    for (float* column : columns) std::fill_n(column, count, NAN);
  } else {
    gather({windows, field, file.half}, columns, std::make_index_sequence<kMeasured.size()>());
    for (std::size_t i = 0; i < count; ++i) {
      status[i] = static_cast<std::uint8_t>(field[i].status);
      mask[i] = field[i].status != static_cast<std::int32_t>(WindowStatus::kMasked);
    }
  }
  for (std::size_t c = 0; c < file.plane.size(); ++c) {
    auto* const values = file.plane[c].append<double>();
    std::fill_n(values, count, kNotMeasured);
    for (std::size_t i = 0; i < std::min(count, plane.size()); ++i) {
      values[i] = plane[i].*kPlaneColumns[c].value;
    }
  }
  const double nothing = kNotMeasured;
  const std::array<double, 4> centre =
      row != nullptr
          ? std::array{row->centre_u_px, row->centre_v_px, row->centre_u_sd_px, row->centre_v_sd_px}
          : std::array{nothing, nothing, nothing, nothing};
  for (std::size_t i = 0; i < centre.size(); ++i) *file.centre[i].append<double>() = centre[i];
  // Whole chunks of the columns, also behind a part of one that has been flushed.
  const std::size_t chunk = file.columns.front().chunk_rows();
  ++file.gathered;
  ++file.rows;
  if (file.gathered >= chunk || file.rows % chunk == 0) file.write_behind();
}

void FieldsFile::flush() {
  impl_->write_behind();
  impl_->wait();
  const hdf5::Guard guard(hdf5::lock());
  impl_->file.flush();
}
void FieldsFile::set_scale(double metre_per_px, double fps, double surface_angle_deg,
                           const std::string& camera) {
  const hdf5::Guard guard(hdf5::lock());
  const auto set = [this](const char* name, double value, bool known) {
    if (known) impl_->file.set_attribute("/", name, value);
  };
  set("scale_m_per_px", metre_per_px, metre_per_px > 0);
  set("analysed_fps", fps, fps > 0);
  set("surface_angle_deg", surface_angle_deg, std::isfinite(surface_angle_deg));
  if (!camera.empty()) impl_->file.set_attribute("/", "camera", camera);
  impl_->file.flush();
}
void FieldsFile::set_source_digest(const video::ClipDigest& digest) {
  const hdf5::Guard guard(hdf5::lock());
  impl_->file.set_attribute("/", "source_sha256", digest.sha256);
  if (!digest.header_sha256.empty()) {
    impl_->file.set_attribute("/", "source_header_sha256", digest.header_sha256);
  }
  impl_->file.flush();
}
std::size_t FieldsFile::rows() const { return impl_->rows; }

}  // namespace impactdic::report
