// What lines across a rim say, in double precision and one line at a time: the formulas of
// host/circle/rim/rim_model.h and line_sums.h written down plainly, to compare the vectors with.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/circle/rim/blurred_edge.h"
#include "host/circle/rim/line_sums.h"
#include "host/circle/rim/rim_texture.h"
#include "host/circle/settings/rim_model.h"

namespace impactdic::reference {

// The normal density of one line's samples under one kind and an edge.
struct KindDensity {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

// `width_edge`: the edge whose change with its width from line to line scatters the samples.
inline KindDensity kind_density(const circle::RimTexture::Kind& kind,
                                const circle::BlurredEdge& edge,
                                const circle::BlurredEdge& width_edge, double noise) {
  constexpr int n = circle::kSamples;
  const double ground = circle::kRimModel.ground_sd, width = circle::kRimModel.width_sd;
  KindDensity d{Eigen::VectorXd(n), Eigen::MatrixXd(n, n)};
  for (int i = 0; i < n; ++i) {
    const int a = std::min(i, circle::kTexture - 1);
    d.mean[i] = kind.mean[a] * edge.level[i];
    for (int j = 0; j < n; ++j) {
      const int b = std::min(j, circle::kTexture - 1);
      d.covariance(i, j) =
          kind.covariance[a][b] * edge.level[i] * edge.level[j] +
          ground * ground * (1 - edge.level[i]) * (1 - edge.level[j]) +
          width * width * kind.mean[a] * width_edge.wider[i] * kind.mean[b] * width_edge.wider[j] +
          (i == j ? noise * noise : 0);
    }
  }
  return d;
}

// A line's ln p under one kind, but for (2π)^(−n/2). `weight` counts for bare paint alone.
inline double log_density(const KindDensity& d, const Eigen::VectorXd& samples, double weight,
                          int kind, double share) {
  const Eigen::VectorXd off = samples - d.mean;
  const double squares = off.dot(d.covariance.fullPivLu().solve(off));
  return std::log(share) - 0.5 * std::log(d.covariance.determinant()) -
         0.5 * (kind == 0 ? weight : 1) * squares;
}

// One line's evidence in doubles.
struct Line {
  std::array<double, circle::kKinds> value{}, slope{}, information{};
  double at = 0, cos = 0, sin = 0;
  int sector = 0;
};

// All lines of blocks of evidence, those that are not there left out.
inline std::vector<Line> lines_of(std::span<const circle::RimModel::Evidence> blocks,
                                  std::size_t every) {
  std::vector<Line> lines;
  for (std::size_t block = 0; block < blocks.size(); block += every) {
    for (int lane = 0; lane < circle::kLanes; ++lane) {
      const auto& e = blocks[block];
      if (e.present[lane] == 0) continue;
      Line& line = lines.emplace_back();
      for (int k = 0; k < circle::kKinds; ++k) {
        line.value[k] = e.value[k][lane];
        line.slope[k] = e.slope[k][lane];
        line.information[k] = e.information[k][lane];
      }
      line.at = e.at[lane];
      line.cos = e.cos[lane];
      line.sin = e.sin[lane];
      line.sector = e.sector[lane];
    }
  }
  return lines;
}

inline circle::Vector5 jacobian(const Line& line) {
  const double c = line.cos, s = line.sin;
  return {c, s, 1, c * c - s * s, 2 * c * s};
}

// Chances of the kinds and of none of them (the last) at an excess `off` steps from where the
// evidence is exact; returns ln p of the line.
inline double chances(const Line& line, double off, const circle::KindShares& shares, double stray,
                      std::array<double, circle::kKinds + 1>& out) {
  double total = 0;
  for (int k = 0; k <= circle::kKinds; ++k) {
    out[k] = k == circle::kKinds ? stray
                                 : line.value[k] + shares[k] + off * line.slope[k] -
                                       0.5 * off * off * line.information[k];
  }
  const double most = *std::max_element(out.begin(), out.end());
  for (double& each : out) total += each = std::exp(each - most);
  for (double& each : out) each /= total;
  return most + std::log(total);
}

inline double log_likelihood(const std::vector<Line>& lines, const circle::Vector5& delta,
                             double step_px, const circle::KindShares& shares, double stray) {
  double sum = 0;
  std::array<double, circle::kKinds + 1> chance;
  for (const Line& line : lines) {
    const double off = jacobian(line).dot(delta) / step_px - line.at;
    sum += chances(line, off, shares, stray, chance);
  }
  return sum;
}

inline circle::LineSums sum_lines(const std::vector<Line>& lines, const circle::Vector5& delta,
                                  double step_px, const circle::KindShares& shares, double stray) {
  circle::LineSums sums;
  std::array<double, circle::kKinds + 1> chance;
  std::array<double, circle::kKinds> kinds{};
  double far = 0;
  for (const Line& line : lines) {
    const circle::Vector5 j = jacobian(line) / step_px;
    const double off = j.dot(delta) - line.at;
    far = std::max(far, std::abs(off));
    chances(line, off, shares, stray, chance);
    double score = 0, square = 0, information = 0;
    for (int k = 0; k < circle::kKinds; ++k) {
      const double slope = line.slope[k] - off * line.information[k];
      score += chance[k] * slope;
      square += chance[k] * slope * slope;
      information += chance[k] * line.information[k];
      kinds[k] += chance[k];
    }
    const double hessian = information - square + score * score;
    sums.score += score * j;
    sums.curvature += information * j * j.transpose();
    sums.hessian += hessian * j * j.transpose();
    sums.hessian_sum += hessian / (step_px * step_px);
    sums.sectors.score[line.sector] += score / step_px;
    sums.sectors.information[line.sector] += hessian / (step_px * step_px);
    const double error = (line.slope[0] - off * line.information[0]) / line.information[0];
    sums.scatter += chance[0] * error * error;
    const bool point = chance[circle::kKinds] < 0.5;
    sums.sectors.points[line.sector] += point;
    sums.points += point;
  }
  for (int k = 0; k < circle::kKinds; ++k) sums.kinds[k] = static_cast<float>(kinds[k]);
  sums.lines = static_cast<float>(lines.size());
  sums.far = static_cast<float>(far);
  return sums;
}

}  // namespace impactdic::reference
