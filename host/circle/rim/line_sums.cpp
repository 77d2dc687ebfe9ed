// Sums over lines, eight at a time.
#include "host/circle/rim/line_sums.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "host/circle/settings/line_fit.h"

namespace impactdic::circle {
namespace {

// By 1, cos φ, sin φ … cos 4φ, sin 4φ.
constexpr int kWaves = 9, kJacobian = 5;

// Products of the jacobian (cos φ, sin φ, 1, cos 2φ, sin 2φ) from Σ w cos kφ and Σ w sin kφ.
Matrix5 products(const float (&waves)[kWaves], float per_step_sq) {
  double cos[5], sin[5];
  for (int k = 0; k < 5; ++k) {
    cos[k] = per_step_sq * waves[std::max(2 * k - 1, 0)];
    sin[k] = k > 0 ? per_step_sq * waves[2 * k] : 0;
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

// e^x for x <= 0, to 6e-5 of it; e^−30 below −30.
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

// The sums lane by lane.
struct LaneSums {
  Lanes scores[kJacobian] = {}, curvatures[kWaves] = {}, hessians[kWaves] = {};
  Lanes kinds[kKinds] = {}, scatter{}, lines{}, far{};
};

// What eight lines say at some corrections: ∂ ln p, −∂² ln p and the same were the kinds known, by
// the excess in steps; the chance that they have nothing to do with the rim.
struct BlockSays {
  Lanes score, hessian, information, other;
};

// `off`: how far the corrections move the rim from where the evidence is exact, line by line.
[[gnu::always_inline]] inline BlockSays ask(const RimModel::Evidence& e, const Lanes& off,
                                            const KindShares& shares, float stray, LaneSums& sums) {
  const Lanes half = 0.5f * off;
  Lanes share[kKinds], slope[kKinds];
  BlockSays says;
  for (int k = 0; k < kKinds; ++k) {
    slope[k] = e.slope[k] - off * e.information[k];
    share[k] = e.value[k] + shares[k] + half * (e.slope[k] + slope[k]);
  }
  chances(stray, e.present, share, says.other);
  Lanes first[kKinds], second[kKinds], known[kKinds];
  for (int k = 0; k < kKinds; ++k) {
    first[k] = share[k] * slope[k];
    second[k] = first[k] * slope[k];
    known[k] = share[k] * e.information[k];
    sums.kinds[k] += share[k];
  }
  says.score = sum_of(first);
  says.information = sum_of(known);
  says.hessian = says.information - sum_of(second) + says.score * says.score;
  const Lanes error = slope[0] / e.information[0];
  sums.scatter += share[0] * error * error;
  return says;
}

// Adds what eight lines say, by the waves of their angles.
[[gnu::always_inline]] inline void add_waves(const BlockSays& says, const Lanes& c, const Lanes& s,
                                             const Lanes& c2, const Lanes& s2, LaneSums& sums) {
  const Lanes waves[kWaves] = {
      Lanes{} + 1, c, s, c2, s2, c * c2 - s * s2, s * c2 + c * s2, c2 * c2 - s2 * s2, 2 * c2 * s2};
  for (int m = 0; m < kJacobian; ++m) sums.scores[m] += says.score * waves[m];
  for (int m = 0; m < kWaves; ++m) {
    sums.curvatures[m] += says.information * waves[m];
    sums.hessians[m] += says.hessian * waves[m];
  }
}

// Of all lanes; the sectors' sums and `far` stand there already.
void total(const LaneSums& lanes, RimShape& all) {
  for (int m = 0; m < kJacobian; ++m) all.score[m] = total_of(lanes.scores[m]);
  for (int m = 0; m < kWaves; ++m) {
    all.information[m] = total_of(lanes.curvatures[m]);
    all.hessian[m] = total_of(lanes.hessians[m]);
  }
  for (int k = 0; k < kKinds; ++k) all.kinds[k] = total_of(lanes.kinds[k]);
  all.scatter = total_of(lanes.scatter);
}

}  // namespace

RimModel::Shift shift_of(const Vector5& delta, double step_px) {
  RimModel::Shift shift;
  for (int m = 0; m < 5; ++m) shift[m] = static_cast<float>(delta[m] / step_px);
  return shift;
}

LineSums in_px(const RimShape& all, const SectorSums& sectors, float lines, double step_px) {
  const float per_step = static_cast<float>(1 / step_px), per_step_sq = per_step * per_step;
  LineSums s;
  s.sectors = sectors;
  for (int b = 0; b < kRimSectors; ++b) {
    s.sectors.score[b] *= per_step;
    s.sectors.information[b] *= per_step_sq;
    s.points += s.sectors.points[b];
  }
  s.curvature = products(all.information, per_step_sq);
  s.hessian = products(all.hessian, per_step_sq);
  s.hessian_sum = s.hessian(2, 2);
  const int order[kJacobian] = {1, 2, 0, 3, 4};
  for (int m = 0; m < kJacobian; ++m) s.score[m] = per_step * all.score[order[m]];
  std::copy_n(all.kinds, kKinds, s.kinds.begin());
  s.scatter = all.scatter;
  s.lines = lines;
  s.far = all.far;
  return s;
}

IMPACTDIC_WIDE LineSums sum_lines(std::span<const RimModel::Evidence> blocks, const Vector5& delta,
                                  double step_px, const KindShares& shares, float stray,
                                  int every) {
  const RimModel::Shift d = shift_of(delta, step_px);
  LaneSums lanes;
  SectorSums sectors;
  for (std::size_t block = 0; block < blocks.size(); block += static_cast<std::size_t>(every)) {
    const RimModel::Evidence& e = blocks[block];
    const Lanes c = e.cos, s = e.sin, c2 = c * c - s * s, s2 = 2 * c * s;
    const Lanes off = c * d[0] + s * d[1] + d[2] + c2 * d[3] + s2 * d[4] - e.at;
    lanes.far = off > lanes.far ? off : -off > lanes.far ? -off : lanes.far;
    lanes.lines += e.present;
    const BlockSays says = ask(e, off, shares, stray, lanes);
    add_waves(says, c, s, c2, s2, lanes);
    add_to_sectors(e.sector, says.score, says.hessian, says.other < 0.5f ? e.present : Lanes{},
                   sectors);
  }
  RimShape all;
  total(lanes, all);
  float far = 0;
  for (int lane = 0; lane < kLanes; ++lane) far = std::max(far, lanes.far[lane]);
  all.far = far;
  return in_px(all, sectors, total_of(lanes.lines), step_px);
}

WidthChange sum_widths(std::span<RimModel::Evidence> blocks,
                       std::span<const RimModel::Evidence> widths, float stray) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Matrix6 square = Matrix6::Identity() * kLineFit.width_prior;
  Vector6 slope = Vector6::Zero();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    RimModel::Evidence& e = blocks[i];
    Lanes other;
    chances(stray, e.present, e.value, other);
    Lanes by_place{}, by_width{};
    for (int k = 0; k < kKinds; ++k) {
      by_place += e.value[k] * e.slope[k];
      by_width += e.value[k] * widths[i].slope[k];
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      const double c = e.cos[lane], s = e.sin[lane], width = by_width[lane];
      Vector6 j;
      j << by_place[lane] * c, by_place[lane] * s, by_place[lane], width, width * (c * c - s * s),
          width * 2 * c * s;
      square.noalias() += j * j.transpose();
      slope.tail<3>() += j.tail<3>();
    }
  }
  WidthChange change;
  const Eigen::Matrix4d even = square.topLeftCorner<4, 4>();
  change.even = even.ldlt().solve(Eigen::Vector4d{slope.head<4>()})[3];
  const Eigen::LDLT<Matrix6> all(square);
  const Eigen::Vector2d uneven = all.solve(slope).tail<2>();
  const Matrix6 covariance = all.solve(Matrix6::Identity());
  const double chance = covariance(4, 4) + covariance(5, 5);
  if (uneven.squaredNorm() > kLineFit.uneven_chance * chance) change.uneven = uneven.norm();
  return change;
}

Matrix5 misplaced(const LineSums& s, double wider, const Matrix5& covariance) {
  const Matrix5 response = covariance * s.hessian / wider;
  double squares = 0;
  for (const double information : s.sectors.information) squares += information * information;
  const double sector = squares / std::max(s.hessian_sum, 1e-30);
  return response.col(2) * response.col(2).transpose() +
         kLineFit.arcs * kLineFit.arcs * sector / wider * response * covariance;
}

}  // namespace impactdic::circle
