// Reads fields.h5 frame by frame, and window by window.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/report/hdf5.h"

namespace impactdic::view {

class FieldFrames {
 public:
  // Opens the file for reading. Throws FileError where that fails, FormatError where it is none of
  // ours.
  explicit FieldFrames(const std::filesystem::path& path);
  ~FieldFrames();
  FieldFrames(const FieldFrames&) = delete;
  FieldFrames& operator=(const FieldFrames&) = delete;

  // Datasets as `frame` and `history` give them, units in their names.
  static constexpr std::array kColumns = {"x_px",    "y_px",        "u_px",       "v_px", "u_sd_px",
                                          "v_sd_px", "correlation", "peak_ratio", "ux",   "uy",
                                          "vx",      "vy",          "status"};
  std::size_t rows() const { return rows_; }
  std::size_t windows() const { return windows_; }
  // Frame numbers of the stored file, by row.
  const std::vector<std::int64_t>& frames() const { return frames_; }

  // (columns, windows) of a row; NaN where nothing was measured. Throws InvalidArgument for a row
  // that is not there, FileError.
  std::vector<float> frame(std::size_t row) const;
  // (columns, rows) of a window.
  std::vector<float> history(std::size_t window) const;

 private:
  std::vector<float> read(std::size_t row, std::size_t rows, std::size_t window,
                          std::size_t windows) const;
  std::string path_;
  std::optional<report::hdf5::File> file_;
  std::array<report::hdf5::Handle, kColumns.size()> columns_;
  std::size_t rows_ = 0, windows_ = 0;
  std::vector<std::int64_t> frames_;
};

}  // namespace impactdic::view
