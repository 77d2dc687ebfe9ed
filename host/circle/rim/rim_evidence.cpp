// What lines say under a rim model, eight lines at a time.
#include <algorithm>
#include <cmath>

#include "host/circle/rim/rim_model.h"

namespace impactdic::circle {

namespace {

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

}  // namespace

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
