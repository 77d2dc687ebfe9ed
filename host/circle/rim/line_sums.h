// What all lines across a rim say at some corrections of it. Internal to host/circle.
#pragma once

#include <array>
#include <span>

#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/rim/rim_prior.h"
#include "kernels/rim/rim.h"

namespace impactdic::circle {

// j is (cos φ, sin φ, 1, cos 2φ, sin 2φ), ∂ by a line's excess in px, p the mixture of all kinds
// and of lines that have nothing to do with the rim.
struct LineSums {
  Matrix5 curvature = Matrix5::Zero();  // Σ −∂² ln p j jᵀ, were the kinds known
  Matrix5 hessian = Matrix5::Zero();    // Σ −∂² ln p j jᵀ
  Vector5 score = Vector5::Zero();      // Σ ∂ ln p j
  double hessian_sum = 0;               // Σ −∂² ln p
  SectorSums sectors;                   // ∂ ln p, −∂² ln p and the points among the lines
  int points = 0;                       // lines that have to do with the rim, more likely than not
  double scatter = 0;                   // Σ squared distance of bare lines, steps of the trace
  std::array<float, kKinds> kinds{};    // lines of each
  float lines = 0;
  float far = 0;  // of a line from where its evidence is exact, at most; steps of the trace
};

// By px from sums by steps of the trace: those by waves, and those over sectors.
LineSums in_px(const RimShape& all, const SectorSums& sectors, float lines, double step_px);

// In steps of the trace.
RimModel::Shift shift_of(const Vector5& delta, double step_px);

// Of every `every`th block, at the corrections `delta` (px); `shares` as in LineFit; `stray` is the
// model's. Single precision, exponentials to 6e-5.
LineSums sum_lines(std::span<const RimModel::Evidence> blocks, const Vector5& delta, double step_px,
                   const KindShares& shares, float stray, int every);

// Changes of ln σ of the edge that the lines ask for, with x, y and R free beside it: the same all
// around, and the amplitude over cos and sin 2φ, as motion blur makes it; 0 where that is chance.
struct WidthChange {
  double even = 0, uneven = 0;
};
// `widths` are the blocks with RimModel::width_slopes; `blocks` get the chances of the kinds in
// place of ln p.
WidthChange sum_widths(std::span<RimModel::Evidence> blocks,
                       std::span<const RimModel::Evidence> widths, float stray);

// What errors of the lines' places add to the covariance, if they have a standard deviation of 1 px
// all around the rim and of kLineFit.arcs px sector by sector. A known radius turns some of it
// aside.
Matrix5 misplaced(const LineSums& s, double wider, const Matrix5& covariance);

}  // namespace impactdic::circle
