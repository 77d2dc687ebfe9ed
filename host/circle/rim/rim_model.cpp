#include "host/circle/rim/rim_model.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace impactdic::circle {

using Vector = Eigen::Matrix<double, kSamples, 1>;

// The blurred edge and how it changes with its place and with ln σ.
struct RimModel::Edge {
  Vector level, shift, wider;
};

namespace {

using Matrix = Eigen::Matrix<double, kSamples, kSamples>;

constexpr float kDark = 0.3f, kBright = 0.85f;  // levels apart
// Kinds by the level of the middle (rows) and of the outer end: dark, between, bright.
constexpr int kKindOf[3][3] = {{1, 3, 6}, {1, 4, 6}, {2, 5, 7}};
constexpr double kInnerOf[kKinds] = {1, 0.4, 0.95, 0.15, 0.6, 0.95, 0.5, 0.95};
constexpr double kOuterOf[kKinds] = {1, 0.15, 0.15, 0.6, 0.6, 0.6, 0.95, 0.95};
constexpr double kTypicalVariance = 0.03;
constexpr double kUsual = 8;         // windows whose worth the typical counts
constexpr double kPaintSd = 0.01;    // of the level of bare paint, share of the contrast
constexpr double kGroundSd = 0.004;  // of the background's
constexpr double kWidthSd = 0.08;    // of ln σ from line to line
constexpr double kStray = 0.01;      // share
constexpr double kBlurred = 0.06;    // of the contrast: noise through which a rim is found
constexpr double kKernel = 0.9;  // px along the normal for one along a row or column, on average

int level_of(float b) { return b < kDark ? 0 : b < kBright ? 1 : 2; }

}  // namespace

void TextureSums::add(const float* samples, float noise) {
  const float tolerance = 3.5f * noise + 0.02f;
  bool bare = true;
  float b[kTexture];
  for (int k = 0; k < kTexture; ++k) {
    bare = bare && std::abs(samples[k] - 1) < tolerance;
    b[k] = std::clamp(samples[k], -0.3f, 1.5f);
  }
  ++windows_;
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

RimTexture TextureSums::result() const {
  RimTexture texture;
  RimTexture::Kind& bare = texture.kinds[0];
  bare.share = (kinds_[0].n + 4) / (windows_ + 8);
  for (int m = 0; m < kTexture; ++m) {
    bare.mean[m] = 1;
    for (int n = 0; n < kTexture; ++n) bare.covariance[m][n] = kPaintSd * kPaintSd;
  }
  for (int k = 1; k < kKinds; ++k) {
    RimTexture::Kind& kind = texture.kinds[k];
    const Sums& s = kinds_[k];
    const double total = s.n + kUsual;
    const double inner = kInnerOf[k], outer = kOuterOf[k];
    kind.share = (s.n + 0.5) / (windows_ + 8);
    double typical[kTexture];
    for (int m = 0; m < kTexture; ++m) {
      typical[m] = m < kTexture - 2 ? inner : m == kTexture - 2 ? 0.5 * (inner + outer) : outer;
      kind.mean[m] = (s.sum[m] + kUsual * typical[m]) / total;
    }
    for (int m = 0; m < kTexture; ++m) {
      for (int n = 0; n <= m; ++n) {
        const double usual = kTypicalVariance * std::exp(-0.4 * (m - n)) + typical[m] * typical[n];
        const double v = (s.product[m][n] + kUsual * usual) / total - kind.mean[m] * kind.mean[n];
        kind.covariance[m][n] = kind.covariance[n][m] = v;
      }
    }
  }
  return texture;
}

RimModel::RimModel(const RimTexture& texture, double noise, double edge_sigma_px, double step_px,
                   Blurred)
    : texture_(texture),
      edge_sigma_px_(edge_sigma_px),
      noise_(noise),
      step_px_(step_px),
      sigma_(edge_sigma_px / step_px),
      tables_(2 * kReach + 1) {
  double total = kStray;
  for (const auto& kind : texture.kinds) total += kind.share;
  for (int k = 0; k < kKinds; ++k) {
    log_share_[k] = static_cast<float>(std::log(texture.kinds[k].share / total));
  }
  // A stray's samples are anything between background and paint, with equal chance; in units in
  // which a normal density has no factor (2π)^(−n/2).
  log_stray_ = static_cast<float>(std::log(kStray / total) + 0.5 * kSamples * std::log(2 * kPi));
}

RimModel::RimModel(const RimTexture& texture, double noise, double edge_sigma_px, double step_px)
    : RimModel(texture, noise, edge_sigma_px, step_px, Blurred::no) {
  blurred_.reset(
      new RimModel(texture, std::hypot(noise, kBlurred), edge_sigma_px, step_px, Blurred::yes));
}

// The samples are interpolated along rows and columns with Catmull and Rom's cubic, whose kernel
// blurs the edge too, by its fourth moment; `kernel` is its unit along the normal.
RimModel::Edge RimModel::edge_at(double excess, double sigma, double kernel) {
  constexpr int kNodes = 16;
  static const std::array<std::pair<double, double>, kNodes> nodes = [] {
    std::array<std::pair<double, double>, kNodes> at;
    double sum = 0;
    for (int i = 0; i < kNodes; ++i) {
      const double u = (i + 0.5) * 4 / kNodes - 2, d = std::abs(u);
      const double h = d < 1 ? (1.5 * d - 2.5) * d * d + 1 : ((2.5 - 0.5 * d) * d - 4) * d + 2;
      at[i] = {u, h};
      sum += h;
    }
    for (auto& node : at) node.second /= sum;
    return at;
  }();
  Edge e{Vector::Zero(), Vector::Zero(), Vector::Zero()};
  for (int k = 0; k < kSamples; ++k) {
    for (const auto& [u, h] : nodes) {
      const double z = (k - kInside - excess - kernel * u) / sigma;
      const double density = h * std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
      e.level[k] += h * 0.5 * std::erfc(z / std::sqrt(2.0));
      e.shift[k] += density / sigma;
      e.wider[k] += density * z;
    }
  }
  return e;
}

namespace {

constexpr std::size_t kNumbers = 4 + kKinds * (1 + kTexture + kTexture * kTexture);

RimTexture texture_of(const std::vector<double>& numbers) {
  if (numbers.size() != kNumbers) {
    throw InvalidArgument("a rim's look has another count of numbers", "resume");
  }
  RimTexture texture;
  auto next = numbers.begin() + 4;
  for (auto& kind : texture.kinds) {
    kind.share = *next++;
    for (double& mean : kind.mean) mean = *next++;
    for (auto& row : kind.covariance) {
      for (double& value : row) value = *next++;
    }
  }
  return texture;
}

}  // namespace

RimModel::RimModel(const std::vector<double>& numbers)
    : RimModel(texture_of(numbers), numbers[0], numbers[1], numbers[2]) {
  place_sd_px_ = numbers[3];
}

std::vector<double> RimModel::numbers() const {
  std::vector<double> numbers = {noise_, edge_sigma_px_, step_px_, place_sd_px_};
  for (const auto& kind : texture_.kinds) {
    numbers.push_back(kind.share);
    numbers.insert(numbers.end(), std::begin(kind.mean), std::end(kind.mean));
    for (const auto& row : kind.covariance) {
      numbers.insert(numbers.end(), std::begin(row), std::end(row));
    }
  }
  return numbers;
}

void RimModel::fill(int place) const {
  const Edge edge = edge_at((place - kReach) / kPerStep, sigma_, kKernel / step_px_);
  for (int k = 0; k < kKinds; ++k) fill(edge, k, tables_[place]);
}

void RimModel::reach(float excess) const {
  const int far = place_of(excess) - kReach;
  if (far <= ready_.load(std::memory_order_acquire)) return;
  const std::lock_guard lock(filling_);
  for (int d = ready_.load(std::memory_order_relaxed) + 1; d <= far; ++d) {
    fill(kReach + d);
    if (d > 0) fill(kReach - d);
    ready_.store(d, std::memory_order_release);
  }
}

// The normal density of a profile, N(m, Σ) with m = μ C and Σ = C K C + noise, and its slopes: with
// P = Σ⁻¹ and r = p − m,
//   ∂ ln p = rᵀ P ∂m + ½ rᵀ P ∂Σ P r − ½ tr(P ∂Σ).
void RimModel::fill(const Edge& edge, int of, Table& table) const {
  const RimTexture::Kind& kind = texture_.kinds[of];
  Vector mean;
  Matrix paint;
  for (int i = 0; i < kSamples; ++i) {
    const int a = std::min(i, kTexture - 1);
    mean[i] = kind.mean[a];
    for (int j = 0; j < kSamples; ++j) {
      paint(i, j) = kind.covariance[a][std::min(j, kTexture - 1)];
    }
  }
  const Vector m = mean.cwiseProduct(edge.level), outside = Vector::Ones() - edge.level;
  const Vector wider = mean.cwiseProduct(edge.wider);
  Matrix sigma = edge.level.asDiagonal() * paint * edge.level.asDiagonal();
  sigma.diagonal().array() += noise_ * noise_;
  sigma.noalias() += (kGroundSd * kGroundSd) * outside * outside.transpose();
  sigma.noalias() += (kWidthSd * kWidthSd) * wider * wider.transpose();
  const Eigen::LLT<Matrix> factor(sigma);
  const Matrix p = factor.solve(Matrix::Identity());

  const auto store = [of](const Matrix& matrix, const Vector& linear, double constant,
                          double offset, Quadratic& q) {
    int at = 0;
    q.number[at++][of] = static_cast<float>(constant);
    for (int i = 0; i < kSamples; ++i) {
      q.number[at++][of] = static_cast<float>(linear[i]);
      for (int j = 0; j <= i; ++j) {
        q.number[at++][of] = static_cast<float>(j == i ? matrix(i, i) : 2 * matrix(i, j));
      }
    }
    q.offset[of] = static_cast<float>(offset);
  };
  const Vector pm = p * m;
  store(-0.5 * p, pm, -0.5 * m.dot(pm),
        log_share_[of] - factor.matrixLLT().diagonal().array().log().sum(), table.value);
  const auto slope = [&](const Vector& change, Quadratic& q) {
    const Vector dm = mean.cwiseProduct(change);
    Matrix ds = change.asDiagonal() * paint * edge.level.asDiagonal();
    ds.noalias() -= (kGroundSd * kGroundSd) * change * outside.transpose();
    ds += ds.transpose().eval();
    const Matrix pds = p * ds;
    const Matrix w = 0.5 * pds * p;
    const Vector pdm = p * dm, wm = w * m;
    store(w, pdm - 2 * wm, m.dot(wm) - m.dot(pdm), -0.5 * pds.trace(), q);
    return dm.dot(pdm) + 0.5 * pds.cwiseProduct(pds.transpose()).sum();
  };
  table.information[of] = static_cast<float>(slope(edge.shift, table.slope));
  slope(edge.wider, table.width);
}

int RimModel::place_of(float excess) {
  const float at =
      std::clamp(excess * kPerStep, -static_cast<float>(kReach), static_cast<float>(kReach));
  return static_cast<int>(at + (kReach + 0.5f));
}

[[gnu::always_inline]] inline void transpose(Lanes (&v)[kLanes]) {
  // Swaps blocks of 4, 2 and 1 across the diagonal.
  for (const int i : {0, 1, 2, 3}) {
    const Lanes a = v[i], b = v[i + 4];
    v[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
    v[i + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
  }
  for (const int i : {0, 1, 4, 5}) {
    const Lanes a = v[i], b = v[i + 2];
    v[i] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    v[i + 2] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
  for (const int i : {0, 2, 4, 6}) {
    const Lanes a = v[i], b = v[i + 1];
    v[i] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    v[i + 1] = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  }
}

// Calls use(table, here) for every place of a block's lines; `here`: which of them.
template <typename Use>
[[gnu::always_inline]] inline void RimModel::for_each_place(const Evidence& e,
                                                            const Use& use) const {
  // The least and the greatest of all lanes, in all lanes.
  Lanes low = e.at, high = e.at;
  const auto spread = [&](const Lanes& other_low, const Lanes& other_high)
      __attribute__((always_inline)) {
    low = other_low < low ? other_low : low;
    high = other_high > high ? other_high : high;
  };
  spread(__builtin_shufflevector(low, low, 4, 5, 6, 7, 0, 1, 2, 3),
         __builtin_shufflevector(high, high, 4, 5, 6, 7, 0, 1, 2, 3));
  spread(__builtin_shufflevector(low, low, 2, 3, 0, 1, 6, 7, 4, 5),
         __builtin_shufflevector(high, high, 2, 3, 0, 1, 6, 7, 4, 5));
  spread(__builtin_shufflevector(low, low, 1, 0, 3, 2, 5, 4, 7, 6),
         __builtin_shufflevector(high, high, 1, 0, 3, 2, 5, 4, 7, 6));
  const float lowest = low[0], highest = high[0];
  for (float at = lowest; at <= highest; at += 1 / kPerStep) {
    use(tables_[place_of(at)], e.at == at);
  }
}

// The samples and their products, in the order of Quadratic's numbers after the constant.
struct RimModel::Monomials {
  Lanes of[kNumbers - 1];
  explicit Monomials(const Lanes (&p)[kSamples]) {
    int at = 0;
    for (int i = 0; i < kSamples; ++i) {
      of[at++] = p[i];
      for (int j = 0; j <= i; ++j) of[at++] = p[i] * p[j];
    }
  }
};

[[gnu::always_inline]] inline void RimModel::form(const Quadratic& q, const Monomials& p,
                                                  const Lanes& weight, Lanes (&out)[kKinds]) {
  Lanes sum[kKinds];
  for (int k = 0; k < kKinds; ++k) sum[k] = Lanes{} + q.number[0][k];
  for (int m = 0; m < kNumbers - 1; ++m) {
    for (int k = 0; k < kKinds; ++k) sum[k] += p.of[m] * q.number[m + 1][k];
  }
  sum[0] *= weight;  // how much bare paint tells goes with the contrast
  for (int k = 0; k < kKinds; ++k) out[k] = sum[k] + q.offset[k];
}

IMPACTDIC_WIDE std::span<RimModel::Evidence> RimModel::evidence(const LineTrace& trace,
                                                                const Shift& shift, int stride,
                                                                std::vector<Evidence>& room) const {
  reach(std::hypot(shift[0], shift[1]) + std::abs(shift[2]) + std::hypot(shift[3], shift[4]));
  const RimLines& lines = trace.lines;
  const std::size_t every = static_cast<std::size_t>(stride);
  const std::size_t n = (lines.size() + every - 1) / every;
  const std::size_t blocks = (n + kLanes - 1) / kLanes;
  if (room.size() < blocks) room.resize(blocks);
  const std::span out(room.data(), blocks);
  for (std::size_t block = 0; block < out.size(); ++block) {
    Evidence& e = out[block];
    const std::size_t first = block * kLanes;
    Lanes profile[kLanes];
    if (every == 1) {
      load(&lines.cos[first], e.cos);
      load(&lines.sin[first], e.sin);
      load(&lines.weight[first], e.weight);
      load(&lines.sector[first], e.sector);
      for (int lane = 0; lane < kLanes; ++lane) profile[lane] = lines.profile[first + lane].v;
    } else {
      for (int lane = 0; lane < kLanes; ++lane) {
        // The last block is filled up with the last line.
        const std::size_t from = std::min(first + lane, n - 1) * every;
        e.cos[lane] = lines.cos[from];
        e.sin[lane] = lines.sin[from];
        e.weight[lane] = lines.weight[from];
        e.sector[lane] = lines.sector[from];
        profile[lane] = lines.profile[from].v;
      }
    }
    e.present = kCount < static_cast<float>(n - first) ? Lanes{} + 1 : Lanes{};
    const Lanes c = e.cos, s = e.sin;
    // As place_of().
    Lanes at = kPerStep * (c * shift[0] + s * shift[1] + shift[2] + (c * c - s * s) * shift[3] +
                           2 * c * s * shift[4]);
    constexpr float kMost = kReach;
    at = at < -kMost ? Lanes{} - kMost : at > kMost ? Lanes{} + kMost : at;
    const IntLanes place = __builtin_convertvector(at + (kMost + 0.5f), IntLanes);
    e.at = (__builtin_convertvector(place, Lanes) - kMost) * (1 / kPerStep);
    transpose(profile);
    for (int i = 0; i < kSamples; ++i) e.profile[i] = profile[i];
    const Monomials p(e.profile);
    for_each_place(
        e, [&](const Table& table, const auto& here) __attribute__((always_inline)) {
          Lanes value[kKinds], slope[kKinds];
          form(table.value, p, e.weight, value);
          form(table.slope, p, e.weight, slope);
          for (int k = 0; k < kKinds; ++k) {
            const Lanes information =
                k == 0 ? table.information[k] * e.weight : Lanes{} + table.information[k];
            e.value[k] = here ? value[k] : e.value[k];
            e.slope[k] = here ? slope[k] : e.slope[k];
            e.information[k] = here ? information : e.information[k];
          }
        });
  }
  return out;
}

void RimModel::width_slopes(std::span<Evidence> blocks) const {
  for (Evidence& e : blocks) {
    for_each_place(
        e, [&](const Table& table, const auto& here) __attribute__((always_inline)) {
          Lanes slope[kKinds];
          form(table.width, Monomials(e.profile), e.weight, slope);
          for (int k = 0; k < kKinds; ++k) e.slope[k] = here ? slope[k] : e.slope[k];
        });
  }
}

double RimModel::misfit(std::span<const Evidence> blocks) const {
  double sum = 0, lines = 0;
  for (const Evidence& e : blocks) {
    Lanes most = Lanes{} - 1e30f, left{};
    for_each_place(
        e, [&](const Table& table, const auto& here) __attribute__((always_inline)) {
          Lanes value[kKinds];
          form(table.value, Monomials(e.profile), e.weight, value);
          for (int k = 0; k < kKinds; ++k) {
            const auto likelier = here & (value[k] > most);
            most = likelier ? value[k] : most;
            left = likelier ? 2 * (table.value.offset[k] - value[k]) : left;
          }
        });
    for (int lane = 0; lane < kLanes; ++lane) {
      sum += left[lane] * e.present[lane];
      lines += e.present[lane];
    }
  }
  return sum / std::max(lines, 1.0);
}

}  // namespace impactdic::circle
