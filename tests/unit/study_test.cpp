// The speckle study's parts: bounds against closed forms, errors of made-up motions, pooling.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <random>

#include "host/dic/error_bound.h"
#include "host/study/density_study.h"
#include "host/study/motion_errors.h"
#include "host/study/pattern_findings.h"

namespace impactdic {
namespace {

constexpr double kAmplitude = 50, kPeriodPx = 12;

// A chequer of waves: a · (sin kx + sin ky), whose slopes are known.
Image<float> waves(int width, int height) {
  Image<float> picture(width, height);
  const double k = 2 * kPi / kPeriodPx;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture(x, y) =
          static_cast<float>(100 + kAmplitude * (std::sin(k * x + 0.3) + std::sin(k * y + 1.1)));
    }
  }
  return picture;
}

Image<float> with_noise(Image<float> picture, double sigma) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, static_cast<float>(sigma));
  for (std::size_t i = 0; i < picture.size(); ++i) picture.data()[i] += noise(random);
  return picture;
}

// Over whole periods Σ g_x² = n a² k²/2, Σ g_x g_y = 0.
TEST(ErrorBound, WindowOfWavesIsTheClosedForm) {
  const dic::PictureSlopes slopes(waves(90, 80).view(), 0);
  constexpr int kSide = 36;
  const double k = 2 * kPi / kPeriodPx, noise = 2;
  const double sum = kSide * kSide * kAmplitude * kAmplitude * k * k / 2;
  const dic::WindowBound bound = slopes.window(21, 17, kSide, noise);
  EXPECT_NEAR(bound.u_sd_px, noise * std::sqrt(2 / sum), 2e-3 * bound.u_sd_px);
  EXPECT_NEAR(bound.v_sd_px, noise * std::sqrt(2 / sum), 2e-3 * bound.v_sd_px);
  EXPECT_NEAR(bound.contrast, kAmplitude, 1e-3 * kAmplitude);
}

// Slopes are steady about the centre: the shift's bound as of a window of the disc's area, the
// turn's from n a² k² R²/4.
TEST(ErrorBound, DiscOfWavesIsTheClosedForm) {
  const dic::PictureSlopes slopes(waves(300, 300).view(), 0);
  const double k = 2 * kPi / kPeriodPx, noise = 2, radius = 120;
  const double sum = kPi * radius * radius * kAmplitude * kAmplitude * k * k / 2;
  const BallBound bound = slopes.disc(150, 149, radius, noise);
  EXPECT_NEAR(bound.dx_sd_px, noise * std::sqrt(2 / sum), 0.01 * bound.dx_sd_px);
  EXPECT_NEAR(bound.rot_sd_rad, noise * std::sqrt(2 / (sum * radius * radius / 2)),
              0.02 * bound.rot_sd_rad);
}

// Slopes that are the same everywhere on average do not mix with the place: the affine window's
// displacement is known as well as the rigid one's. An edge alone fixes no affine window.
TEST(ErrorBound, AffineWindow) {
  const dic::PictureSlopes slopes(waves(200, 200).view(), 0);
  const dic::WindowBound rigid = slopes.window(20, 20, 120, 2);
  const dic::WindowBound affine = slopes.affine_window(20, 20, 120, 2);
  EXPECT_NEAR(affine.u_sd_px, rigid.u_sd_px, 0.02 * rigid.u_sd_px);
  EXPECT_NEAR(affine.v_sd_px, rigid.v_sd_px, 0.02 * rigid.v_sd_px);
  EXPECT_GT(affine.expected_sd_px, std::max(affine.u_sd_px, affine.v_sd_px));
  EXPECT_LT(affine.expected_sd_px, 1.5 * std::max(affine.u_sd_px, affine.v_sd_px));
  Image<float> edge(60, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) edge(x, y) = 100 + 80 * std::tanh((x - 0.4F * y - 20) / 2.0F);
  }
  const dic::PictureSlopes of_edge(edge.view(), 0);
  EXPECT_GT(of_edge.affine_window(20, 20, 15, 2).u_sd_px, 1);
  EXPECT_GT(of_edge.affine_window(20, 20, 15, 2).expected_sd_px, 1);
}

// Rows and columns are summed in different ways: a picture turned over its diagonal tells the same.
TEST(ErrorBound, AffineWindowOfRowsAndColumns) {
  Image<float> picture(60, 60), turned(60, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      const float wave = std::sin(0.5F * x + 0.01F * y * y) + std::cos(0.35F * y + 0.008F * x * y);
      picture(x, y) = turned(y, x) = 100 + 30 * wave;
    }
  }
  const dic::WindowBound a = dic::PictureSlopes(picture.view(), 0).affine_window(17, 24, 15, 2);
  const dic::WindowBound b = dic::PictureSlopes(turned.view(), 0).affine_window(24, 17, 15, 2);
  EXPECT_GT(std::abs(a.u_sd_px - a.v_sd_px), 0.01 * a.u_sd_px);
  EXPECT_NEAR(a.u_sd_px, b.v_sd_px, 1e-5 * a.u_sd_px);
  EXPECT_NEAR(a.v_sd_px, b.u_sd_px, 1e-5 * a.v_sd_px);
  EXPECT_NEAR(a.expected_sd_px, b.expected_sd_px, 1e-5 * a.expected_sd_px);
}

TEST(ErrorBound, NoiseInThePictureIsTakenOut) {
  const double noise = 12;
  const dic::PictureSlopes clean(waves(200, 200).view(), 0);
  const dic::PictureSlopes noisy(with_noise(waves(200, 200), noise).view(), noise);
  const dic::WindowBound want = clean.window(20, 20, 150, noise),
                         got = noisy.window(20, 20, 150, noise);
  EXPECT_NEAR(got.u_sd_px, want.u_sd_px, 0.02 * want.u_sd_px);
  EXPECT_NEAR(got.contrast, want.contrast, 0.02 * want.contrast);
  EXPECT_NEAR(noisy.disc(100, 100, 80, noise).rot_sd_rad,
              clean.disc(100, 100, 80, noise).rot_sd_rad,
              0.03 * clean.disc(100, 100, 80, noise).rot_sd_rad);
}

TEST(ErrorBound, FlatPictureBoundsNothing) {
  const Image<float> flat(50, 50, 120.0F);
  const dic::PictureSlopes slopes(flat.view(), 0);
  EXPECT_TRUE(std::isinf(slopes.window(3, 3, 15, 2).u_sd_px));
  EXPECT_TRUE(std::isinf(slopes.disc(25, 25, 20, 2).rot_sd_rad));
  EXPECT_THROW(slopes.window(40, 40, 15, 2), InvalidArgument);
}

TEST(StudyCase, EstimatorsByName) {
  EXPECT_EQ(study::parse_study_estimator("published").options.field.interp_points, 5);
  EXPECT_EQ(study::parse_study_estimator("published9").options.field.interp_points, 9);
  EXPECT_FALSE(study::parse_study_estimator("published0").aimed);
  EXPECT_EQ(study::parse_study_estimator("icgn7").options.field.spline_degree, 7);
  EXPECT_EQ(study::parse_study_estimator("ball").options.estimator, Estimator::kBall);
  for (const char* wrong : {"", "icgn", "icgn4", "published10", "hough"}) {
    EXPECT_THROW(study::parse_study_estimator(wrong), InvalidArgument) << wrong;
  }
}

// A pair whose circle is 0.2 px beside the true centre, measured exactly: what `track` states is
// wrong by the turn of that 0.2 px, the estimator is not.
TEST(MotionErrors, CentreErrorIsToldFromTheEstimators) {
  const StudyMotion motion{"test", 1, -2, 3, false};
  const double c = std::cos(3 * kRadPerDeg) - 1, s = std::sin(3 * kRadPerDeg);
  motion::PairMotion pair;
  pair.first = {100.2, 100, 50};
  pair.motion.ok = true;
  pair.motion.dx_px = 1 + c * 0.2;
  pair.motion.dy_px = -2 - s * 0.2;
  pair.motion.rot_rad = 3 * kRadPerDeg;
  Window window{};
  window.x0 = 103;  // its centre 10 px right of the ball's and 3 below
  window.y0 = 96;
  WindowMotion right{}, wrong{}, bare{};
  right.u = static_cast<float>(1 + c * 10 + s * 3);
  right.v = static_cast<float>(-2 - s * 10 + c * 3 + 0.01);
  wrong.u = 4;
  bare.status = static_cast<idic_int>(WindowStatus::kNoTexture);
  pair.windows = {window, window, window};
  pair.field = {right, wrong, bare};
  const dic::PictureSlopes slopes(waves(200, 200).view(), 0);
  MotionErrors errors;
  study::add_pair(pair, {100, 100, motion}, 15, slopes, 2, errors);
  EXPECT_NEAR(errors.dy_px.mean(), -s * 0.2, 1e-12);
  EXPECT_NEAR(errors.shift_px.rms(), 0, 1e-12);
  EXPECT_NEAR(errors.rot_deg.mean(), 0, 1e-12);
  EXPECT_EQ(errors.windows, 3);
  EXPECT_EQ(errors.no_texture, 1);
  EXPECT_EQ(errors.wrong, 1);
  EXPECT_EQ(errors.window_px.count(), 2);
  EXPECT_NEAR(errors.window_px.rms(), 0.01 / std::sqrt(2), 1e-6);
}

PatternStudyRow row(const std::string& pattern, const std::string& estimator, double error_px,
                    double error_deg, int failed = 0) {
  PatternStudyRow made;
  made.pattern = pattern;
  made.estimator = estimator;
  made.motion = study::study_motions().front();
  made.errors.pairs = 2 + failed;
  made.errors.failed_pairs = failed;
  for (const double sign : {-1, 1}) {
    made.errors.dx_px.add(sign * error_px);
    made.errors.dy_px.add(sign * error_px);
    made.errors.rot_deg.add(sign * error_deg);
    made.errors.window_px.add(sign * error_px);
  }
  return made;
}

TEST(PatternReport, BestIsTheLeastErrorOfThoseThatLoseNothing) {
  const std::vector<PatternStudyRow> rows = {
      row("a1", "icgn5", 0.02, 0.02),  row("e1", "icgn5", 0.01, 0.01),
      row("a1", "ball", 0.005, 0.004), row("e1", "ball", 0.003, 0.002),
      row("a1", "published", 0, 0, 1), row("e1", "published", 0, 0),
  };
  const PatternFindings findings = study::find_patterns(rows, 115);
  EXPECT_EQ(findings.best_estimator, "ball");
  EXPECT_EQ(findings.best_pattern, "e1");
  EXPECT_NE(findings.finding.find("Paint pattern e1"), std::string::npos);
  ASSERT_EQ(findings.estimators.size(), 3u);
  EXPECT_EQ(findings.estimators[0].estimator, "icgn5");
  EXPECT_NEAR(findings.estimators[0].all.motion_rms_px, std::sqrt((0.02 * 0.02 + 0.01 * 0.01) / 2),
              1e-12);
  // 0.02° at half the radius of 115 px.
  EXPECT_NEAR(study::pool(rows, "a1", "icgn5", 115).surface_rms_px,
              std::hypot(0.02, 0.02 * kRadPerDeg * 115 / 2), 1e-12);
}

TEST(DensityReport, GrowthOfAPerfectTransformIsOne) {
  std::vector<DensityRow> rows;
  for (int points = 0; points <= 9; ++points) {
    const double side = 14.0 * (points + 1) + 1;
    rows.push_back({points, "literal", 0.7 * side * side * std::log(side), 0.2, 0, 0, 1});
    rows.push_back({points, "published", 100.0 + points, 0.2, 0, 0, points == 4 ? 0.5 : 1.0});
    rows.push_back({points, "icgn", 10.0 + 0.1 * points, 0.005, 0, 0, kNotMeasured});
  }
  const DensityFindings findings = study::find_density(rows, 15);
  EXPECT_NEAR(findings.literal_growth.value(), 1, 1e-9);
  EXPECT_NEAR(findings.default_spread, 1.09, 1e-9);
  EXPECT_NEAR(findings.same_lag_share, 0.5, 1e-12);
}

}  // namespace
}  // namespace impactdic
