// What one line across the rim says of where the rim is. Internal to host/circle.
//
// A profile is p(x) = B(x) C(x − δ) + noise, x from the expected rim outwards: B the ball's paint
// and ink, C the blurred edge, δ the excess wanted. B is of one of a few kinds (bare paint; ink
// within, at the end, all along …), in each normal with the mean and covariance that the ball shows
// farther inside; or the line has nothing to do with the rim. The likelihood of δ is that of the
// mixture. Ink up to the rim then neither hides the edge nor moves it: it darkens both sides of
// the half-way level alike, and how it scatters is known.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_texture.h"

namespace impactdic::circle {

struct BlurredEdge;

class RimModel {
 public:
  // `noise` of a sample as a share of the contrast; `excess`es in steps of the trace.
  RimModel(const RimTexture& texture, double noise, double edge_sigma_px, double step_px);

  // From and to plain numbers, bit for bit. Throws InvalidArgument for another count of them.
  explicit RimModel(const std::vector<double>& numbers);
  std::vector<double> numbers() const;
  // The tables as kernels/rim/rim.h lays them out: RIM_MODEL numbers.
  std::vector<float> device_numbers() const;

  double edge_sigma_px() const { return edge_sigma_px_; }
  double step_px() const { return step_px_; }
  double noise() const { return noise_; }
  // How far all lines together may place the rim wrongly because ink and edge there are not quite
  // the model's.
  double place_sd_px() const { return place_sd_px_; }
  void set_place_sd_px(double sd) { place_sd_px_ = sd; }
  // Of a sphere: how far its light and the foreshortening of its ink may misplace the radius.
  double light_sd_px() const { return light_sd_px_; }
  void set_light_sd_px(double sd) { light_sd_px_ = sd; }
  const RimTexture& texture() const { return texture_; }
  // What the ball shows, and of a sphere the light in which it was learnt.
  Surface surface() const { return surface_; }
  const SphereLight* light() const { return light_ ? &*light_ : nullptr; }
  // kSphere or kOutline.
  void set_surface(Surface surface, const SphereLight& light) {
    surface_ = surface;
    light_ = light;
  }
  // The same model through more noise: its likelihood has no maxima beside the rim's, so that it
  // finds the rim from farther away, and less exactly.
  const RimModel& blurred() const { return *blurred_; }

  // What kLanes lines say, linear about an excess `at` of each: ln p by kind, ∂/∂δ and −∂²/∂δ².
  struct Evidence {
    Lanes value[kKinds], slope[kKinds], information[kKinds];
    Lanes at, cos, sin, present;  // present: 1, or 0 where there are no more lines
    Lanes profile[kSamples], weight;
    IntLanes sector;
  };
  // Excess of a line: `shift`'s products with (cos φ, sin φ, 1, cos 2φ, sin 2φ).
  typedef std::array<float, 5> Shift;
  static constexpr float kNear = 0.0625f;
  // Of every `stride`th line, about its excess, or one that lies kNear off at most; in `room`,
  // which grows where it must.
  std::span<Evidence> evidence(const LineTrace& trace, const Shift& shift, int stride,
                               std::vector<Evidence>& room) const;
  // ∂ ln p / ∂ ln σ by kind, at the same excesses, in place of the slopes.
  void width_slopes(std::span<Evidence> blocks) const;
  // Mean square of what the lines leave, in standard deviations of their likeliest kinds; kSamples
  // where the model holds.
  double misfit(std::span<const Evidence> blocks) const;
  // ln p of a line that has nothing to do with the rim.
  float stray() const { return log_stray_; }

 private:
  static constexpr float kPerStep = 0.5f / kNear;  // excesses with a table, per step of the trace
  static constexpr int kReach = 8;                 // tables on either side of 0
  // By kind: constant + linear·p + pᵀ matrix p, of kind 0 times the line's weight, + offset. The
  // numbers in the order constant, then for each i linear[i] and matrix[i][0 … i], those off the
  // diagonal twice.
  static constexpr int kNumbers = 1 + kSamples + kSamples * (kSamples + 1) / 2;
  struct Quadratic {
    float number[kNumbers][kKinds], offset[kKinds];
  };
  struct Table {
    Quadratic value, slope, width;  // ln p, ∂/∂δ, ∂/∂ ln σ
    float information[kKinds];
  };
  struct Monomials;
  enum class Blurred { kNo, kYes };
  RimModel(const RimTexture& texture, double noise, double edge_sigma_px, double step_px, Blurred);
  void fill(int place) const;
  void fill(const BlurredEdge& edge, int kind, Table& table) const;
  // Makes the tables of all excesses up to this one; safe on several threads.
  void reach(float excess) const;
  // Which table is nearest to an excess, or the last one on that side.
  static int place_of(float excess) {
    constexpr float kMost = kReach;
    return static_cast<int>(std::clamp(excess * kPerStep, -kMost, kMost) + (kMost + 0.5f));
  }
  template <typename Use>
  void for_each_place(const Evidence& e, const Use& use) const;
  static void form(const Quadratic& q, const Monomials& p, const Lanes& weight,
                   Lanes (&out)[kKinds]);

  RimTexture texture_;
  double edge_sigma_px_, noise_, step_px_, sigma_;
  double place_sd_px_ = 0, light_sd_px_ = 0;
  Surface surface_ = Surface::kFlat;
  std::optional<SphereLight> light_;
  std::unique_ptr<const RimModel> blurred_;
  std::array<float, kKinds> log_share_{};
  float log_stray_ = 0;
  mutable std::vector<Table> tables_;    // by excess
  mutable std::atomic<int> ready_ = -1;  // of the tables, this far on either side
  mutable std::mutex filling_;
};

}  // namespace impactdic::circle
