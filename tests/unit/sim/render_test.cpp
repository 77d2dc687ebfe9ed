// The renderer against independent quadrature, and against what geometry demands.
#include "sim/speckle/render.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "sim/speckle/blur.h"

namespace impactdic {
namespace {

constexpr double kPi = std::numbers::pi;

// A disc under a Gaussian as a sum over its chords, each a difference of error functions. Shares
// nothing with the product's formula.
double disc_by_chords(double distance, double radius, double sigma,
                      const sim::speckle::Quadrature& rule) {
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double t = kPi * rule.node[i], y = radius * std::sin(t), half = radius * std::cos(t);
    const double density =
        std::exp(-y * y / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * kPi)) * half * kPi;
    const auto cdf = [&](double x) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))); };
    sum += rule.weight[i] * density * (cdf(half - distance) - cdf(-half - distance));
  }
  return sum;
}

// What is asked of it where it is made no farther inwards than is needed.
TEST(BlurredDisc, MadeForThinInkAloneItIsTheSameThere) {
  for (const double radius : {0.4, 1.3, 5.0}) {
    const sim::speckle::BlurredDisc whole(radius, 0.7), outer(radius, 0.7, 0, 0.6);
    for (double at = 0; at < whole.reach_px(); at += 0.01) {
      if (whole(at) <= 0.6) {
        EXPECT_EQ(outer(at), whole(at)) << radius << ' ' << at;
      } else {
        EXPECT_GT(outer(at), 0.6) << radius << ' ' << at;
      }
    }
  }
}

TEST(BlurredDisc, EqualsTheIntegralOverChords) {
  const sim::speckle::Quadrature fine = sim::speckle::gauss_legendre(200),
                                 finest = sim::speckle::gauss_legendre(2000);
  for (const double sigma : {0.3, 0.6, 1.5}) {
    for (const double radius : {0.3, 1.1, 4.0, 9.0, 115.0}) {
      const sim::speckle::BlurredDisc table(radius, sigma);
      for (double d = std::max(0.0, radius - 6 * sigma); d < radius + 6 * sigma; d += 0.07) {
        const double expected = disc_by_chords(d, radius, sigma, radius > 20 ? finest : fine);
        ASSERT_NEAR(table(d), expected, 1e-5) << "r " << radius << " sigma " << sigma << " d " << d;
      }
    }
  }
}

TEST(GaussLegendre, IntegratesPolynomialsExactly) {
  for (int n = 1; n <= 20; ++n) {
    const sim::speckle::Quadrature rule = sim::speckle::gauss_legendre(n);
    double sum = 0, even = 0;
    const int power = 2 * n - 2;
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      sum += rule.weight[i];
      even += rule.weight[i] * std::pow(rule.node[i], power);
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_NEAR(even * (power + 1) * std::pow(2.0, power), 1, 1e-11);
  }
}

TEST(SharedSamples, IntegratePolynomialsExactly) {
  for (const int per_pixel : {3, 4, 5}) {
    const sim::speckle::Quadrature rule = sim::speckle::shared_samples(per_pixel, per_pixel + 6);
    for (int power = 0; power < per_pixel + 6; power += 2) {
      double sum = 0;
      for (std::size_t i = 0; i < rule.node.size(); ++i) {
        sum += rule.weight[i] * std::pow(rule.node[i], power);
      }
      EXPECT_NEAR(sum * (power + 1) * std::pow(2.0, power), 1, 1e-11);
    }
  }
}

// One point of the model, straight from its definition in render.h.
class Model {
 public:
  Model(const sim::speckle::SpeckleBall& ball, const SynthScene& scene, const BallPose& pose)
      : ball_(ball), scene_(scene), pose_(pose) {}

  // Mean over the pixel's square by a rule far finer than the renderer's.
  double pixel(int x, int y) const {
    static const sim::speckle::Quadrature rule = sim::speckle::gauss_legendre(8);
    double sum = 0;
    for (std::size_t j = 0; j < rule.node.size(); ++j) {
      for (std::size_t i = 0; i < rule.node.size(); ++i) {
        sum += rule.weight[i] * rule.weight[j] * at(x + rule.node[i], y + rule.node[j]);
      }
    }
    return sum;
  }

 private:
  double at(double x, double y) const {
    const double c = pose_.compression;
    double value = 0;
    if (c == 0) {
      value = ball_at(x, y);
    } else {
      // The lens's blur that the compression took away, by the trapezoidal rule over ± 6 σ.
      const double lost = scene_.psf_sigma_px * std::sqrt(1 - (1 - c) * (1 - c));
      const double angle = pose_.compression_axis_deg * kPi / 180;
      double weights = 0;
      for (int i = -24; i <= 24; ++i) {
        const double t = i / 4.0, w = std::exp(-t * t / 2);
        value += w * ball_at(x - t * lost * std::cos(angle), y + t * lost * std::sin(angle));
        weights += w;
      }
      value /= weights;
    }
    if (scene_.bar) {
      const OccludingBar& bar = *scene_.bar;
      const double angle = bar.angle_deg * kPi / 180;
      const double n = (y - bar.y_px) * std::cos(angle) + (x - bar.x_px) * std::sin(angle);
      const double covered = edge(bar.width_px / 2 - n) - edge(-bar.width_px / 2 - n);
      value += covered * (bar.level - value);
    }
    return value;
  }

  double ball_at(double x, double y) const {
    const double angle = pose_.angle_deg * kPi / 180;
    const double axis = pose_.compression_axis_deg * kPi / 180;
    double u = x - pose_.cx_px, v = y - pose_.cy_px;
    const double px = u, py = v;  // shading is a matter of the screen
    const double along = u * std::cos(axis) - v * std::sin(axis);
    const double stretch = along * (1 / (1 - pose_.compression) - 1);
    u += stretch * std::cos(axis);
    v -= stretch * std::sin(axis);
    const double bx = u * std::cos(angle) - v * std::sin(angle);
    const double by = u * std::sin(angle) + v * std::cos(angle);
    double clear = 1;
    for (const sim::speckle::InkDisc& d : ball_.discs) {
      const double away = std::hypot(bx - d.x_px, by - d.y_px);
      if (away > d.radius_px + 6 * scene_.psf_sigma_px) continue;
      clear *= 1 - disc_by_chords(away, d.radius_px, scene_.psf_sigma_px, chords_);
    }
    for (const sim::speckle::InkLine& l : ball_.lines) {
      const double a = l.angle_deg * kPi / 180, dx = bx - l.x_px, dy = by - l.y_px;
      const double t = dx * std::cos(a) - dy * std::sin(a);
      const double n = dx * std::sin(a) + dy * std::cos(a);
      clear *= 1 - (edge(l.width_px / 2 - n) - edge(-l.width_px / 2 - n)) *
                       (edge(l.length_px / 2 - t) - edge(-l.length_px / 2 - t));
    }
    const double rim = std::hypot(bx, by);
    double covered = rim < ball_.radius_px - 6 * scene_.psf_sigma_px ? 1 : 0;
    if (covered == 0 && rim < ball_.radius_px + 6 * scene_.psf_sigma_px) {
      covered =
          sim::speckle::BlurredDisc(ball_.radius_px, scene_.psf_sigma_px)(rim);  // tested above
    }
    const double lamp = scene_.lamp_deg * kPi / 180;
    const double facing = (px * std::cos(lamp) - py * std::sin(lamp)) / ball_.radius_px;
    const double light = 1 - scene_.shading * (1 - facing) / 2;
    const double surface = light * (scene_.ink + (scene_.white - scene_.ink) * clear);
    return scene_.background + covered * (surface - scene_.background);
  }

  double edge(double into) const {
    return 0.5 * std::erfc(-into / (scene_.psf_sigma_px * std::sqrt(2.0)));
  }

  const sim::speckle::SpeckleBall& ball_;
  const SynthScene& scene_;
  BallPose pose_;
  sim::speckle::Quadrature chords_ = sim::speckle::gauss_legendre(64);
};

// Largest difference from the model over pixels scattered on the ball and along its rim.
double worst_pixel(const sim::speckle::SpeckleBall& ball, const SynthScene& scene,
                   const BallPose& pose, int count) {
  const Image<double> picture = sim::speckle::BallRenderer(ball, scene).exact(pose);
  const Model model(ball, scene, pose);
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    // Sunflower spiral, out to just beyond the rim; each third pixel on the rim itself.
    const double away =
        i % 3 == 0 ? ball.radius_px : (ball.radius_px + 3) * std::sqrt((i + 0.5) / count);
    const int x = static_cast<int>(std::lround(pose.cx_px + away * std::cos(2.39996 * i)));
    const int y = static_cast<int>(std::lround(pose.cy_px + away * std::sin(2.39996 * i)));
    worst = std::max(worst, std::abs(picture(x, y) - model.pixel(x, y)));
  }
  return worst;
}

constexpr double kQuadratureBound = 0.01;  // grey levels: what render.h promises

TEST(Render, WithinAHundredthGreyLevelOfFinerQuadratureForEveryLens) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("e1", 5, 60);
  for (const double sigma : {0.3, 0.42, 0.55, 0.6, 1.0}) {
    SynthScene scene;
    scene.width = scene.height = 141;
    scene.psf_sigma_px = sigma;
    EXPECT_LE(worst_pixel(ball, scene, {70.3, 69.6, 33}, 240), kQuadratureBound) << sigma;
  }
}

TEST(Render, WithinAHundredthGreyLevelWithLinesShadingAndBar) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("f2", 6, 60);
  SynthScene scene;
  scene.width = scene.height = 141;
  scene.shading = 0.6;
  scene.bar = sim::speckle::bar_hiding(0.3, {70, 70}, 60);
  scene.bar->angle_deg = 8;
  EXPECT_LE(worst_pixel(ball, scene, {70.71, 69.13, -71}, 300), kQuadratureBound);
}

TEST(Render, WithinAHundredthGreyLevelWhileCompressed) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("f1", 7, 40);
  SynthScene scene;
  scene.width = scene.height = 101;
  for (const double compression : {0.01, 0.05, 0.15}) {
    EXPECT_LE(worst_pixel(ball, scene, {50.2, 49.9, 20, compression, 75}, 60), kQuadratureBound)
        << compression;
  }
}

// The light of a plain ball: its sum and its centroid are known without any quadrature.
TEST(Render, LightOfAPlainBallHasItsAreaAndCentre) {
  SynthScene scene;
  scene.width = scene.height = 160;
  for (const double compression : {0.0, 0.1}) {
    const BallPose pose{79.37, 80.61, 12, compression, 90};
    const Image<double> picture =
        sim::speckle::BallRenderer(sim::speckle::SpeckleBall{60, {}, {}}, scene).exact(pose);
    double sum = 0, sx = 0, sy = 0, syy = 0;
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 160; ++x) {
        const double light = picture(x, y) - scene.background;
        sum += light;
        sx += light * x;
        sy += light * y;
        syy += light * (y - pose.cy_px) * (y - pose.cy_px);
      }
    }
    const double area = kPi * 60 * 60 * (1 - compression);
    EXPECT_NEAR(sum / (scene.white - scene.background) / area, 1, 1e-5);
    EXPECT_NEAR(sx / sum, pose.cx_px, 1e-5);
    EXPECT_NEAR(sy / sum, pose.cy_px, 1e-5);
    // Second moment: ellipse, lens and pixel square add up.
    const double half_axis = 60 * (1 - compression);
    EXPECT_NEAR(syy / sum, half_axis * half_axis / 4 + 0.36 + 1.0 / 12, 0.01);
  }
}

TEST(Render, PositiveRotationIsCounterClockwiseOnTheScreen) {
  const sim::speckle::SpeckleBall ball{50, {{30, 0, 5}}, {{0, 0, 0, 40, 2}}};
  SynthScene scene;
  scene.width = scene.height = 121;
  const sim::speckle::BallRenderer renderer(ball, scene);
  EXPECT_NEAR(renderer.exact(BallPose{60, 60, 0})(90, 60), scene.ink, 0.01);
  const Image<double> turned = renderer.exact(BallPose{60, 60, 90});
  EXPECT_NEAR(turned(60, 30), scene.ink, 0.01);
  EXPECT_NEAR(turned(90, 60), scene.white, 0.01);
  // A line from the centre to the right goes up to the right after 45 degrees.
  EXPECT_LT(renderer.exact(BallPose{60, 60, 45})(70, 50), 80);
}

TEST(Render, WholePixelMotionMovesThePictureExactly) {
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e2", 3, 40),
                                            {.width = 128, .height = 128});
  const Image<double> here = renderer.exact(BallPose{60.3, 61.8, 17});
  const Image<double> there = renderer.exact(BallPose{65.3, 58.8, 17});
  double worst = 0;
  for (int y = 10; y < 118; ++y) {
    for (int x = 10; x < 118; ++x) {
      worst = std::max(worst, std::abs(here(x, y) - there(x + 5, y - 3)));
    }
  }
  EXPECT_LT(worst, 1e-4);  // float tables at positions that differ by rounding
}

TEST(Render, ExposureIsTheMeanOverTheShutter) {
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("f2", 3, 40),
                                            {.width = 128, .height = 128});
  const std::vector<BallPose> poses =
      sim::speckle::constant_motion({{60.3, 61.8, 5}, 3.1, -1.7, 2.5}, 3);
  const Image<double> blurred = renderer.exact(sim::speckle::shutter_path(poses, 1, 0.8));
  Image<double> mean(128, 128, 0);
  const int instants = 400;
  for (int i = 0; i < instants; ++i) {
    const double t = 1 + 0.8 * ((i + 0.5) / instants - 0.5);
    const Image<double> one = renderer.exact(BallPose{60.3 + 3.1 * t, 61.8 - 1.7 * t, 5 + 2.5 * t});
    for (std::size_t k = 0; k < mean.size(); ++k) mean.data()[k] += one.data()[k] / instants;
  }
  double worst = 0;
  for (std::size_t k = 0; k < mean.size(); ++k) {
    worst = std::max(worst, std::abs(mean.data()[k] - blurred.data()[k]));
  }
  EXPECT_LE(worst, kQuadratureBound);
}

TEST(Render, BarHidesTheStatedShareOfTheBall) {
  const BallPose pose{100.4, 99.2};
  for (const double share : {0.1, 0.3, 0.5, 0.8}) {
    SynthScene scene;
    scene.width = scene.height = 201;
    scene.bar = sim::speckle::bar_hiding(share, pose, 70);
    scene.bar->level = scene.background;  // so that only the ball is bright
    const Image<double> picture =
        sim::speckle::BallRenderer(sim::speckle::SpeckleBall{70, {}, {}}, scene).exact(pose);
    double light = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) light += picture.data()[i] - 30;
    EXPECT_NEAR(light / 170 / (kPi * 70 * 70), 1 - share, 1e-4);
  }
}

TEST(Render, BarAndBackgroundStandStillWithoutTheBall) {
  SynthScene scene;
  scene.bar = OccludingBar{256, 400, 0, 40, 90};
  const Image<double> picture =
      sim::speckle::BallRenderer(sim::speckle::SpeckleBall{}, scene).exact(BallPose{-500, -500});
  EXPECT_NEAR(picture(10, 400), 90, 1e-9);
  EXPECT_NEAR(picture(10, 300), 30, 1e-9);
}

TEST(Render, ShadingFollowsTheCentreAndDoesNotTurn) {
  SynthScene scene;
  scene.width = scene.height = 128;
  scene.shading = 0.5;
  scene.lamp_deg = 90;  // above
  const sim::speckle::BallRenderer renderer(sim::speckle::SpeckleBall{50, {}, {}}, scene);
  for (const double angle : {0.0, 77.0}) {
    const Image<double> picture = renderer.exact(BallPose{64, 66, angle});
    EXPECT_NEAR(picture(64, 66), 200 * 0.75, 0.01);
    EXPECT_NEAR(picture(64, 26), 200 * (0.75 + 0.25 * 40 / 50), 0.01);
    EXPECT_NEAR(picture(64, 106), 200 * (0.75 - 0.25 * 40 / 50), 0.01);
    EXPECT_NEAR(picture(104, 66), 200 * 0.75, 0.01);
  }
}

TEST(Render, FramesDoNotDependOnTheNumberOfThreads) {
  SynthScene scene;
  scene.width = scene.height = 200;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e1", 4, 70), scene);
  const auto frame_with = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    Frame frame;
    renderer.render(BallPose{99.5, 101.2, 10}, 7, frame);
    return std::vector<std::uint8_t>(frame.u8.data(), frame.u8.data() + frame.u8.size());
  };
  EXPECT_EQ(frame_with(1), frame_with(4));
}

TEST(Render, DeeperFramesHoldTheSameGreyLevels) {
  SynthScene scene;
  scene.width = scene.height = 120;
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("c2", 1, 50);
  const Image<double> exact = sim::speckle::BallRenderer(ball, scene).exact(BallPose{60, 60});
  for (const int bits : {8, 10, 12, 16}) {
    scene.bits = bits;
    Frame frame;
    sim::speckle::BallRenderer(ball, scene).render(BallPose{60, 60}, 0, frame);
    ASSERT_EQ(frame.bits, bits);
    const Image<float> levels = frame.to_float();
    const double scale = frame.full_scale() / 255;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      ASSERT_NEAR(levels.data()[i], exact.data()[i] * scale, 0.501);
    }
  }
}

TEST(Render, RefusesImpossibleScenes) {
  const auto refused = [](auto change) {
    SynthScene scene;
    change(scene);
    EXPECT_THROW(sim::speckle::BallRenderer(sim::speckle::SpeckleBall{}, scene), InvalidArgument);
  };
  refused([](SynthScene& s) { s.psf_sigma_px = 0.1; });
  refused([](SynthScene& s) { s.bits = 7; });
  refused([](SynthScene& s) { s.width = 0; });
  refused([](SynthScene& s) { s.shading = 1.5; });
  refused([](SynthScene& s) { s.white = 300; });
  refused([](SynthScene& s) { s.noise_sigma = -1; });
  refused([](SynthScene& s) { s.fixed_noise_sigma = -1; });
  const sim::speckle::BallRenderer renderer(sim::speckle::SpeckleBall{}, SynthScene{});
  EXPECT_THROW(renderer.exact(BallPose{256, 256, 0, 0.7}), InvalidArgument);
  EXPECT_THROW(sim::speckle::bar_hiding(1.2, BallPose{}, 100), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
