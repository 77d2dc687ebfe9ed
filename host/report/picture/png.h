// Pictures to PNG files (libpng).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace impactdic::report {

// `bgr` holds (height, width, 3) bytes, blue first. Throws FileError.
void write_png_bgr(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint8_t> bgr);

// The same of (height, width) grey bytes.
void write_png_grey(const std::filesystem::path& path, int width, int height,
                    std::span<const std::uint8_t> grey);

// Reads a PNG file as (height, width, 3) bytes, blue first. Throws FileError.
std::vector<std::uint8_t> read_png_bgr(const std::filesystem::path& path, int& width, int& height);

}  // namespace impactdic::report
