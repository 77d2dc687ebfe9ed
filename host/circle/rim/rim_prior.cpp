#include "host/circle/rim/rim_prior.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/circle/settings/line_fit.h"

namespace impactdic::circle {

void Knowledge::add(const Vector5& direction, double value, double sd) {
  precision += direction * direction.transpose() / (sd * sd);
  pull += direction * (value / (sd * sd));
}

Knowledge knowledge(const Rim& rim, const Vector5& delta, const CirclePrior& prior, Shape shape,
                    double shrink_px) {
  const bool ellipse = shape == Shape::kEllipse;
  Knowledge k;
  const double e1 = rim.e1 + delta[3], e2 = rim.e2 + delta[4];
  const double e = std::hypot(e1, e2);
  if (!ellipse) {
    k.add(Vector5::Unit(3), -rim.e1, kPrior.circle_sd_px);
    k.add(Vector5::Unit(4), -rim.e2, kPrior.circle_sd_px);
  }
  // Unit vector (in e1, e2) of the long axis: across the compression.
  // Without a given axis it fades out where the shape is too round to have one.
  double u1 = e1 / (e + kPrior.round_px), u2 = e2 / (e + kPrior.round_px);
  if (ellipse && prior.compression_axis_rad) {
    u1 = -std::cos(2 * *prior.compression_axis_rad);
    u2 = -std::sin(2 * *prior.compression_axis_rad);
    Vector5 across = Vector5::Zero();
    across[3] = -u2;
    across[4] = u1;
    k.add(across, u2 * rim.e1 - u1 * rim.e2, kPrior.axis_tilt * e + kPrior.axis_px);
  }
  if (prior.radius_px && prior.radius_sd_px) {
    Vector5 long_axis = Vector5::Unit(2);
    double value = *prior.radius_px - shrink_px - rim.r, sd = *prior.radius_sd_px;
    if (ellipse) {
      long_axis[3] = u1;
      long_axis[4] = u2;
      value -= u1 * rim.e1 + u2 * rim.e2;
      sd = std::hypot(sd, kPrior.transverse * e);
    }
    k.radius = long_axis;
    k.radius_value = value;
    k.radius_sd = std::max(sd, kPrior.least_radius_sd_px);
    k.add(long_axis, value, k.radius_sd);
  }
  return k;
}

RadiusShare radius_share(const Knowledge& known, const Matrix5& precision,
                         const Matrix5& covariance, const Vector5& delta) {
  RadiusShare share{Vector5::Zero(), covariance, 0};
  if (known.radius_sd == 0) return share;
  const double weight = 1 / (known.radius_sd * known.radius_sd);
  share.follows = weight * covariance * known.radius;
  const Matrix5 rest = precision - weight * known.radius * known.radius.transpose();
  share.alone = Eigen::LDLT<Matrix5>(rest).solve(Matrix5::Identity());
  const double pulled = known.radius_value - known.radius.dot(delta);
  share.moved = -weight * pulled * share.alone.row(2).dot(known.radius);
  return share;
}

RadiusOfFrame own_radius(const RadiusShare& share, double r_px) {
  RadiusOfFrame own;
  Vector5::Map(own.follows) = share.follows;
  own.r_px = r_px + share.moved;
  own.r_sd_px = std::sqrt(std::max(0.0, share.alone(2, 2)));
  return own;
}

double score_test(const Matrix5& information, const Vector5& score, double wider) {
  const Eigen::Matrix3d circle = information.topLeftCorner<3, 3>();
  const Eigen::Matrix<double, 3, 2> cross = information.topRightCorner<3, 2>();
  const Eigen::Matrix2d shape =
      information.bottomRightCorner<2, 2>() - cross.transpose() * circle.ldlt().solve(cross);
  const Eigen::Vector2d oval = score.tail<2>();
  return oval.dot(shape.ldlt().solve(oval)) / wider;
}

double wald(const Rim& rim, const Vector5& delta, const Matrix5& covariance) {
  const Eigen::Vector2d e{rim.e1 + delta[3], rim.e2 + delta[4]};
  const Eigen::Matrix2d part = covariance.bottomRightCorner<2, 2>();
  return e.dot(part.ldlt().solve(e));
}

namespace {

constexpr int kWavesOfLight = 5, kFirstSeen = 2;  // see wavy_light
constexpr int kTerms = 2 * kWavesOfLight + 1;     // 1, cos, sin, cos 2 …
typedef Eigen::Array<double, kRimSectors, 1> BySector;
typedef Eigen::Matrix<double, kRimSectors, kTerms> Waves;

// At the middles of the sectors, which share the quarters from -45° on by the tangent.
const Waves& waves() {
  static const Waves all = [] {
    Waves made;
    constexpr int kOfQuarter = kRimSectors / 4;
    for (int b = 0; b < kRimSectors; ++b) {
      const int quarter = b / kOfQuarter;
      const double tangent = 2 * (b % kOfQuarter + 0.5) / kOfQuarter - 1;
      const double angle = std::atan(tangent) + quarter * (kPi / 2);
      made(b, 0) = 1;
      for (int k = 1; k <= kWavesOfLight; ++k) {
        made(b, 2 * k - 1) = std::cos(k * angle);
        made(b, 2 * k) = std::sin(k * angle);
      }
    }
    return made;
  }();
  return all;
}

// Variances of the waves' terms, of 1 px² at each place in all: of light the less, the finer.
Eigen::Matrix<double, kTerms, 1> variances(bool ink) {
  Eigen::Matrix<double, kTerms, 1> v;
  v[0] = 1;
  for (int m = 1; m < kTerms; ++m) {
    const int wave = (m + 1) / 2;
    v[m] = ink ? 2.0 : 2.0 / wave;
  }
  return v / (1 + v.tail<kTerms - 1>().sum() / 2);
}

}  // namespace

Matrix5 wavy_light(const SectorSums& s, double wider, const Matrix5& covariance, bool ink) {
  const Waves& all = waves();
  const Eigen::Matrix<double, kTerms, 1> variance = variances(ink);
  const BySector score = BySector::Map(s.score.data());
  const BySector information = BySector::Map(s.information.data()).max(0);
  Eigen::Matrix<double, kRimSectors, 5> jacobian;
  jacobian << all.col(1), all.col(2), all.col(0), all.col(3), all.col(4);
  const Eigen::Matrix<double, 5, kRimSectors> gain =
      covariance * jacobian.transpose() * information.matrix().asDiagonal() / wider;
  double seen = 0, by_chance = 0, by_waves = 0;
  for (int m = 2 * kFirstSeen - 1; m < kTerms; ++m) {
    // The wave's product with what sectors say, once the fit has taken its part.
    const Eigen::Matrix<double, kRimSectors, 1> wave = all.col(m);
    const BySector left = (wave - jacobian * (gain * wave)).array() * information;
    seen += std::pow((wave.array() * score).sum(), 2);
    by_chance += wider * (left.square() / information.max(1e-30)).sum();
    by_waves += variance.dot(all.transpose().lazyProduct(left.matrix()).cwiseAbs2());
  }
  // The mean of a variance of which so few squares are known.
  constexpr double kFreedom = kTerms - (2 * kFirstSeen - 1);
  seen *= kFreedom / (kFreedom - 2);
  const double excess = std::max(0.0, seen - by_chance) / std::max(by_waves, 1e-30);
  const Eigen::Matrix<double, 5, kTerms> moved = gain * all;
  return excess * moved * variance.asDiagonal() * moved.transpose();
}

double inflation(const SectorSums& s, double information, double common_px, int parameters) {
  double between = 0, common = 0;
  int used = 0;
  for (int b = 0; b < kRimSectors; ++b) {
    between += s.score[b] * s.score[b];
    common += std::pow(common_px * s.information[b], 2);
    used += s.points[b] > 0;
  }
  const double freedom = static_cast<double>(used) / std::max(1, used - parameters);
  const double sum = std::max(information, 1e-30);
  return std::max(1.0, between * freedom / sum) + common / sum;
}

}  // namespace impactdic::circle
