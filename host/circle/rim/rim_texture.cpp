#include "host/circle/rim/rim_texture.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "host/circle/settings/levels.h"
#include "host/circle/settings/rim_model.h"

namespace impactdic::circle {
namespace {

static_assert(std::size(kInk.inner) == kKinds && std::size(kInk.outer) == kKinds);
// Kinds by the level of the middle (rows) and of the outer end: dark, between, bright.
constexpr int kKindOf[3][3] = {{1, 3, 6}, {1, 4, 6}, {2, 5, 7}};

int level_of(float b) { return b < kInk.dark ? 0 : b < kInk.bright ? 1 : 2; }

// Mean and covariance of a kind from the windows of it and from what is typical of it.
void describe(const double (&sum)[kTexture], const double (&product)[kTexture][kTexture],
              double windows, double inner, double outer, RimTexture::Kind& kind) {
  const double total = windows + kInk.worth;
  double typical[kTexture];
  for (int m = 0; m < kTexture; ++m) {
    typical[m] = m < kTexture - 2 ? inner : m == kTexture - 2 ? 0.5 * (inner + outer) : outer;
    kind.mean[m] = (sum[m] + kInk.worth * typical[m]) / total;
  }
  for (int m = 0; m < kTexture; ++m) {
    for (int n = 0; n <= m; ++n) {
      const double usual =
          kInk.variance * std::exp(-kInk.decay * (m - n)) + typical[m] * typical[n];
      const double v = (product[m][n] + kInk.worth * usual) / total - kind.mean[m] * kind.mean[n];
      kind.covariance[m][n] = kind.covariance[n][m] = v;
    }
  }
}

}  // namespace

void brighten(RimTexture& texture, double by) {
  for (RimTexture::Kind& kind : texture.kinds) {
    for (double& mean : kind.mean) mean *= by;
    for (auto& row : kind.covariance) {
      for (double& each : row) each *= by * by;
    }
  }
}

void TextureSums::add(const float* samples, float noise) {
  const float tolerance = kInk.bare_noise * noise + kInk.bare_least;
  bool bare = true;
  float b[kTexture];
  for (int k = 0; k < kTexture; ++k) {
    bare = bare && std::abs(samples[k] - 1) < tolerance;
    bare_ += samples[k] > 1 - tolerance;
    b[k] = std::clamp(samples[k], least_, kInk.most);
  }
  ++windows_;
  if (std::max({samples[0], samples[1], samples[2]}) > kClear.nothing) {
    ++shown_;
    shown_sum_ += static_cast<double>(samples[0]);
  }
  if (bare) {
    ++kinds_[0].n;
    return;
  }
  Sums& s = kinds_[kKindOf[level_of(b[kTexture - 3])][level_of(b[kTexture - 1])]];
  ++s.n;
  for (int m = 0; m < kTexture; ++m) {
    s.sum[m] += b[m];
    for (int n = 0; n <= m; ++n) s.product[m][n] += b[m] * b[n];
  }
}

RimTexture TextureSums::result(double paint_sd) const {
  RimTexture texture;
  const double all = windows_ + kInk.all_worth;
  RimTexture::Kind& bare = texture.kinds[0];
  bare.share = (kinds_[0].n + kInk.bare_worth) / all;
  for (int m = 0; m < kTexture; ++m) {
    bare.mean[m] = 1;
    for (int n = 0; n < kTexture; ++n) bare.covariance[m][n] = paint_sd * paint_sd;
  }
  for (int k = 1; k < kKinds; ++k) {
    const Sums& s = kinds_[k];
    texture.kinds[k].share = (s.n + kInk.kind_worth) / all;
    describe(s.sum, s.product, s.n, kInk.inner[k], kInk.outer[k], texture.kinds[k]);
  }
  return texture;
}

}  // namespace impactdic::circle
