// What all lines across a rim say at some corrections of it. Internal to host/track.
#pragma once

#include <array>
#include <span>

#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/rim/rim_prior.h"

namespace impactdic::circle {

struct LineSums {
  Matrix5 curvature = Matrix5::Zero();  // Σ −∂² ln p j jᵀ, were the kinds known
  Matrix5 hessian = Matrix5::Zero();    // Σ −∂² ln p j jᵀ
  Vector5 score = Vector5::Zero();      // Σ ∂ ln p j
  double hessian_sum = 0;
  SectorSums sectors;
  int points = 0;
  double scatter = 0;
  std::array<float, kKinds> kinds{};  // lines of each
  float lines = 0;
  float far = 0;  // of a line from where its evidence is exact, at most; steps of the trace
};

// In steps of the trace.
RimModel::Shift shift_of(const Vector5& delta, double step_px);

// Of every `every`th block; `shares` as in LineFit; `stray` is the model's.
LineSums sum_lines(std::span<const RimModel::Evidence> blocks, const Vector5& delta, double step_px,
                   const KindShares& shares, float stray, int every);

// Chances of the kinds from their ln p, and that of none of them; 0 where no line is present.
void to_chances(float stray, const Lanes& present, Lanes (&value)[kKinds], Lanes& other);

}  // namespace impactdic::circle
