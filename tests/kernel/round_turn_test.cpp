// The turns of bodies that are no spheres, rendered at known poses under a lamp.
#include "host/motion/round/round_turn.h"

#include <gtest/gtest.h>
#include <impactdic/clip.h>
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "host/advice/round_advice.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/round/round_body.h"
#include "tests/support/engine.h"

namespace impactdic::motion {
namespace {

using testing::shared_engine;

constexpr int kSide = 231;
constexpr double kRadiusPx = 100;

// An ellipsoid with a texture of waves a quarter of a radius long, before black.
class Body {
 public:
  Body(const Eigen::Vector3d& semi_axes, unsigned seed) : axes_(semi_axes * kRadiusPx) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0, 2 * kPi);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
      waves_.push_back(25 * direction.normalized());
      phases_.push_back(phase(random));
    }
  }

  // Turned from its own axes to the camera's; `bright`: the body's level.
  Frame picture(const Eigen::Quaterniond& turn, double bright = 120) const {
    const Eigen::Matrix3d to_body = turn.toRotationMatrix().transpose();
    const Eigen::Matrix3d inverse = axes_.cwiseInverse().asDiagonal();
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 1);
    Frame frame;
    frame.reset(kSide, kSide, 8);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        // The line of sight in the body's axes, stretched to where the body is a unit sphere.
        const Eigen::Vector3d from =
            inverse * to_body * Eigen::Vector3d(x - kSide / 2, kSide / 2 - y, 0);
        const Eigen::Vector3d along = inverse * to_body * Eigen::Vector3d::UnitZ();
        const double b = from.dot(along) / along.squaredNorm();
        const double root = b * b - (from.squaredNorm() - 1) / along.squaredNorm();
        double level = 0;
        if (root > 0) {
          const Eigen::Vector3d place = from + (std::sqrt(root) - b) * along;
          const Eigen::Vector3d normal = (turn * (inverse * place)).normalized();
          level = (bright + 30 * wave(place)) * (0.4 + 0.6 * normal.z()) + noise(random);
        }
        frame.u8(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
      }
    }
    return frame;
  }

 private:
  double wave(const Eigen::Vector3d& place) const {
    double sum = 0;
    for (std::size_t i = 0; i < waves_.size(); ++i) {
      sum += std::cos(waves_[i].dot(place) + phases_[i]);
    }
    return sum / std::sqrt(0.5 * static_cast<double>(waves_.size()));
  }

  Eigen::Vector3d axes_;
  std::vector<Eigen::Vector3d> waves_;
  std::vector<double> phases_;
};

const Eigen::Vector3d kStep = Eigen::Vector3d(22, 3, -2) * kRadPerDeg;
constexpr int kViews = 12;

std::vector<Frame> views_of(const Body& body) {
  std::vector<Frame> views;
  Eigen::Quaterniond turn = dic::quaternion_of(Eigen::Vector3d(0.4, 0.3, 1.0));
  for (int i = 0; i < kViews; ++i) {
    views.push_back(body.picture(turn));
    turn = dic::quaternion_of(kStep) * turn;
  }
  return views;
}

std::unique_ptr<FrameSource> as_clip(const std::vector<Frame>& views) {
  ClipInfo info;
  info.width = info.height = kSide;
  info.frame_count = static_cast<std::int64_t>(views.size());
  return clip_from_callback(info, [views](std::int64_t index, Frame& frame) {
    frame = views[static_cast<std::size_t>(index)];
  });
}

std::optional<RoundBody> found_in(const std::vector<Frame>& views) {
  const auto clip = as_clip(views);
  return advice::find_round_body(shared_engine(), *clip, {0, kViews, 1}, {0, 0, kSide, kSide});
}

RoundView view_of(const Frame& frame, const RoundBody& body) {
  return round_view(frame, *circle::find_silhouette(frame), body.round());
}

TEST(RoundTurn, TurnsOfASpheroidAreWithinWhatIsStated) {
  const std::vector<Frame> views = views_of(Body({1, 0.83, 1}, 3));
  const auto body = found_in(views);
  ASSERT_TRUE(body);
  EXPECT_NEAR(body->stretch(), 1 / 0.83, 0.03);
  RoundTurn turn(shared_engine(), body->round());
  double squares = 0;
  for (int i = 0; i + 1 < kViews; ++i) {
    const Frame& first = views[static_cast<std::size_t>(i)];
    const Frame& second = views[static_cast<std::size_t>(i) + 1];
    const dic::RigidMotion motion =
        turn.measure(view_of(first, *body), view_of(second, *body), body->light_beside(i, i + 1),
                     {0.3, body->depth_sd()});
    ASSERT_TRUE(motion.ok) << i;
    const Eigen::Vector3d found(motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad);
    const Eigen::Vector3d sd(motion.rot_x_sd_rad, motion.rot_y_sd_rad, motion.rot_sd_rad);
    const Eigen::Vector3d over = (found - kStep).cwiseQuotient(sd);
    EXPECT_LT(over.cwiseAbs().maxCoeff(), 4) << i << ": " << over.transpose();
    squares += over.squaredNorm() / 3 / (kViews - 1);
  }
  RecordProperty("over_stated", std::to_string(std::sqrt(squares)));
  EXPECT_GT(std::sqrt(squares), 0.3);
  EXPECT_LT(std::sqrt(squares), 1.7);
}

TEST(RoundTurn, ViewsWithoutACommonSurfaceHaveNoTurn) {
  const std::vector<Frame> views = views_of(Body({1, 0.83, 1}, 3));
  const std::vector<Frame> others = views_of(Body({1, 0.83, 1}, 4));
  const auto body = found_in(views);
  ASSERT_TRUE(body);
  RoundTurn turn(shared_engine(), body->round());
  for (std::size_t i = 0; i < views.size(); i += 2) {
    const RoundView first = view_of(views[i], *body), second = view_of(others[i], *body);
    EXPECT_FALSE(turn.measure(first, second, {}, {}).ok) << i;
  }
}

TEST(RoundTurn, ABallIsNone) { EXPECT_FALSE(found_in(views_of(Body({1, 1, 1}, 5)))); }

TEST(Silhouette, IsAnEllipseWithItsAxes) {
  const Eigen::Quaterniond turn = dic::quaternion_of(Eigen::Vector3d(0, 0, 30 * kRadPerDeg));
  const auto found = circle::find_silhouette(Body({1, 0.8, 0.9}, 6).picture(turn));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->long_px(), 100, 0.8);
  EXPECT_NEAR(found->short_px(), 80, 0.8);
  EXPECT_NEAR(found->circle.cx_px, kSide / 2, 0.3);
  // Counter-clockwise on the screen, where y points down.
  EXPECT_NEAR(std::atan2(found->e2_px, found->e1_px) / 2, -30 * kRadPerDeg, 0.01);
  EXPECT_LT(found->rim_px, 1);
}

TEST(Silhouette, NothingElseIsOne) {
  Frame frame;
  frame.reset(kSide, kSide, 8);
  std::fill_n(frame.u8.data(), frame.u8.size(), std::uint8_t{20});
  EXPECT_FALSE(circle::find_silhouette(frame)) << "an empty picture";
  for (int y = 60; y < 170; ++y) std::fill_n(frame.u8.row(y) + 50, 130, std::uint8_t{200});
  EXPECT_FALSE(circle::find_silhouette(frame)) << "a rectangle";
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      frame.u8(x, y) = static_cast<std::uint8_t>((7 * x + 13 * y) % 251);
    }
  }
  EXPECT_FALSE(circle::find_silhouette(frame)) << "a background with a texture";
}

}  // namespace
}  // namespace impactdic::motion
