#include "host/track/roi.h"

#include <algorithm>

#include "host/base/error.h"
#include "host/base/parse.h"

namespace impactdic {

Roi parse_roi(const std::string& text, int image_width, int image_height) {
  if (text.empty()) return {0, 0, image_width, image_height};
  const auto parts = split(text, ',');
  if (parts.size() != 4) throw InvalidArgument("'" + text + "' is not X,Y,W,H", "--roi");
  std::int64_t v[4];
  for (int i = 0; i < 4; ++i) v[i] = parse_int(parts[static_cast<std::size_t>(i)], "--roi");
  if (v[0] < 0 || v[1] < 0 || v[2] < 1 || v[3] < 1 || v[2] > image_width - v[0] ||
      v[3] > image_height - v[1]) {
    throw InvalidArgument(
        "'" + text + "' does not lie in the picture", "--roi",
        "the picture is " + std::to_string(image_width) + "x" + std::to_string(image_height));
  }
  return {static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2]),
          static_cast<int>(v[3])};
}

namespace {
template <typename T>
void copy_rows(const Image<T>& from, const Roi& roi, Image<T>& to) {
  for (int y = 0; y < roi.height; ++y) {
    std::copy_n(from.row(roi.y + y) + roi.x, roi.width, to.row(y));
  }
}
}  // namespace

void crop(const Frame& frame, const Roi& roi, Frame& cut) {
  cut.reset(roi.width, roi.height, frame.bits);
  if (frame.type == PixelType::u8) {
    copy_rows(frame.u8, roi, cut.u8);
  } else {
    copy_rows(frame.u16, roi, cut.u16);
  }
}

}  // namespace impactdic
