// What one crossing of the half level says of where the rim is. Internal to host/circle.
#pragma once

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/circle/settings/crossings.h"

namespace impactdic::circle {

// How residuals are distributed. A clean edge errs by the noise, N(0, σ). Ink that reaches into
// the edge darkens it and so moves the crossing inwards by some depth, exponential with mean τ,
// before the noise: the composed error of a stochastic frontier (Aigner, Lovell and Schmidt,
// 1977; Meeusen and van den Broeck, 1977). A few points have nothing to do with the rim.
struct Mixture {
  double clean = kCrossingFit.clean, inked = kCrossingFit.inked;    // shares; the rest are strays
  double sigma = kCrossingFit.sigma_px, tau = kCrossingFit.tau_px;  // px
  double most_sigma = kCrossingFit.most_sigma_px;                   // px
};

// What one residual says under a mixture.
struct ResidualEvidence {
  double total;            // density
  double clean, inked;     // posterior shares
  double score;            // −∂ ln p / ∂r
  double curvature;        // −∂² ln p / ∂r² were it known which kind the point is
  double depth, noise_sq;  // expected depth if inked; expected squared noise, either kind
};

// φ(a) / Φ(−a), the inverse of Mills' ratio, from a table of values 1/64 apart; error < 1e-5.
class InverseMills {
 public:
  InverseMills() {
    for (int i = 0; i <= 2 * kReach * kPerUnit; ++i) {
      const double a = static_cast<double>(i) / kPerUnit - kReach;
      table_[i] = std::exp(-0.5 * a * a) / (std::sqrt(kPi / 2) * std::erfc(a / std::sqrt(2.0)));
    }
  }
  double operator()(double a) const {
    if (a <= -kReach) return 0;
    if (a >= kReach) return a + 1 / a - 2 / (a * a * a);
    const double at = (a + kReach) * kPerUnit;
    const int i = static_cast<int>(at);
    return table_[i] + (at - i) * (table_[i + 1] - table_[i]);
  }

 private:
  static constexpr int kReach = 10, kPerUnit = 64;
  std::array<double, 2 * kReach * kPerUnit + 2> table_{};
};

// A mixture with what every evaluation needs of it.
class CrossingDensity {
 public:
  explicit CrossingDensity(const Mixture& m)
      : m_(m),
        per_sigma_(1 / m.sigma),
        precision_(per_sigma_ * per_sigma_),
        ratio_(m.sigma / m.tau),
        peak_(per_sigma_ / std::sqrt(2 * kPi)),
        strays_((1 - m.clean - m.inked) * kCrossingFit.strays_per_px) {}

  ResidualEvidence operator()(double r) const {
    const double z = r * per_sigma_, a = z + ratio_;
    const double normal = std::abs(z) < kCrossingFit.most_z ? std::exp(-0.5 * z * z) * peak_ : 0;
    const double mills = inverse_mills_(a);
    // exp(r/τ + σ²/2τ²) Φ(−a) / τ, by way of N(r; 0, σ) where that does not vanish.
    const double skewed = a > kCrossingFit.least_a ? normal * ratio_ / mills
                                                   : std::exp(ratio_ * (z + 0.5 * ratio_)) / m_.tau;
    const double clean = m_.clean * normal, inked = m_.inked * skewed;
    const double per_total = 1 / (clean + inked + strays_);
    ResidualEvidence e;
    e.total = clean + inked + strays_;
    e.clean = clean * per_total;
    e.inked = inked * per_total;
    // The depth given r is normal about −σ·a with σ, cut off at 0; `share` is its variance / σ².
    const double share = std::clamp(1 + a * mills - mills * mills, 0.0, 1.0);
    e.depth = m_.sigma * (mills - a);
    const double noise_inked = r + e.depth;
    const double score_clean = r * precision_, score_inked = noise_inked * precision_;
    e.score = e.clean * score_clean + e.inked * score_inked;
    e.curvature = precision_ * (e.clean + e.inked * (1 - share));
    e.noise_sq =
        e.clean * r * r + e.inked * (noise_inked * noise_inked + share * m_.sigma * m_.sigma);
    return e;
  }

 private:
  static const InverseMills inverse_mills_;
  Mixture m_;
  double per_sigma_, precision_, ratio_, peak_, strays_;
};
inline const InverseMills CrossingDensity::inverse_mills_;

}  // namespace impactdic::circle
