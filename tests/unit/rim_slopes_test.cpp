// Every analytic slope that the fits of a rim follow against central finite differences, and the
// vectorised sums over lines against plain ones in double precision.
#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/circle/rays/crossing_density.h"
#include "host/circle/rim/blurred_edge.h"
#include "host/circle/rim/line_sums.h"
#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/line_fit.h"
#include "tests/support/rim_reference.h"

namespace impactdic {
namespace {

using circle::kKinds;
using circle::kSamples;
using circle::Vector5;

constexpr double kStep_px = 1.3, kSigma_px = 1.1, kNoise = 0.05;
constexpr double kKernel = circle::kRimModel.kernel_px / kStep_px;

// As of a ball with some ink: every kind is there.
circle::RimTexture inked_texture() {
  circle::TextureSums sums(-0.3f);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> level(0, 1);
  for (int window = 0; window < 400; ++window) {
    float samples[circle::kTexture];
    float ink = level(random);
    for (float& sample : samples) {
      if (level(random) < 0.3f) ink = level(random);
      sample = window % 3 == 0 ? 1 : ink < 0.5f ? 1 - 0.1f * ink : 0.2f + 0.2f * ink;
    }
    sums.add(samples, 0.01f);
  }
  return sums.result(circle::kInk.paint_sd);
}

circle::BlurredEdge edge_at(double excess, double log_sigma) {
  return circle::blurred_edge(excess, kSigma_px / kStep_px * std::exp(log_sigma), kKernel);
}

// Lines of bare paint, ink and nothing like a rim, a few more than fill whole blocks.
circle::LineTrace lines_about_a_rim(int n) {
  circle::LineTrace trace;
  trace.step_px = kStep_px;
  trace.noise = kNoise;
  trace.lines.make_room(static_cast<std::size_t>(n));
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, kNoise);
  std::uniform_real_distribution<double> level(0, 1);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * i / n, ink = i % 4 == 1 ? 0.3 : i % 4 == 2 ? level(random) : 1;
    const circle::BlurredEdge edge = edge_at(0.2 * std::cos(angle) - 0.1, 0);
    circle::Profile profile{};
    for (int k = 0; k < kSamples; ++k) {
      const double seen = i % 17 == 5 ? level(random) : edge.level[k] * (k > 2 ? ink : 1);
      profile[k] = static_cast<float>(seen + noise(random));
    }
    trace.lines.profile[i].v = profile;
    trace.lines.cos[i] = static_cast<float>(std::cos(angle));
    trace.lines.sin[i] = static_cast<float>(std::sin(angle));
    trace.lines.weight[i] = static_cast<float>(0.6 + 0.8 * level(random));
    trace.lines.sector[i] = i * circle::kRimSectors / n;
  }
  trace.lines.keep(static_cast<std::size_t>(n));
  return trace;
}

TEST(RimSlopes, OfTheEdgeByItsPlaceAndWidth) {
  constexpr double h = 1e-4;
  for (const double excess : {-0.9, -0.25, 0.0, 0.4}) {
    const circle::BlurredEdge edge = edge_at(excess, 0);
    const circle::BlurredEdge out = edge_at(excess + h, 0), in = edge_at(excess - h, 0);
    const circle::BlurredEdge wide = edge_at(excess, h), narrow = edge_at(excess, -h);
    for (int k = 0; k < kSamples; ++k) {
      EXPECT_NEAR(edge.shift[k], (out.level[k] - in.level[k]) / (2 * h), 1e-7) << excess << k;
      EXPECT_NEAR(edge.wider[k], (wide.level[k] - narrow.level[k]) / (2 * h), 1e-7) << excess << k;
    }
  }
}

// The kernel's few nodes against its integral.
TEST(RimSlopes, TheEdgeIsTheIntegralOverTheKernel) {
  constexpr int kFine = 4000;
  const circle::BlurredEdge edge = edge_at(0.3, 0);
  const double sigma = kSigma_px / kStep_px;
  for (int k = 0; k < kSamples; ++k) {
    double sum = 0;
    for (int i = 0; i < kFine; ++i) {
      const double u = (i + 0.5) * 4 / kFine - 2, d = std::abs(u);
      const double h =
          d < 1 ? 1.5 * d * d * d - 2.5 * d * d + 1 : -0.5 * d * d * d + 2.5 * d * d - 4 * d + 2;
      const double z = (k - circle::kInside - 0.3 - kKernel * u) / sigma;
      sum += h * 0.5 * std::erfc(z / std::sqrt(2.0)) * 4 / kFine;
    }
    EXPECT_NEAR(edge.level[k], sum, 2e-3) << k;
  }
}

// ln p, its slopes and its information, kind by kind, of every line.
TEST(RimSlopes, OfTheRimModelByPlaceAndWidth) {
  const circle::RimTexture texture = inked_texture();
  const circle::RimModel model(texture, kNoise, kSigma_px, kStep_px);
  const circle::LineTrace trace = lines_about_a_rim(43);
  std::vector<circle::RimModel::Evidence> room;
  const auto blocks = model.evidence(trace, {0.3f, -0.2f, 0.1f, 0.05f, -0.1f}, 1, room);
  std::vector<circle::RimModel::Evidence> widths(blocks.begin(), blocks.end());
  model.width_slopes(widths);
  double all_shares = circle::kRimModel.stray;
  for (const auto& kind : texture.kinds) all_shares += kind.share;
  constexpr double h = 1e-4;
  double steepest = 0, steepest_width = 0;
  for (std::size_t i = 0; i < trace.lines.size(); ++i) {
    const std::size_t block = i / circle::kLanes, lane = i % circle::kLanes;
    const auto& e = blocks[block];
    const double at = e.at[lane], weight = trace.lines.weight[i];
    Eigen::VectorXd samples(kSamples);
    for (int k = 0; k < kSamples; ++k) samples[k] = trace.lines.profile[i].v[k];
    const circle::BlurredEdge here = edge_at(at, 0);
    for (int k = 0; k < kKinds; ++k) {
      const double share = texture.kinds[k].share / all_shares;
      // The scatter of the width from line to line is taken as it is here.
      const auto density = [&](double excess, double log_sigma) {
        return reference::kind_density(texture.kinds[k], edge_at(excess, log_sigma), here, kNoise);
      };
      const auto value = [&](double excess, double log_sigma) {
        return reference::log_density(density(excess, log_sigma), samples, weight, k, share);
      };
      const double slope = (value(at + h, 0) - value(at - h, 0)) / (2 * h);
      const double width = (value(at, h) - value(at, -h)) / (2 * h);
      const double exact = value(at, 0);
      EXPECT_NEAR(e.value[k][lane], exact, 2e-3 + 1e-4 * std::abs(exact)) << i << ' ' << k;
      EXPECT_NEAR(e.slope[k][lane], slope, 5e-3 + 1e-4 * std::abs(slope)) << i << ' ' << k;
      EXPECT_NEAR(widths[block].slope[k][lane], width, 5e-3 + 1e-4 * std::abs(width)) << i << k;
      steepest = std::max(steepest, std::abs(slope));
      steepest_width = std::max(steepest_width, std::abs(width));
      const auto out = density(at + h, 0), in = density(at - h, 0), middle = density(at, 0);
      const Eigen::VectorXd dm = (out.mean - in.mean) / (2 * h);
      const Eigen::MatrixXd ds = (out.covariance - in.covariance) / (2 * h);
      const Eigen::MatrixXd p = middle.covariance.inverse();
      const double information = dm.dot(p * dm) + 0.5 * (p * ds * p * ds).trace();
      EXPECT_NEAR(e.information[k][lane], (k == 0 ? weight : 1) * information, 1e-4 * information);
    }
  }
  EXPECT_GT(steepest, 10);
  EXPECT_GT(steepest_width, 10);
}

// A mixture of lines at some corrections, with which the sums are compared.
class LineSums : public ::testing::Test {
 protected:
  LineSums()
      : trace_(lines_about_a_rim(203)), model_(inked_texture(), kNoise, kSigma_px, kStep_px) {
    const Vector5 about{0.05, -0.1, 0.08, 0.03, 0.02};
    blocks_ = model_.evidence(trace_, circle::shift_of(about, kStep_px), 1, room_);
  }
  circle::LineTrace trace_;
  circle::RimModel model_;
  std::vector<circle::RimModel::Evidence> room_;
  std::span<circle::RimModel::Evidence> blocks_;
  Vector5 delta_{0.11, -0.02, 0.03, -0.04, 0.07};
  circle::KindShares shares_{0.1f, -0.3f, 0.2f, 0.0f, -0.1f, 0.4f, -0.2f, 0.3f};
};

TEST_F(LineSums, AreThoseOfDoublesLineByLine) {
  for (const int every : {1, 2, 3}) {
    const circle::LineSums sums =
        circle::sum_lines(blocks_, delta_, kStep_px, shares_, model_.stray(), every);
    const auto lines = reference::lines_of(blocks_, static_cast<std::size_t>(every));
    const circle::LineSums exact =
        reference::sum_lines(lines, delta_, kStep_px, shares_, model_.stray());
    const double size = exact.curvature(2, 2);
    ASSERT_GT(size, 1000);
    EXPECT_LT((sums.curvature - exact.curvature).cwiseAbs().maxCoeff(), 1e-3 * size) << every;
    EXPECT_LT((sums.hessian - exact.hessian).cwiseAbs().maxCoeff(), 2e-3 * size) << every;
    EXPECT_LT((sums.score - exact.score).cwiseAbs().maxCoeff(), 1e-3 * std::sqrt(size) * 10)
        << every;
    EXPECT_NEAR(sums.hessian_sum, exact.hessian_sum, 2e-3 * size);
    EXPECT_NEAR(sums.scatter, exact.scatter, 1e-3 * exact.scatter);
    EXPECT_EQ(sums.points, exact.points);
    EXPECT_LT(exact.points, exact.lines);  // some have nothing to do with the rim
    EXPECT_EQ(sums.lines, exact.lines);
    EXPECT_NEAR(sums.far, exact.far, 1e-5);
    for (int k = 0; k < kKinds; ++k) EXPECT_NEAR(sums.kinds[k], exact.kinds[k], 5e-3) << k;
    for (int b = 0; b < circle::kRimSectors; ++b) {
      EXPECT_EQ(sums.sectors.points[b], exact.sectors.points[b]) << b;
      EXPECT_NEAR(sums.sectors.score[b], exact.sectors.score[b], 0.05) << b;
      EXPECT_NEAR(sums.sectors.information[b], exact.sectors.information[b], 1e-3 * size) << b;
    }
  }
}

// Bare paint or nothing: the chance of the first is 1 / (1 + e^x).
TEST(LineSumsExponential, IsAsExactAsStated) {
  circle::RimModel::Evidence e{};
  for (int k = 0; k < kKinds; ++k) {
    e.value[k] = circle::Lanes{} - (k == 0 ? 0.0f : 1000.0f);
    e.information[k] = circle::Lanes{} + 1;
  }
  e.present[0] = 1;
  double worst = 0;
  for (float x = -4; x <= 0; x += 0.01f) {
    const circle::LineSums sums =
        circle::sum_lines({&e, 1}, Vector5::Zero(), 1, circle::KindShares{}, x, 1);
    const double power = 1 / static_cast<double>(sums.kinds[0]) - 1;
    worst = std::max(worst, std::abs(power / std::exp(static_cast<double>(x)) - 1));
  }
  EXPECT_LT(worst, 6e-5);
}

TEST_F(LineSums, ScoreAndHessianAreSlopesOfTheLikelihood) {
  const circle::LineSums sums =
      circle::sum_lines(blocks_, delta_, kStep_px, shares_, model_.stray(), 1);
  const auto lines = reference::lines_of(blocks_, 1);
  constexpr double h = 1e-4;
  for (int m = 0; m < 5; ++m) {
    const Vector5 more = delta_ + h * Vector5::Unit(m), less = delta_ - h * Vector5::Unit(m);
    const auto likelihood = [&](const Vector5& at) {
      return reference::log_likelihood(lines, at, kStep_px, shares_, model_.stray());
    };
    const auto score = [&](const Vector5& at) {
      return reference::sum_lines(lines, at, kStep_px, shares_, model_.stray()).score;
    };
    const double slope = (likelihood(more) - likelihood(less)) / (2 * h);
    EXPECT_NEAR(sums.score[m], slope, 0.2 + 1e-3 * std::abs(slope)) << m;
    const Vector5 bend = (score(less) - score(more)) / (2 * h);
    EXPECT_LT((sums.hessian.col(m) - bend).cwiseAbs().maxCoeff(), 2e-3 * sums.curvature(2, 2)) << m;
  }
}

TEST_F(LineSums, TheWidthAskedForIsThatOfDoubles) {
  std::vector<circle::RimModel::Evidence> widths(blocks_.begin(), blocks_.end());
  model_.width_slopes(widths);
  const auto lines = reference::lines_of(blocks_, 1), by_width = reference::lines_of(widths, 1);
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, 6, 6> square = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6 slope = Vector6::Zero();
  std::array<double, kKinds + 1> chance;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    reference::chances(lines[i], 0, {}, model_.stray(), chance);
    double place = 0, width = 0;
    for (int k = 0; k < kKinds; ++k) {
      place += chance[k] * lines[i].slope[k];
      width += chance[k] * by_width[i].slope[k];
    }
    const double cos = lines[i].cos, sin = lines[i].sin;
    Vector6 s;
    s << place * cos, place * sin, place, width, width * (cos * cos - sin * sin),
        width * 2 * cos * sin;
    square += s * s.transpose();
    slope.tail<3>() += s.tail<3>();
  }
  const circle::WidthChange change = circle::sum_widths(blocks_, widths, model_.stray());
  const Eigen::Matrix4d even = square.topLeftCorner<4, 4>();
  const double exact = even.ldlt().solve(Eigen::Vector4d(slope.head<4>()))[3];
  ASSERT_GT(std::abs(exact), 1e-3);
  EXPECT_NEAR(change.even, exact, 1e-3 * std::abs(exact) + 1e-5);
  // What differs around the rim counts only where it is no chance.
  const double uneven = square.ldlt().solve(slope).tail<2>().norm();
  const Eigen::Matrix<double, 6, 6> covariance = square.inverse();
  const double by_chance = std::sqrt(covariance(4, 4) + covariance(5, 5));
  if (uneven > std::sqrt(circle::kLineFit.uneven_chance) * by_chance) {
    EXPECT_NEAR(change.uneven, uneven, 2e-3 * uneven + 1e-5);
  } else {
    EXPECT_EQ(change.uneven, 0);
  }
}

// ln p of a crossing in closed form, without the table of the ratio of normal densities.
double log_density(const circle::Mixture& m, double r) {
  const double ratio = m.sigma / m.tau, z = r / m.sigma;
  const double normal = std::exp(-0.5 * z * z) / (m.sigma * std::sqrt(2 * kPi));
  const double tail = 0.5 * std::erfc((z + ratio) / std::sqrt(2.0));
  const double skewed = std::exp(ratio * (z + 0.5 * ratio)) * tail / m.tau;
  const double strays = (1 - m.clean - m.inked) * circle::kCrossingFit.strays_per_px;
  return std::log(m.clean * normal + m.inked * skewed + strays);
}

TEST(RimSlopes, OfACrossingsDensity) {
  constexpr double h = 1e-4;
  const circle::Mixture both{.clean = 0.6, .inked = 0.35, .sigma = 0.08, .tau = 0.4};
  const circle::Mixture clean{.clean = 1, .inked = 0, .sigma = 0.08, .tau = 0.4};
  const circle::Mixture inked{.clean = 0, .inked = 1, .sigma = 0.08, .tau = 0.4};
  for (const double r : {-0.9, -0.3, -0.11, -0.02, 0.0, 0.05, 0.13, 0.3}) {
    const circle::CrossingDensity density(both);
    const double exact = log_density(both, r);
    const double score = -(log_density(both, r + h) - log_density(both, r - h)) / (2 * h);
    EXPECT_NEAR(std::log(density(r).total), exact, 1e-3) << r;
    EXPECT_NEAR(density(r).score, score, 1e-3 + 1e-3 * std::abs(score)) << r;
    // Of one kind alone: were it known which kind the point is.
    for (const circle::Mixture& kind : {clean, inked}) {
      if (std::abs(r) > 0.5 && kind.inked == 0) continue;  // a density of nothing
      const auto log_p = [&](double at) { return log_density(kind, at); };
      const circle::ResidualEvidence e = circle::CrossingDensity(kind)(r);
      const double slope = -(log_p(r + h) - log_p(r - h)) / (2 * h);
      const double bend = -(log_p(r + h) - 2 * log_p(r) + log_p(r - h)) / (h * h);
      EXPECT_NEAR(e.score, slope, 2e-3 + 1e-3 * std::abs(slope)) << r << ' ' << kind.inked;
      EXPECT_NEAR(e.curvature, bend, 0.05 + 2e-3 * std::abs(bend)) << r << ' ' << kind.inked;
    }
  }
}

}  // namespace
}  // namespace impactdic
