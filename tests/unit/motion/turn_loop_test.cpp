// What a closed turn makes of a chain of keyframes, against chains that were made with errors.
#include "host/motion/pose/turn_loop.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "host/dic/sphere/rotation.h"
#include "host/motion/pose/body_motion.h"
#include "host/sphere/source_response.h"

namespace impactdic::motion {
namespace {

using Eigen::Quaterniond, Eigen::Vector2d, Eigen::Vector3d;
using Vector5 = Eigen::Matrix<double, 5, 1>;

constexpr double kRadiusPx = 115;
constexpr int kKeys = 60;
constexpr double kShiftPx = 0.0017, kTurn = 2e-5;  // noise of a registration, a third about Z
constexpr double kOwn = 0.05;                      // of its variance what is no picture's

Vector5 noise_sd() { return (Vector5() << kShiftPx, kShiftPx, kTurn, kTurn, kTurn / 3).finished(); }

// A chain of keyframes of a ball that turns once, as registrations with wrong circles and a wrong
// radius see it.
struct Chain {
  std::vector<Keyframe> keyframes;
  std::vector<ChainLink> links;
  std::vector<Quaterniond> truth;
  std::vector<Vector2d> off;  // of the circles
  SphereRadius radius{kRadiusPx, 0.02};
  double radius_error = 0;
};

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  Chain chain() {
    Chain made;
    made.radius_error = 0.02 * normal();
    const Vector3d axis = Vector3d(normal(), normal(), normal()).normalized();
    Vector2d off = 0.01 * Vector2d(normal(), normal());
    for (int k = 0; k <= kKeys + 2; ++k) {
      // What neighbours have in common, ink of which both show.
      off = 0.3 * off + 0.0095 * Vector2d(normal(), normal());
      made.off.push_back(off);
      // Behind the last keyframe two frames, of which the second one is found against the first.
      const double turned = k <= kKeys ? k : kKeys + 0.3 * (k - kKeys);
      made.truth.push_back(dic::quaternion_of(turned * 2 * kPi / (kKeys + 0.4) * axis));
      const Circle circle{150 + 0.3 * turned + made.off.back().x(),
                          140 - 0.2 * turned + made.off.back().y(), kRadiusPx};
      circles_.push_back(circle);
      noise_.push_back(noise_of(0.5));
    }
    for (int k = 0; k < kKeys; ++k) {
      Keyframe& key = made.keyframes.emplace_back();
      key.pose.ok = true;
      key.pose.keyframe = k;
      key.circle = circles_[static_cast<std::size_t>(k)];
      key.circle_sd_px = key.off_sd_px = 0.0065;  // which counts twice
      key.anchored = k == 0;
      key.along_rad = k * 2 * kPi / kKeys;
      key.pose.angle_rad = kNotMeasured;
      if (k == 0) {
        set_orientation(key.pose, Quaterniond::Identity());
        continue;
      }
      const ChainStep step = seen(made, k - 1, k);
      made.links.push_back(ChainLinkMaker(made.radius).first(step).link(k - 1, k, covariance()));
      const Vector3d turn(made.links.back().turn_rad.data());
      set_orientation(key.pose,
                      dic::quaternion_of(turn) *
                          orientation(made.keyframes[static_cast<std::size_t>(k) - 1].pose));
    }
    return made;
  }

  // From the last keyframe by two frames to the first one.
  ChainLink closing(const Chain& chain) {
    return ChainLinkMaker(chain.radius)
        .first(seen(chain, kKeys - 1, kKeys))
        .next(seen(chain, kKeys, kKeys + 1))
        .back(seen(chain, 0, kKeys + 1))
        .link(kKeys - 1, 0, covariance());
  }

  static std::array<double, 15> covariance() {
    std::array<double, 15> lower{};
    for (std::size_t row = 0, at = 0; row < 5; at += ++row) {
      lower[at + row] = std::pow(noise_sd()[static_cast<Eigen::Index>(row)], 2);
    }
    return lower;
  }

 private:
  double normal() { return normal_(random_); }
  Vector5 noise_of(double share) {
    Vector5 noise;
    for (int i = 0; i < 5; ++i) noise[i] = std::sqrt(share) * noise_sd()[i] * normal();
    return noise;
  }

  ChainStep seen(const Chain& chain, int from, int to) {
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    const Vector3d turn = dic::rotation_vector(chain.truth[b] * chain.truth[a].conjugate());
    const auto response =
        sphere::source_response({{turn.x(), turn.y(), turn.z()}, kRadiusPx, {}, {}});
    Vector5 error = noise_[b] - noise_[a] + noise_of(kOwn);
    const std::array<double, 3> sources = {chain.off[a].x(), chain.off[a].y(), chain.radius_error};
    for (std::size_t k = 0; k < 3; ++k) {
      error += sources[k] * (Vector5() << response.dx[k], response.dy[k], response.rot_x[k],
                             response.rot_y[k], response.rot_z[k])
                                .finished();
    }
    ChainStep step;
    step.circle = circles_[a];
    const Vector3d measured = dic::rotation_vector(dic::quaternion_of(Vector3d(error.tail<3>())) *
                                                   dic::quaternion_of(turn));
    const Vector2d moved =
        Vector2d(circles_[b].cx_px - circles_[a].cx_px, circles_[b].cy_px - circles_[a].cy_px) -
        chain.off[b] + chain.off[a];
    step.motion.dx_px = moved.x() + error[0];
    step.motion.dy_px = moved.y() + error[1];
    step.motion.rot_x_rad = measured.x();
    step.motion.rot_y_rad = measured.y();
    step.motion.rot_rad = measured.z();
    return step;
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<Circle> circles_;
  std::vector<Vector5> noise_;
};

Vector3d off_truth(const Chain& chain, std::size_t k) {
  return dic::rotation_vector(orientation(chain.keyframes[k].pose) * chain.truth[k].conjugate());
}

TEST(TurnLoop, KeyframesAreAsGoodAsIsStated) {
  constexpr unsigned kChains = 60;
  double before = 0, after = 0, over = 0, circles = 0, told = 0, told_over = 0, radius_over = 0;
  for (unsigned seed = 1; seed <= kChains; ++seed) {
    Maker maker(seed);
    Chain chain = maker.chain();
    chain.links.push_back(maker.closing(chain));
    const auto loop = TurnLoop::of(chain.keyframes, chain.links, chain.radius);
    ASSERT_TRUE(loop);
    for (std::size_t k = 1; k < kKeys; ++k) {
      Keyframe& key = chain.keyframes[k];
      before += off_truth(chain, k).squaredNorm();
      loop->correct(key);
      const Vector3d error = off_truth(chain, k);
      after += error.squaredNorm();
      // The picture's own noise, and that of the first one, which links in a row do not add up.
      const Eigen::Vector3d variance = Eigen::Matrix3d(key.pose.turn_noise_rad2.data()).diagonal() +
                                       noise_sd().tail<3>().cwiseAbs2();
      over += (error.array().square() / variance.array()).mean();
      const Vector2d wrong = Vector2d(key.off_px[0], key.off_px[1]) - chain.off[k];
      circles += chain.off[k].squaredNorm();
      told += wrong.squaredNorm();
      told_over += wrong.squaredNorm() / (2 * key.off_sd_px * key.off_sd_px);
    }
    radius_over +=
        std::pow((loop->radius().error_px - chain.radius_error) / loop->radius().sd_px, 2);
  }
  const double all = kChains * (kKeys - 1);
  std::printf(
      "turns %.2g -> %.2g rad, over stated %.2f; circles %.4f -> %.4f px, over stated %.2f; "
      "radius over stated %.2f\n",
      std::sqrt(before / all), std::sqrt(after / all), std::sqrt(over / all),
      std::sqrt(circles / all / 2), std::sqrt(told / all / 2), std::sqrt(told_over / all),
      std::sqrt(radius_over / kChains));
  EXPECT_LT(after, 0.05 * before);
  EXPECT_LT(std::sqrt(after / all / 3), 3e-5);  // what two registrations err by
  EXPECT_NEAR(std::sqrt(over / all), 1, 0.25);
  EXPECT_LT(told, 0.25 * circles);
  EXPECT_NEAR(std::sqrt(told_over / all), 1, 0.4);
  EXPECT_NEAR(std::sqrt(radius_over / kChains), 1, 0.3);
}

// A ball that was hit in between, another ball.
TEST(TurnLoop, WhatErrorsDoNotExplainClosesNothing) {
  Maker maker(3);
  Chain chain = maker.chain();
  ChainLink link = maker.closing(chain);
  link.turn_rad[1] += 0.05;
  chain.links.push_back(link);
  EXPECT_FALSE(TurnLoop::of(chain.keyframes, chain.links, chain.radius));
}

TEST(TurnLoop, ATurnClosesOnce) {
  Maker maker(5);
  Chain chain = maker.chain();
  EXPECT_FALSE(is_far(chain.keyframes, chain.links, 3, 4));
  EXPECT_TRUE(is_far(chain.keyframes, chain.links, kKeys - 1, 0));
  chain.links.push_back(maker.closing(chain));
  EXPECT_FALSE(is_far(chain.keyframes, chain.links, kKeys - 1, 0));
  EXPECT_FALSE(is_far(chain.keyframes, chain.links, kKeys - 2, 2));
  EXPECT_TRUE(is_far(chain.keyframes, chain.links, 0, kKeys / 2));
}

// A keyframe that goes away leaves those that it was linked with where they are, and what the
// closed turn told of them holds without it.
TEST(TurnLoop, WhatWasLearntOutlivesAKeyframe) {
  Maker maker(7);
  Chain chain = maker.chain();
  chain.links.push_back(maker.closing(chain));
  auto loop = TurnLoop::of(chain.keyframes, chain.links, chain.radius);
  ASSERT_TRUE(loop);
  for (Keyframe& key : chain.keyframes) loop->correct(key);
  chain.radius = loop->radius();
  const std::vector<Keyframe> known = chain.keyframes;
  unlink(0, chain.keyframes, chain.links);
  chain.keyframes.erase(chain.keyframes.begin());
  chain.truth.erase(chain.truth.begin());
  EXPECT_EQ(chain.links.size(), kKeys - 2U);
  EXPECT_TRUE(chain.keyframes.front().anchored);
  EXPECT_TRUE(chain.keyframes.back().anchored);
  EXPECT_FALSE(chain.keyframes[kKeys / 2].anchored);
  EXPECT_FALSE(is_far(chain.keyframes, chain.links, kKeys - 1, 1));
  loop = TurnLoop::of(chain.keyframes, chain.links, chain.radius);
  ASSERT_TRUE(loop);
  for (std::size_t k = 0; k < chain.keyframes.size(); ++k) {
    loop->correct(chain.keyframes[k]);
    const Vector3d moved =
        dic::rotation_vector(turn_between(chain.keyframes[k].pose, known[k + 1].pose));
    const Eigen::Matrix3d noise(known[k + 1].pose.turn_noise_rad2.data());
    EXPECT_LT(moved.norm(), 0.5 * std::sqrt(noise.trace())) << k;
  }
}

}  // namespace
}  // namespace impactdic::motion
