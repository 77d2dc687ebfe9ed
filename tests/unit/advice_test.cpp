// Noise, texture and checks of single frames against pictures whose figures are known.
#include <gtest/gtest.h>

#include "host/advice/frames/frame_checks.h"
#include "host/advice/texture_advice.h"
#include "host/dic/frame_noise.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

using testing::pose;

SynthScene scene(double noise) {
  SynthScene made;
  made.width = made.height = 200;
  made.noise_sigma = noise;
  return made;
}

Frame picture(const SynthScene& of, const BallPose& at, double radius_px = 80) {
  return testing::render_frames(testing::quick_ball(3, radius_px), of, {at}).front();
}

// Rounding to whole levels adds 1/12 to the variance; speckles cover two fifths of the picture.
TEST(FrameNoise, OfASpeckledBall) {
  for (const double sigma : {1.0, 2.0, 5.0}) {
    const Frame frame = picture(scene(sigma), pose(100, 100, 0));
    const double want = std::sqrt(sigma * sigma + 1.0 / 12);
    EXPECT_NEAR(dic::estimate_noise(frame.to_float().view(), 255), want, 0.06 * want) << sigma;
  }
  const Frame clean = picture(scene(0), pose(100, 100, 0));
  EXPECT_NEAR(dic::estimate_noise(clean.to_float().view(), 255), 1 / std::sqrt(12.0), 1e-12);
}

// Speckles all over, no flat background: noise reads somewhat high, never low.
TEST(FrameNoise, WithoutBackground) {
  const Frame frame = picture(scene(3), pose(100, 100, 0), 160);
  const double found = dic::estimate_noise(frame.to_float().view(), 255);
  EXPECT_GT(found, 0.9 * 3);
  EXPECT_LT(found, 2.0 * 3);
}

TEST(TextureAdvice, ExpectsWhatTheExactPictureAllows) {
  const sim::speckle::SpeckleBall ball = testing::quick_ball(3, 80);
  const sim::speckle::BallRenderer renderer(ball, scene(2));
  Frame frame;
  renderer.render(pose(100, 100, 0), 0, frame);
  const Image<double> exact = renderer.exact(pose(100, 100, 0));
  Image<float> floats(exact.width(), exact.height());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    floats.data()[i] = static_cast<float>(exact.data()[i]);
  }
  const double noise = std::sqrt(4 + 1.0 / 12);
  const BallBound want = dic::PictureSlopes(floats.view(), 0).disc(100, 100, 76, noise);
  advice::TextureRequest request;
  request.circle = Circle{100, 100, 80};
  const TextureAdvice advice = advice::advise_texture(frame, request);
  ASSERT_TRUE(advice.ball.has_value());
  EXPECT_NEAR(advice.ball->dx_sd_px, want.dx_sd_px, 0.08 * want.dx_sd_px);
  EXPECT_NEAR(advice.ball->rot_sd_rad, want.rot_sd_rad, 0.08 * want.rot_sd_rad);
  EXPECT_EQ(advice.asked.usable, advice.asked.windows);
  EXPECT_GT(advice.asked.windows, 100);
  // The size that was asked for stands among the others, too.
  EXPECT_EQ(advice.sizes[2].window_px, advice.asked.window_px);
  EXPECT_EQ(advice.sizes[2].windows, advice.asked.windows);
  EXPECT_EQ(advice.sizes[2].error_px, advice.asked.error_px);
  // Larger windows do better, about as one over their side.
  ASSERT_GE(advice.sizes.size(), 5u);
  EXPECT_NEAR(advice.sizes[2].error_px / advice.sizes[4].error_px, 31.0 / 15, 0.4);
  EXPECT_EQ(window_reaching(advice, advice.sizes[3].error_px), 21);
  EXPECT_EQ(window_reaching(advice, 1e-6), 0);
}

TEST(TextureAdvice, APlainBallHasNoUsableWindow) {
  sim::speckle::SpeckleBall plain;
  plain.radius_px = 80;
  const Frame frame = testing::render_frames(plain, scene(2), {pose(100, 100, 0)}).front();
  advice::TextureRequest request;
  request.circle = Circle{100, 100, 80};
  const TextureAdvice advice = advice::advise_texture(frame, request);
  EXPECT_EQ(advice.asked.usable, 0);
  EXPECT_TRUE(std::isnan(advice.asked.error_px));
}

TEST(FrameChecks, EdgeWidthIsTheLenss) {
  sim::speckle::SpeckleBall plain;
  plain.radius_px = 80;
  for (const double blur : {0.6, 2.0, 4.0}) {
    SynthScene lens = scene(1);
    lens.psf_sigma_px = blur;
    const Frame frame = testing::render_frames(plain, lens, {pose(100.3, 99.6, 0)}).front();
    const auto width = advice::edge_width_px(frame, {100.3, 99.6, 80});
    ASSERT_TRUE(width.has_value());
    // 10 to 90 % of a Gaussian edge are 2.563 σ; the pixel's square adds 1/12 to its variance, and
    // so does interpolating along the ray.
    EXPECT_NEAR(*width, 2.563 * std::sqrt(blur * blur + 2.0 / 12), 0.1 * *width + 0.2) << blur;
  }
}

TEST(FrameChecks, SaturatedShareOfTheBall) {
  Frame frame = picture(scene(0), pose(100, 100, 0));
  EXPECT_EQ(advice::saturated_share(frame, {0, 0, 200, 200}, Circle{100, 100, 80}), 0);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) frame.u8(x, y) = 255;
  }
  EXPECT_NEAR(advice::saturated_share(frame, {0, 0, 200, 200}, Circle{100, 100, 80}), 0.5, 0.01);
  EXPECT_NEAR(advice::saturated_share(frame, {0, 50, 200, 100}, {}), 0.5, 1e-12);
}

TEST(FrameChecks, TurnOfAnySize) {
  const auto frames = testing::render_frames(
      testing::quick_ball(3, 80), scene(2),
      {pose(98, 101, 10), pose(101, 100, 13), pose(101, 100, 100), pose(101, 100, -170)});
  const Circle first{98, 101, 80}, second{101, 100, 80};
  const double want[] = {3, 90, 180};
  for (int k = 0; k < 3; ++k) {
    const auto turn = advice::turn_between_deg(frames[0], first, frames[k + 1], second);
    ASSERT_TRUE(turn.has_value()) << k;
    EXPECT_NEAR(*turn, want[k], 0.6) << k;
  }
  const Frame other =
      testing::render_frames(testing::quick_ball(9, 80), scene(2), {pose(101, 100, 0)}).front();
  EXPECT_FALSE(advice::turn_between_deg(frames[0], first, other, second).has_value());
}

// Beyond the picture's edge there is nothing to compare.
TEST(FrameChecks, TurnOfABallThatThePictureCutsIsNotTold) {
  const auto frames = testing::render_frames(testing::quick_ball(3, 80), scene(2),
                                             {pose(98, 101, 10), pose(98, 40, 13)});
  const Circle whole{98, 101, 80}, cut{98, 40, 80};
  EXPECT_FALSE(advice::turn_between_deg(frames[0], whole, frames[1], cut).has_value());
  EXPECT_FALSE(advice::turn_between_deg(frames[1], cut, frames[0], whole).has_value());
}

Frame woven(const Frame& even, const Frame& odd) {
  Frame frame = even;
  for (int y = 1; y < frame.height(); y += 2) {
    std::copy_n(odd.u8.row(y), frame.width(), frame.u8.row(y));
  }
  return frame;
}

// Fields of one time show the ball at one place, and a turn alone shifts nothing.
TEST(FrameChecks, WovenFieldsAreInterlaced) {
  const Roi region{20, 20, 160, 160};
  for (const unsigned seed : {3U, 4U, 5U}) {
    const auto frames =
        testing::render_frames(testing::quick_ball(seed, 80), scene(2),
                               {pose(98, 101, 0), pose(101, 101, 0), pose(98.3, 100.8, 0.2)});
    EXPECT_FALSE(advice::is_interlaced(frames[0], region)) << seed;
    EXPECT_TRUE(advice::is_interlaced(woven(frames[0], frames[1]), region)) << seed;
    EXPECT_TRUE(advice::is_interlaced(woven(frames[0], frames[2]), region)) << seed;
    EXPECT_FALSE(advice::repeats_pixels(frames[0], region)) << seed;
    EXPECT_FALSE(advice::repeats_pixels(woven(frames[0], frames[1]), region)) << seed;
    // Black bars, as of film in another format, have sharp edges along the rows.
    Frame barred = frames[0];
    for (int y = 0; y < 73; ++y) std::fill_n(barred.u8.row(y), 200, 0);
    EXPECT_FALSE(advice::is_interlaced(barred, region)) << seed;
  }
}

TEST(FrameChecks, EnlargedPicturesRepeatPixels) {
  const Roi region{20, 20, 160, 160};
  const Frame frame =
      testing::render_frames(testing::quick_ball(3, 80), scene(2), {pose(98, 101, 0)})[0];
  Frame enlarged = frame;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) enlarged.u8(x, y) = frame.u8(50 + x / 2, 50 + y / 2);
  }
  EXPECT_TRUE(advice::repeats_pixels(enlarged, region));
  EXPECT_FALSE(advice::is_interlaced(enlarged, region));
}

}  // namespace
}  // namespace impactdic
