#include "host/clip/roi.h"

#include <impactdic/error.h>

#include <algorithm>

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

Image<std::uint8_t> parse_polygon(const std::string& text, int image_width, int image_height) {
  const std::vector<double> v = parse_doubles(text, ',', 0, "--polygon");
  if (v.size() < 6 || v.size() % 2 != 0) {
    throw InvalidArgument("'" + text + "' is not X,Y,X,Y,X,Y...", "--polygon",
                          "a polygon has at least three corners");
  }
  const std::size_t corners = v.size() / 2;
  Image<std::uint8_t> mask(image_width, image_height, 0);
  bool any = false;
  for (int y = 0; y < image_height; ++y) {
    for (int x = 0; x < image_width; ++x) {
      // Inside where a ray to the right crosses an odd number of sides.
      bool inside = false;
      for (std::size_t i = 0, before = corners - 1; i < corners; before = i++) {
        const double ax = v[2 * before], ay = v[2 * before + 1], bx = v[2 * i], by = v[2 * i + 1];
        if ((ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)) inside = !inside;
      }
      mask(x, y) = inside ? 1 : 0;
      any = any || inside;
    }
  }
  if (!any) throw InvalidArgument("the polygon holds no pixel of the picture", "--polygon");
  return mask;
}

Roi extent(const Image<std::uint8_t>& mask) {
  int x0 = mask.width(), y0 = mask.height(), x1 = 0, y1 = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) == 0) continue;
      x0 = std::min(x0, x);
      y0 = std::min(y0, y);
      x1 = std::max(x1, x + 1);
      y1 = std::max(y1, y + 1);
    }
  }
  return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
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
