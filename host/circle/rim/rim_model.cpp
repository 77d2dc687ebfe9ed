// The numbers of a rim model and its tables; the lines' side of it is in rim_evidence.cpp.
#include "host/circle/rim/rim_model.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "host/circle/rim/blurred_edge.h"
#include "host/circle/settings/rim_model.h"
#include "kernels/rim/rim.h"

namespace impactdic::circle {

RimModel::RimModel(const RimTexture& texture, double noise, double edge_sigma_px, double step_px,
                   Blurred)
    : texture_(texture),
      edge_sigma_px_(edge_sigma_px),
      noise_(noise),
      step_px_(step_px),
      sigma_(edge_sigma_px / step_px),
      tables_(2 * kReach + 1) {
  double total = kRimModel.stray;
  for (const auto& kind : texture.kinds) total += kind.share;
  for (int k = 0; k < kKinds; ++k) {
    log_share_[k] = static_cast<float>(std::log(texture.kinds[k].share / total));
  }
  // A stray's samples are anything between background and paint, with equal chance; in units in
  // which a normal density has no factor (2π)^(−n/2).
  log_stray_ =
      static_cast<float>(std::log(kRimModel.stray / total) + 0.5 * kSamples * std::log(2 * kPi));
}

RimModel::RimModel(const RimTexture& texture, double noise, double edge_sigma_px, double step_px)
    : RimModel(texture, noise, edge_sigma_px, step_px, Blurred::kNo) {
  blurred_.reset(new RimModel(texture, std::hypot(noise, kRimModel.blurred), edge_sigma_px, step_px,
                              Blurred::kYes));
}

namespace {

constexpr std::size_t kStoredNumbers = 4 + kKinds * (1 + kTexture + kTexture * kTexture);
// Of a sphere behind these: the light's terms, SphereLight::shown, light_sd_px, 1 of an outline.
constexpr std::size_t kLightNumbers = kLightTerms + 3;

RimTexture texture_of(const std::vector<double>& numbers) {
  if (numbers.size() != kStoredNumbers && numbers.size() != kStoredNumbers + kLightNumbers) {
    throw InvalidArgument("a rim model has another count of numbers", "resume");
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
  if (numbers.size() == kStoredNumbers) return;
  LightTerms terms;
  std::copy_n(numbers.begin() + kStoredNumbers, kLightTerms, terms.begin());
  const double* const behind = numbers.data() + kStoredNumbers + kLightTerms;
  light_sd_px_ = behind[1];
  set_surface(behind[2] > 0 ? Surface::kOutline : Surface::kSphere, SphereLight(terms, behind[0]));
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
  if (light_) {
    const LightTerms& terms = light_->terms();
    numbers.insert(numbers.end(), terms.begin(), terms.end());
    numbers.insert(numbers.end(),
                   {light_->shown(), light_sd_px_, surface_ == Surface::kOutline ? 1.0 : 0.0});
  }
  return numbers;
}

std::vector<float> RimModel::device_numbers() const {
  static_assert(kSamples == RIM_SAMPLES && kInside == RIM_INSIDE && kKinds == RIM_KINDS);
  static_assert(kReach == RIM_MODEL_REACH && kNumbers == RIM_FORMS);
  static_assert(sizeof(Quadratic) == RIM_FORM * sizeof(float));
  reach(kReach);
  std::vector<float> numbers(RIM_MODEL_HEAD);
  numbers.reserve(RIM_MODEL);
  numbers[0] = log_stray_;
  for (int k = 0; k < kKinds; ++k) {
    numbers[RIM_KINDS + k] = static_cast<float>(texture_.kinds[k].share);
  }
  for (const Table& table : tables_) {
    for (const Quadratic* form : {&table.value, &table.slope}) {
      numbers.insert(numbers.end(), &form->number[0][0], &form->number[0][0] + kNumbers * kKinds);
      numbers.insert(numbers.end(), std::begin(form->offset), std::end(form->offset));
    }
    numbers.insert(numbers.end(), std::begin(table.information), std::end(table.information));
  }
  return numbers;
}

void RimModel::fill(int place) const {
  const BlurredEdge edge =
      blurred_edge((place - kReach) / kPerStep, sigma_, kRimModel.kernel_px / step_px_);
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

namespace {

constexpr double kGroundVariance = kRimModel.ground_sd * kRimModel.ground_sd;
constexpr double kWidthVariance = kRimModel.width_sd * kRimModel.width_sd;

// The normal density of a profile of one kind about one edge, N(m, Σ): μ is the paint's and ink's
// mean, K their covariance, C the edge, m = μ C and
//   Σ = C K C + noise² + ground² (1 − C)(1 − C)ᵀ + width² (μ ∂C)(μ ∂C)ᵀ, ∂ by ln σ.
struct ProfileDensity {
  SampleVector mu, mean, outside;
  SampleMatrix paint, precision;
  double log_root_det;  // ½ ln det Σ

  ProfileDensity(const RimTexture::Kind& kind, const BlurredEdge& edge, double noise);
};

ProfileDensity::ProfileDensity(const RimTexture::Kind& kind, const BlurredEdge& edge,
                               double noise) {
  // Samples outside the innermost kTexture go on as the last of these.
  for (int i = 0; i < kSamples; ++i) {
    const int a = std::min(i, kTexture - 1);
    mu[i] = kind.mean[a];
    for (int j = 0; j < kSamples; ++j) {
      paint(i, j) = kind.covariance[a][std::min(j, kTexture - 1)];
    }
  }
  mean = mu.cwiseProduct(edge.level);
  outside = SampleVector::Ones() - edge.level;
  const SampleVector wider = mu.cwiseProduct(edge.wider);
  SampleMatrix sigma = edge.level.asDiagonal() * paint * edge.level.asDiagonal();
  sigma.diagonal().array() += noise * noise;
  sigma.noalias() += kGroundVariance * outside * outside.transpose();
  sigma.noalias() += kWidthVariance * wider * wider.transpose();
  const Eigen::LLT<SampleMatrix> factor(sigma);
  precision = factor.solve(SampleMatrix::Identity());
  log_root_det = factor.matrixLLT().diagonal().array().log().sum();
}

// A quadratic in the profile, constant + linear·p + pᵀ matrix p, plus an offset.
struct Form {
  SampleMatrix matrix;
  SampleVector linear;
  double constant, offset;
};

Form log_density(const ProfileDensity& d, double log_share) {
  const SampleVector pm = d.precision * d.mean;
  return {-0.5 * d.precision, pm, -0.5 * d.mean.dot(pm), log_share - d.log_root_det};
}

// The derivative of ln p where C changes by `change`: with P = Σ⁻¹ and r = p − m,
//   ∂ ln p = rᵀ P ∂m + ½ rᵀ P ∂Σ P r − ½ tr(P ∂Σ),
// and the information ∂mᵀ P ∂m + ½ tr(P ∂Σ P ∂Σ). The width's part of Σ is taken as constant.
Form slope_of(const ProfileDensity& d, const BlurredEdge& edge, const SampleVector& change,
              double& information) {
  const SampleMatrix& p = d.precision;
  const SampleVector dm = d.mu.cwiseProduct(change);
  SampleMatrix ds = change.asDiagonal() * d.paint * edge.level.asDiagonal();
  ds.noalias() -= kGroundVariance * change * d.outside.transpose();
  ds += ds.transpose().eval();
  const SampleMatrix pds = p * ds;
  const SampleMatrix w = 0.5 * pds * p;
  const SampleVector pdm = p * dm, wm = w * d.mean;
  information = dm.dot(pdm) + 0.5 * pds.cwiseProduct(pds.transpose()).sum();
  return {w, pdm - 2 * wm, d.mean.dot(wm) - d.mean.dot(pdm), -0.5 * pds.trace()};
}

template <typename Quadratic>
void store(const Form& form, int kind, Quadratic& q) {
  int at = 0;
  q.number[at++][kind] = static_cast<float>(form.constant);
  for (int i = 0; i < kSamples; ++i) {
    q.number[at++][kind] = static_cast<float>(form.linear[i]);
    for (int j = 0; j <= i; ++j) {
      const double both = j == i ? form.matrix(i, i) : 2 * form.matrix(i, j);
      q.number[at++][kind] = static_cast<float>(both);
    }
  }
  q.offset[kind] = static_cast<float>(form.offset);
}

}  // namespace

void RimModel::fill(const BlurredEdge& edge, int kind, Table& table) const {
  const ProfileDensity density(texture_.kinds[kind], edge, noise_);
  double information = 0, width_information = 0;
  store(log_density(density, log_share_[kind]), kind, table.value);
  store(slope_of(density, edge, edge.shift, information), kind, table.slope);
  store(slope_of(density, edge, edge.wider, width_information), kind, table.width);
  table.information[kind] = static_cast<float>(information);
}

}  // namespace impactdic::circle
