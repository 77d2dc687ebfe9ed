// Sums over lines, eight at a time.
#include "host/circle/rim/line_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

namespace impactdic::circle {
namespace {

// By 1, cos φ, sin φ … cos 4φ, sin 4φ.
constexpr int kWaves = 9, kJacobian = 5;

// Products of the jacobian (cos φ, sin φ, 1, cos 2φ, sin 2φ) from Σ w cos kφ and Σ w sin kφ.
Matrix5 products(const Lanes (&waves)[kWaves], float per_step_sq) {
  double cos[5], sin[5];
  for (int k = 0; k < 5; ++k) {
    cos[k] = per_step_sq * total_of(waves[std::max(2 * k - 1, 0)]);
    sin[k] = k > 0 ? per_step_sq * total_of(waves[2 * k]) : 0;
  }
  const int order[5] = {1, 1, 0, 2, 2};
  const bool sine[5] = {false, true, false, false, true};
  Matrix5 m;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j <= i; ++j) {
      const int sum = order[i] + order[j], gap = order[i] - order[j], far = std::abs(gap);
      const double sign = gap < 0 ? -1 : 1;
      if (sine[i] && sine[j]) {
        m(i, j) = 0.5 * (cos[far] - cos[sum]);
      } else if (!sine[i] && !sine[j]) {
        m(i, j) = 0.5 * (cos[far] + cos[sum]);
      } else {
        const double odd = sine[i] ? sign * sin[far] : -sign * sin[far];
        m(i, j) = 0.5 * (sin[sum] + odd);
      }
      m(j, i) = m(i, j);
    }
  }
  return m;
}

// e^x for x <= 0, to 4e-5 of it; e^−30 below −30.
[[gnu::always_inline]] inline void exponential(Lanes& x) {
  Lanes y = x * 1.44269504f;
  y = y < -43.0f ? Lanes{} - 43.0f : y;
  // A sum so large has no room for fractions: the nearest whole number stands in its last bits.
  const Lanes large = y + 12582912.0f;
  const Lanes r = y - (large - 12582912.0f);
  const Lanes square = r * r;
  const Lanes p =
      (1 + 0.69314718f * r) + square * ((0.24022651f + 0.05550411f * r) + 0.00961813f * square);
  IntLanes whole, bits;
  std::memcpy(&whole, &large, sizeof(whole));
  std::memcpy(&bits, &p, sizeof(bits));
  bits += whole << 23;
  std::memcpy(&x, &bits, sizeof(x));
}

// Short chains of additions, which the processor can work on side by side.
static_assert(kKinds == 8);
[[gnu::always_inline]] inline Lanes sum_of(const Lanes (&v)[kKinds]) {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}
[[gnu::always_inline]] inline Lanes greater_of(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}

[[gnu::always_inline]] inline void chances(float stray, const Lanes& present,
                                           Lanes (&value)[kKinds], Lanes& other) {
  const Lanes(&v)[kKinds] = value;
  const Lanes most = greater_of(
      greater_of(greater_of(v[0], v[1]), greater_of(v[2], v[3])),
      greater_of(greater_of(greater_of(v[4], v[5]), greater_of(v[6], v[7])), Lanes{} + stray));
  other = stray - most;
  exponential(other);
  for (int k = 0; k < kKinds; ++k) {
    value[k] -= most;
    exponential(value[k]);
  }
  const Lanes per_total = present / (sum_of(value) + other);
  other *= per_total;
  for (int k = 0; k < kKinds; ++k) value[k] *= per_total;
}

// Adds eight lines to their sectors, which lie in the order of the lines.
[[gnu::always_inline]] inline void add_to_sectors(const IntLanes& sector, const Lanes& score,
                                                  const Lanes& information, const Lanes& point,
                                                  SectorSums& sums) {
  const int first = sector[0], last = sector[kLanes - 1];
  for (int b = first; b <= last; ++b) {
    const auto here = sector == b;
    sums.score[b] += total_of(here ? score : Lanes{});
    sums.information[b] += total_of(here ? information : Lanes{});
    sums.points[b] += static_cast<int>(total_of(here ? point : Lanes{}));
  }
}

}  // namespace

RimModel::Shift shift_of(const Vector5& delta, double step_px) {
  RimModel::Shift shift;
  for (int m = 0; m < 5; ++m) shift[m] = static_cast<float>(delta[m] / step_px);
  return shift;
}

void to_chances(float stray, const Lanes& present, Lanes (&value)[kKinds], Lanes& other) {
  chances(stray, present, value, other);
}

IMPACTDIC_WIDE LineSums sum_lines(std::span<const RimModel::Evidence> blocks, const Vector5& delta,
                                  double step_px, const KindShares& shares, float stray,
                                  int every) {
  const RimModel::Shift d = shift_of(delta, step_px);
  Lanes scores[kJacobian] = {}, curvatures[kWaves] = {}, hessians[kWaves] = {};
  Lanes kinds[kKinds] = {}, scatter{}, lines{}, far{};
  LineSums s;
  for (std::size_t block = 0; block < blocks.size(); block += static_cast<std::size_t>(every)) {
    const RimModel::Evidence& e = blocks[block];
    const Lanes c = e.cos, sn = e.sin, c2 = c * c - sn * sn, s2 = 2 * c * sn;
    const Lanes off = c * d[0] + sn * d[1] + d[2] + c2 * d[3] + s2 * d[4] - e.at;
    far = off > far ? off : -off > far ? -off : far;
    lines += e.present;
    const Lanes half = 0.5f * off;
    Lanes share[kKinds], slope[kKinds], other;
    for (int k = 0; k < kKinds; ++k) {
      slope[k] = e.slope[k] - off * e.information[k];
      share[k] = e.value[k] + shares[k] + half * (e.slope[k] + slope[k]);
    }
    chances(stray, e.present, share, other);
    Lanes first[kKinds], second[kKinds], known[kKinds];
    for (int k = 0; k < kKinds; ++k) {
      first[k] = share[k] * slope[k];
      second[k] = first[k] * slope[k];
      known[k] = share[k] * e.information[k];
      kinds[k] += share[k];
    }
    const Lanes score = sum_of(first), square = sum_of(second), information = sum_of(known);
    const Lanes hessian = information - square + score * score;
    const Lanes error = slope[0] / e.information[0];
    scatter += share[0] * error * error;
    const Lanes waves[kWaves] = {
        Lanes{} + 1,       c,          sn, c2, s2, c * c2 - sn * s2, sn * c2 + c * s2,
        c2 * c2 - s2 * s2, 2 * c2 * s2};
    for (int m = 0; m < kJacobian; ++m) scores[m] += score * waves[m];
    for (int m = 0; m < kWaves; ++m) {
      curvatures[m] += information * waves[m];
      hessians[m] += hessian * waves[m];
    }
    add_to_sectors(e.sector, score, hessian, other < 0.5f ? e.present : Lanes{}, s.sectors);
  }
  const float per_step = static_cast<float>(1 / step_px), per_step_sq = per_step * per_step;
  for (int b = 0; b < kRimSectors; ++b) {
    s.sectors.score[b] *= per_step;
    s.sectors.information[b] *= per_step_sq;
    s.points += s.sectors.points[b];
  }
  s.curvature = products(curvatures, per_step_sq);
  s.hessian = products(hessians, per_step_sq);
  s.hessian_sum = s.hessian(2, 2);
  const int order[kJacobian] = {1, 2, 0, 3, 4};
  for (int m = 0; m < kJacobian; ++m) s.score[m] = per_step * total_of(scores[order[m]]);
  for (int k = 0; k < kKinds; ++k) s.kinds[k] = total_of(kinds[k]);
  s.scatter = total_of(scatter);
  s.lines = total_of(lines);
  for (int lane = 0; lane < kLanes; ++lane) s.far = std::max(s.far, far[lane]);
  return s;
}

}  // namespace impactdic::circle
