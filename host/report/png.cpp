#include "host/report/png.h"

#include <png.h>

#include "host/base/error.h"

namespace impactdic {

void write_png_bgr(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint8_t> bgr) {
  if (bgr.size() != static_cast<std::size_t>(width) * height * 3) {
    throw InvalidArgument("a picture's bytes and size differ");
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_BGR;
  image.flags = PNG_IMAGE_FLAG_FAST;
  if (png_image_write_to_file(&image, path.c_str(), 0, bgr.data(), 0, nullptr) == 0) {
    throw FileError(std::string("cannot write the picture: ") + image.message, path.string());
  }
}

}  // namespace impactdic
