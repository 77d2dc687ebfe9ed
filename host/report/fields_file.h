// fields.h5: the displacement field of every frame, self-describing. Datasets of shape
// (time, window) with dimension scales `time` (s) and `window` (index); see docs/file-formats.md.
// The group `displacement` shows them once more as NXdata (NeXus), which viewers of HDF5 plot.
#pragma once

#include <impactdic/correlate.h>

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>

#include "host/clip/track_row.h"
#include "host/dic/field.h"
#include "host/video/clip_digest.h"

namespace impactdic::report {

// Written as attributes of the file: every option, version, device, driver, source, axes.
using Attributes = std::map<std::string, std::variant<double, std::string>>;

// Several may be written at once, each by a thread of its own.
class FieldsFile {
 public:
  // Starts the file anew with room for `window_count` windows a frame, compressed at level 1 … 9
  // (deflate) or not at all (0). `plane`: displacements in a camera's plane are added, too. Throws
  // FileError here and below.
  static FieldsFile create(const std::filesystem::path& path, std::size_t window_count,
                           int window_px, const Attributes& attributes, int compression = 0,
                           bool plane = false);
  // Opens the file of an earlier run and keeps its first `rows` frames; `plane` as it was made.
  // Throws FormatError where it holds fewer.
  static FieldsFile resume(const std::filesystem::path& path, int window_px, std::size_t rows,
                           bool plane = false);
  ~FieldsFile();
  FieldsFile(FieldsFile&&) noexcept;

  // One frame's field. `windows` and `field` have the file's window count, or are empty: then all
  // values are NaN and every window's status is `masked`. centre_*: see TrackRow. `plane`: one a
  // window, or empty.
  void add(std::int64_t frame, double time_s, std::span<const Window> windows,
           std::span<const WindowMotion> field, const TrackRow* row,
           std::span<const PlaneResult> plane = {});
  // Frames are gathered; this puts all of them on the disk.
  void flush();
  // Known when the run ends: attributes `scale_m_per_px`, `analysed_fps`, `surface_angle_deg`,
  // `camera` (its file). What is not known (0, 0, NaN, "") is left out.
  void set_scale(double metre_per_px, double fps, double surface_angle_deg,
                 const std::string& camera);
  // Of the clip, known when all of it has been read.
  void set_source_digest(const video::ClipDigest& digest);
  std::size_t rows() const;

 private:
  struct Impl;
  explicit FieldsFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace impactdic::report
