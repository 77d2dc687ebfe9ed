// What stands still, in pictures made by hand.
#include "host/circle/scene/still_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace impactdic::circle {
namespace {

// A disc that moves by 5 px a picture before a background of 60, as bright as `light` says.
template <typename Light>
std::vector<cv::Mat> moving_disc(const Light& light) {
  constexpr int kPictures = 24;
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 1);
  std::vector<cv::Mat> pictures;
  for (int k = 0; k < kPictures; ++k) {
    cv::Mat picture(120, 240, CV_32F, cv::Scalar(60));
    cv::circle(picture, {50 + 5 * k, 60}, 20, cv::Scalar(150), cv::FILLED);
    picture *= light(k);
    for (float& level : cv::Mat_<float>(picture)) level += noise(random);
    pictures.push_back(picture);
  }
  return pictures;
}

void expect_disc_moves(const std::vector<cv::Mat>& pictures) {
  const auto scene = StillScene::learn(pictures, 1).scene;
  ASSERT_NE(scene, nullptr);
  for (std::size_t k = 0; k < pictures.size(); k += 23) {
    const cv::Mat moved = scene->compare(pictures[k]);
    const double x = 50 + 5.0 * static_cast<double>(k);
    EXPECT_GT(scene->moved_share(moved, {x, 60, 19}), 0.9) << k;
    EXPECT_LT(scene->moved_share(moved, {x, 20, 15}), 0.02) << k;
  }
}

TEST(StillScene, ADiscMoves) {
  expect_disc_moves(moving_disc([](int) { return 1.0; }));
}

// The background's change was taken for noise, behind which no disc moved.
TEST(StillScene, ADiscMovesWhileTheLightDims) {
  expect_disc_moves(moving_disc([](int k) { return 1 - 0.5 * k / 23; }));
}

}  // namespace
}  // namespace impactdic::circle
