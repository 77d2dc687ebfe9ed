#include "host/clip/roi.h"

#include <impactdic/error.h>

#include <algorithm>
#include <limits>

#include "host/base/parse.h"

namespace impactdic {

Roi read_roi(const std::string& text) {
  const auto parts = split(text, ',');
  if (parts.size() != 4) throw InvalidArgument("'" + text + "' is not X,Y,W,H", "--roi");
  int v[4];
  for (int i = 0; i < 4; ++i) {
    const std::int64_t number = parse_int(parts[static_cast<std::size_t>(i)], "--roi");
    v[i] = static_cast<int>(std::clamp<std::int64_t>(number, -1, std::numeric_limits<int>::max()));
  }
  return {v[0], v[1], v[2], v[3]};
}

std::string to_text(const Roi& roi) {
  return std::to_string(roi.x) + "," + std::to_string(roi.y) + "," + std::to_string(roi.width) +
         "," + std::to_string(roi.height);
}

void check_roi(const Roi& roi, int image_width, int image_height) {
  if (roi.x < 0 || roi.y < 0 || roi.width < 1 || roi.height < 1 ||
      roi.width > image_width - roi.x || roi.height > image_height - roi.y) {
    throw InvalidArgument(
        "'" + to_text(roi) + "' does not lie in the picture", "--roi",
        "the picture is " + std::to_string(image_width) + "x" + std::to_string(image_height));
  }
}

Roi parse_roi(const std::string& text, int image_width, int image_height) {
  if (text.empty()) return {0, 0, image_width, image_height};
  const Roi roi = read_roi(text);
  check_roi(roi, image_width, image_height);
  return roi;
}

std::vector<PointPx> read_polygon(const std::string& text) {
  const std::vector<double> v = parse_doubles(text, ',', 0, "--polygon");
  if (v.size() < 6 || v.size() % 2 != 0) {
    throw InvalidArgument("'" + text + "' is not X,Y,X,Y,X,Y...", "--polygon",
                          "a polygon has at least three corners");
  }
  std::vector<PointPx> corners;
  for (std::size_t i = 0; i < v.size(); i += 2) corners.push_back({v[i], v[i + 1]});
  return corners;
}

std::string to_text(const std::vector<PointPx>& polygon) {
  std::string text;
  for (const PointPx& corner : polygon) {
    text += (text.empty() ? "" : ",") + shortest(corner.x_px) + "," + shortest(corner.y_px);
  }
  return text;
}

Image<std::uint8_t> polygon_mask(const std::vector<PointPx>& corners, int image_width,
                                 int image_height) {
  if (corners.size() < 3) {
    throw InvalidArgument("a polygon has at least three corners", "--polygon");
  }
  Image<std::uint8_t> mask(image_width, image_height, 0);
  bool any = false;
  for (int y = 0; y < image_height; ++y) {
    for (int x = 0; x < image_width; ++x) {
      // Inside where a ray to the right crosses an odd number of sides.
      bool inside = false;
      for (std::size_t i = 0, before = corners.size() - 1; i < corners.size(); before = i++) {
        const double ax = corners[before].x_px, ay = corners[before].y_px;
        const double bx = corners[i].x_px, by = corners[i].y_px;
        if ((ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)) inside = !inside;
      }
      mask(x, y) = inside ? 1 : 0;
      any = any || inside;
    }
  }
  if (!any) throw InvalidArgument("the polygon holds no pixel of the picture", "--polygon");
  return mask;
}

Image<std::uint8_t> parse_polygon(const std::string& text, int image_width, int image_height) {
  return polygon_mask(read_polygon(text), image_width, image_height);
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

Image<std::uint8_t> cut(const Image<std::uint8_t>& mask, const Roi& roi) {
  Image<std::uint8_t> part(roi.width, roi.height);
  copy_rows(mask, roi, part);
  return part;
}

void crop(const Frame& frame, const Roi& roi, Frame& cut) {
  cut.reset(roi.width, roi.height, frame.bits);
  if (frame.type == PixelType::kU8) {
    copy_rows(frame.u8, roi, cut.u8);
  } else {
    copy_rows(frame.u16, roi, cut.u16);
  }
}

}  // namespace impactdic
