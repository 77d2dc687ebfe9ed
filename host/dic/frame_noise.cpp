#include "host/dic/frame_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::dic {
namespace {

constexpr double kRounding = 0.28867513459481287;  // 1/√12
constexpr double kNormalMedian = 0.6744897501960817;
constexpr double kFlattest = 0.3;  // share of the picture
constexpr int kReach = 3;          // px from a pixel to those whose means tell how flat it is

// Mean of 3 × 3 pixels about (x, y).
double mean_about(ImageView<const float> picture, int x, int y) {
  double sum = 0;
  for (int v = y - 1; v <= y + 1; ++v) {
    const float* row = picture.row(v);
    sum += row[x - 1] + row[x] + row[x + 1];
  }
  return sum / 9;
}

struct Place {
  float steepness, difference;
};

}  // namespace

double estimate_noise(ImageView<const float> picture, double full_scale) {
  const double black = 0.005 * full_scale, white = 0.995 * full_scale;
  constexpr int kBorder = kReach + 1;
  constexpr std::ptrdiff_t kWanted = 40000;
  const auto pixels = static_cast<std::ptrdiff_t>(picture.width) * picture.height;
  const std::ptrdiff_t share = pixels / kWanted;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(share))));
  std::vector<Place> places;
  for (int y = kBorder; y < picture.height - kBorder; y += step) {
    for (int x = kBorder; x < picture.width - kBorder; x += step) {
      const float *a = picture.row(y - 1) + x, *b = picture.row(y) + x, *c = picture.row(y + 1) + x;
      if (b[0] <= black || b[0] >= white) continue;
      // The four means lie beyond the pixels of the difference: its noise does not choose places.
      const double right = mean_about(picture, x + kReach, y);
      const double left = mean_about(picture, x - kReach, y);
      const double below = mean_about(picture, x, y + kReach);
      const double above = mean_about(picture, x, y - kReach);
      const float difference =
          a[-1] + a[1] + c[-1] + c[1] - 2 * (a[0] + b[-1] + b[1] + c[0]) + 4 * b[0];
      const auto [least, most] = std::minmax({right, left, below, above});
      places.push_back({static_cast<float>(most - least), std::abs(difference)});
    }
  }
  if (places.empty()) return kRounding;
  const auto flat = std::max<std::ptrdiff_t>(
      1, static_cast<std::ptrdiff_t>(kFlattest * static_cast<double>(places.size())));
  std::nth_element(places.begin(), places.begin() + (flat - 1), places.end(),
                   [](const Place& p, const Place& q) { return p.steepness < q.steepness; });
  std::vector<float> differences;
  differences.reserve(static_cast<std::size_t>(flat));
  for (auto place = places.begin(); place != places.begin() + flat; ++place) {
    differences.push_back(place->difference);
  }
  // The mask's squares sum to 36.
  return std::max(kRounding, upper_median(std::move(differences)) / (6 * kNormalMedian));
}

}  // namespace impactdic::dic
