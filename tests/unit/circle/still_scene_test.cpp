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

// A disc that moves by two pixels and a half in all, and beside it, if asked, one that moves far.
std::vector<cv::Mat> slow_disc(bool other_moves) {
  constexpr int kPictures = 12, kShift = 4;  // binary places of a drawn pixel
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 1);
  std::vector<cv::Mat> pictures;
  for (int k = 0; k < kPictures; ++k) {
    cv::Mat picture(120, 240, CV_8U, cv::Scalar(60));
    const cv::Point centre((59 << kShift) + k * 40 / kPictures, 60 << kShift);
    cv::circle(picture, centre, 40 << kShift, cv::Scalar(150), cv::FILLED, cv::LINE_AA, kShift);
    if (other_moves) cv::circle(picture, {130 + 6 * k, 60}, 15, cv::Scalar(200), cv::FILLED);
    picture.convertTo(picture, CV_32F);
    cv::GaussianBlur(picture, picture, {}, 0.8);
    for (float& level : cv::Mat_<float>(picture)) level += noise(random);
    pictures.push_back(picture);
  }
  return pictures;
}

// No ball was found of those that moved by a pixel or two in the whole clip.
TEST(StillScene, WhatAloneMovesIsNotStillHoweverLittle) {
  const Circle slow = {60.2, 60, 40};
  for (const bool other_moves : {false, true}) {
    const std::vector<cv::Mat> pictures = slow_disc(other_moves);
    const auto scene = StillScene::learn(pictures, 1).scene;
    ASSERT_NE(scene, nullptr);
    const cv::Mat moved = scene->compare(pictures[3]);
    EXPECT_TRUE(scene->rests(moved, slow)) << other_moves;
    EXPECT_EQ(scene->is_still(moved, slow, 1), other_moves);
    EXPECT_TRUE(scene->is_still(moved, slow, 0.2)) << other_moves;
  }
}

}  // namespace
}  // namespace impactdic::circle
