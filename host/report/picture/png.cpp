#include "host/report/picture/png.h"

#include <impactdic/error.h>
#include <png.h>

namespace impactdic::report {

namespace {

void write_png(const std::filesystem::path& path, int width, int height, png_uint_32 format,
               std::span<const std::uint8_t> pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  image.flags = PNG_IMAGE_FLAG_FAST;
  if (pixels.size() != PNG_IMAGE_SIZE(image)) {
    throw InvalidArgument("a picture's bytes and size differ");
  }
  if (png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr) == 0) {
    throw FileError(std::string("cannot write the picture: ") + image.message, path.string());
  }
}

}  // namespace

void write_png_bgr(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint8_t> bgr) {
  write_png(path, width, height, PNG_FORMAT_BGR, bgr);
}

void write_png_grey(const std::filesystem::path& path, int width, int height,
                    std::span<const std::uint8_t> grey) {
  write_png(path, width, height, PNG_FORMAT_GRAY, grey);
}

std::vector<std::uint8_t> read_png_bgr(const std::filesystem::path& path, int& width, int& height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  std::vector<std::uint8_t> bgr;
  bool read = png_image_begin_read_from_file(&image, path.c_str()) != 0;
  if (read) {
    image.format = PNG_FORMAT_BGR;
    bgr.resize(PNG_IMAGE_SIZE(image));
    read = png_image_finish_read(&image, nullptr, bgr.data(), 0, nullptr) != 0;
  }
  if (!read) {
    throw FileError(std::string("cannot read the picture: ") + image.message, path.string());
  }
  width = static_cast<int>(image.width);
  height = static_cast<int>(image.height);
  return bgr;
}

}  // namespace impactdic::report
