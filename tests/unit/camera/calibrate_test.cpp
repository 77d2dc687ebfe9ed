#include <gtest/gtest.h>
#include <impactdic/camera/calibrate.h>
#include <impactdic/error.h>

#include <cmath>

#include "host/camera/plane_view.h"
#include "tests/support/camera/rendered_calibration.h"

namespace impactdic {
namespace {

using Eigen::Vector2d;
using P = CameraParameter;

CalibrateRequest request_of(CalibrationTarget target) {
  CalibrateRequest request = testing::rendered_target(target);
  request.rows = 6;
  return request;
}

// Exact projections of the target's points, off by normal noise.
std::vector<camera::View> projected(const CalibrateRequest& request,
                                    const testing::RandomCalibration& made, double noise_px) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 1);
  std::vector<camera::View> views;
  for (const Camera& camera : made.views) {
    camera::View view{std::to_string(views.size()), {}};
    for (const Vector2d& at : testing::project_target(camera, camera::board_points(request))) {
      const double down = noise(random), aside = noise(random);
      view.seen.push_back({view.seen.size(), at + noise_px * Vector2d(aside, down)});
    }
    views.push_back(view);
  }
  return views;
}

CalibrateResult solved(const CalibrateRequest& request, const std::vector<camera::View>& views,
                       const Camera& truth) {
  return camera::calibrate_points(request, views, truth.width, truth.height);
}

// Largest distance in the picture between a point and where it comes back to, when one camera takes
// it to the plane and the other back; px.
double worst_place(const Camera& a, const Camera& b) {
  const camera::PlaneView one(a), other(b);
  double worst = 0;
  for (double x = 0; x < a.width; x += 40) {
    for (double y = 0; y < a.height; y += 40) {
      const Vector2d there = one.to_plane({x, y});
      worst =
          std::max(worst, (other.to_picture({there.x(), there.y(), 0}) - Vector2d(x, y)).norm());
    }
  }
  return worst;
}

TEST(Calibrate, ExactPointsGiveTheExactCamera) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;  // no dot has an extent here
  const testing::RandomCalibration made = testing::random_calibration(request, 8, 3);
  const CalibrateResult found = solved(request, projected(request, made, 0), made.views[0]);
  for (std::size_t p = 0; p < 4; ++p) {
    EXPECT_NEAR(found.camera.values[p], made.views[0].values[p], 1e-3) << p;
  }
  EXPECT_LT(worst_place(found.camera, made.views[0]), 1e-4);
  EXPECT_EQ(found.terms, "k1 k2 p1 p2");
  EXPECT_TRUE(found.good) << found.verdict.front();
}

class CalibrateTarget : public ::testing::TestWithParam<CalibrationTarget> {};

// Noise of 2 grey levels, blurred.
TEST_P(CalibrateTarget, RenderedPicturesGiveTheCamera) {
  const CalibrateRequest request = request_of(GetParam());
  const testing::RandomCalibration made = testing::random_calibration(request, 8, 5);
  const CalibrateResult found =
      testing::calibrate_rendered(request, testing::rendered_pictures(request, made.views, 1));
  for (const CalibrationPicture& picture : found.pictures) {
    EXPECT_TRUE(picture.used) << picture.name << ": " << picture.reason;
  }
  EXPECT_LT(found.point_sd_px, 0.012);  // point_fit_test: what noise makes it
  EXPECT_TRUE(found.camera.focal_length_known);
  for (std::size_t p = 0; p < kCameraParameters; ++p) {
    const auto parameter = static_cast<P>(p);
    const double sd = std::sqrt(found.camera.variance(parameter));
    EXPECT_NEAR(found.camera[parameter], made.views[0][parameter], 4 * sd) << to_string(parameter);
  }
  EXPECT_LT(worst_place(found.camera, made.views[0]), 0.1);
  const double truth = camera::PlaneView(made.views[0]).metre_per_px();
  EXPECT_NEAR(found.metre_per_px.value, truth, 3 * found.metre_per_px.sd);
}

INSTANTIATE_TEST_SUITE_P(All, CalibrateTarget,
                         ::testing::Values(CalibrationTarget::kCheckerboard,
                                           CalibrationTarget::kCharuco, CalibrationTarget::kDots),
                         [](const auto& info) { return std::string(to_string(info.param)); });

// In short what bench/metres/camera_coverage does on pictures; 20 x 15 parameters that hang
// together.
TEST(Calibrate, TruthLiesWithinTwoDeviations) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  int within = 0, all = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int pictures = 5 + static_cast<int>(seed);
    const testing::RandomCalibration made = testing::random_calibration(request, pictures, seed);
    const CalibrateResult found = solved(request, projected(request, made, 0.05), made.views[0]);
    for (std::size_t p = 0; p < kCameraParameters; ++p) {
      const auto parameter = static_cast<P>(p);
      const double sd = std::sqrt(found.camera.variance(parameter));
      within += std::abs(found.camera[parameter] - made.views[0][parameter]) <= 2 * sd;
      ++all;
    }
  }
  EXPECT_GE(within, 0.9 * all);
  EXPECT_LT(within, all);
}

TEST(Calibrate, WrongCornersAreLeftOut) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  const testing::RandomCalibration made = testing::random_calibration(request, 8, 3);
  std::vector<camera::View> views = projected(request, made, 0.03);
  views[2].seen[7].at_px += Vector2d(6, -3);
  views[2].seen[9].at_px += Vector2d(0.8, 0);
  views[5].seen[20].at_px += Vector2d(-40, 25);
  const CalibrateResult found = solved(request, views, made.views[0]);
  EXPECT_EQ(found.pictures[2].rejected, 2u);
  EXPECT_EQ(found.pictures[5].rejected, 1u);
  EXPECT_LT(found.point_sd_px, 0.04);
  EXPECT_LT(worst_place(found.camera, made.views[0]), 0.2);  // one wrong corner moves it by more
}

// Markers that were taken for others: so far off that a fit to all points turns the target away.
TEST(Calibrate, SquaresTakenForOthersAreLeftOut) {
  const CalibrateRequest request = request_of(CalibrationTarget::kCharuco);
  const testing::RandomCalibration made = testing::random_calibration(request, 8, 3);
  std::vector<camera::View> views = projected(request, made, 0.005);
  for (const std::size_t point : {25u, 26u, 33u, 34u}) {
    views[4].seen[point].at_px -= Vector2d(115, 50);
  }
  const CalibrateResult found = solved(request, views, made.views[0]);
  for (std::size_t v = 0; v < views.size(); ++v) {
    EXPECT_EQ(found.pictures[v].rejected, v == 4 ? 4u : 0u) << v;
  }
  EXPECT_LT(found.point_sd_px, 0.006);
}

// Points of a view that are known less well than others count for less.
TEST(Calibrate, PointsCountByTheirCovariance) {
  const CalibrateRequest request = request_of(CalibrationTarget::kCheckerboard);
  const testing::RandomCalibration made = testing::random_calibration(request, 8, 3);
  std::vector<camera::View> poor = projected(request, made, 0);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 1);
  for (camera::View& view : poor) {
    for (camera::Sighting& sighting : view.seen) {
      const double sd = sighting.point % 3 == 0 ? 0.2 : 0.004;
      const double down = noise(random), aside = noise(random);
      sighting.at_px += sd * Vector2d(aside, down);
      sighting.covariance = sd * sd * Eigen::Matrix2d::Identity();
    }
  }
  const CalibrateResult found = solved(request, poor, made.views[0]);
  EXPECT_LT(worst_place(found.camera, made.views[0]), 0.05);
  for (std::size_t p = 0; p < kCameraParameters; ++p) {
    const auto parameter = static_cast<P>(p);
    EXPECT_NEAR(found.camera[parameter], made.views[0][parameter],
                4 * std::sqrt(found.camera.variance(parameter)))
        << to_string(parameter);
  }
}

// A lens that bends nothing is not given terms that would bend something.
TEST(Calibrate, FewTermsWhereFewAreThere) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  testing::RandomCalibration made = testing::random_calibration(request, 5, 4);
  for (Camera& view : made.views) {
    for (const P p : {P::kK1, P::kK2, P::kP1, P::kP2, P::kK3}) view[p] = 0;
  }
  const CalibrateResult found = solved(request, projected(request, made, 0.1), made.views[0]);
  EXPECT_LE(found.terms.size(), 5u) << found.terms;  // none, or one or two
  EXPECT_LT(worst_place(found.camera, made.views[0]), 0.4);
}

TEST(Calibrate, ParallelPicturesDoNotTellTheFocalLength) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  testing::RandomCalibration made = testing::random_calibration(request, 4, 3);
  for (Camera& view : made.views) {
    view[P::kRotationX] = view[P::kRotationY] = 0;
    view[P::kRotationZ] = 0.02;
    view[P::kPositionX] = -0.04;
    view[P::kPositionY] = -0.025;
  }
  const CalibrateResult found = solved(request, projected(request, made, 0.05), made.views[0]);
  EXPECT_FALSE(found.camera.focal_length_known);
  EXPECT_FALSE(found.good);
  std::string verdict;
  for (const std::string& line : found.verdict) verdict += line + "\n";
  EXPECT_NE(verdict.find("all pictures are parallel: the focal length is not determined"),
            std::string::npos)
      << verdict;
  // The plane is known all the same.
  const double truth = camera::PlaneView(made.views[0]).metre_per_px();
  EXPECT_NEAR(found.metre_per_px.value, truth, 4 * found.metre_per_px.sd);
  EXPECT_LT(found.metre_per_px.sd, 0.01 * truth);
}

TEST(Calibrate, SaysWhichCornersAreNotCovered) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  const testing::RandomCalibration made = testing::random_calibration(request, 6, 3);
  std::vector<camera::View> views = projected(request, made, 0.05);
  for (camera::View& view : views) {
    std::erase_if(view.seen, [](const camera::Sighting& sighting) {
      return sighting.at_px.x() < 150 || sighting.at_px.y() < 100;
    });
  }
  const CalibrateResult found = solved(request, views, made.views[0]);
  EXPECT_NE(found.verdict.front().find("top left, top right, bottom left): 3 more pictures"),
            std::string::npos)
      << found.verdict.front();
}

TEST(Calibrate, AnUnknownPitchIsPartOfTheScale) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  const testing::RandomCalibration made = testing::random_calibration(request, 8, 3);
  const std::vector<camera::View> views = projected(request, made, 0.02);
  request.pitch_sd_mm = 0.1;  // 1 %
  const CalibrateResult found = solved(request, views, made.views[0]);
  EXPECT_NEAR(found.metre_per_px.sd / found.metre_per_px.value, 0.01, 1e-4);
}

TEST(Calibrate, TwoMarksOfARulerGiveTheScale) {
  CalibrateRequest request;
  request.pictures = {"ruler"};
  request.target = CalibrationTarget::kRuler;
  request.pitch_mm = 50;
  request.pitch_sd_mm = 0.05;
  request.marks = {{10, 20}, {310, 420}};  // 500 px
  request.validate();
  const CalibrateResult found = camera::calibrate_marks(request, "ruler", 640, 480);
  EXPECT_NEAR(found.metre_per_px.value, 1e-4, 1e-12);
  const double expected = 1e-4 * std::hypot(0.001, 0.5 * std::sqrt(2.0) / 500);
  EXPECT_NEAR(found.metre_per_px.sd, expected, 1e-3 * expected);
  EXPECT_FALSE(found.camera.focal_length_known);
  found.camera.validate();
}

TEST(Calibrate, TheDrawingShowsEveryPoint) {
  CalibrateRequest request = request_of(CalibrationTarget::kDots);
  request.dot_mm = 1e-6;
  const testing::RandomCalibration made = testing::random_calibration(request, 6, 3);
  std::vector<camera::View> views = projected(request, made, 0.05);
  views[0].picture = "<first> & plane";
  const std::string svg = camera::draw_residuals(solved(request, views, made.views[0]));
  std::size_t circles = 0;
  for (auto at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) {
    ++circles;
  }
  EXPECT_EQ(circles, 6u * 54u);
  EXPECT_NE(svg.find("&lt;first&gt; &amp; plane"), std::string::npos);
}

TEST(Calibrate, ImpossibleRequestsAreRefused) {
  const CalibrateRequest good = request_of(CalibrationTarget::kCheckerboard);
  good.validate();
  const auto refused = [&](auto change) {
    CalibrateRequest bad = good;
    change(bad);
    EXPECT_THROW(bad.validate(), InvalidArgument);
  };
  refused([](CalibrateRequest& r) { r.pictures.clear(); });
  refused([](CalibrateRequest& r) { r.pitch_mm = 0; });
  refused([](CalibrateRequest& r) { r.pitch_sd_mm = 20; });
  refused([](CalibrateRequest& r) { r.columns = 2; });
  refused([](CalibrateRequest& r) { r.marker_mm = 10; });
  refused([](CalibrateRequest& r) { r.marks = {{1, 2}, {3, 4}}; });
  refused([](CalibrateRequest& r) {
    r.target = CalibrationTarget::kRuler;
    r.marks = {{1, 2}};
  });
  EXPECT_THROW(parse_calibration_target("chess"), InvalidArgument);
  CalibrateRequest other = good;
  other.plane = "nowhere";
  const testing::RandomCalibration made = testing::random_calibration(other, 6, 3);
  EXPECT_THROW(solved(other, projected(other, made, 0.05), made.views[0]), InvalidArgument);
  EXPECT_THROW(solved(good, {{"empty", {}}}, made.views[0]), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
