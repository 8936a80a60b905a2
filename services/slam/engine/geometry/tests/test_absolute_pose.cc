// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "geometry/absolute_pose.h"

namespace kinemap {
namespace {

const CameraModel kCamera(640, 480, 500, 500, 320, 240);
const RigidTransform kCameraFromMap(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized())),
                                    Eigen::Vector3d(0.5, -1, 2));

/// `right` sights with half a pixel of noise, then `wrong` ones that point anywhere.
std::vector<PointSight> Sights(int right, int wrong) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> across(-0.4, 0.4), depth(4, 30), column(0, 640), row(0, 480);
  std::normal_distribution<double> noise(0, 0.5);
  std::vector<PointSight> sights;
  for (int i = 0; i < right + wrong; ++i) {
    const double z = depth(random);
    const Eigen::Vector3d in_camera(across(random) * z, across(random) * z, z);
    Eigen::Vector2d pixel = kCamera.Project(in_camera) + Eigen::Vector2d(noise(random), noise(random));
    if (i >= right) pixel = {column(random), row(random)};
    sights.push_back({kCameraFromMap.Inverse() * in_camera, pixel, 4});
  }
  return sights;
}

TEST(AbsolutePose, IsFoundAmongTwoThirdsOfMistakes) {
  RandomEngine random(0, 1);
  const auto pose = EstimateAbsolutePose(Sights(40, 80), kCamera, {}, &random);
  ASSERT_TRUE(pose);
  EXPECT_GE(pose->inliers, 38);
  EXPECT_LE(pose->inliers, 43);
  EXPECT_LT((pose->camera_from_map.Inverse().translation - kCameraFromMap.Inverse().translation).norm(), 0.2);
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(pose->inlier[i]) << i;
}

TEST(AbsolutePose, IsTheSameForTheSameSeed) {
  RandomEngine one(0, 7), other(0, 7);
  const auto first = EstimateAbsolutePose(Sights(30, 90), kCamera, {}, &one);
  const auto second = EstimateAbsolutePose(Sights(30, 90), kCamera, {}, &other);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->camera_from_map.translation, second->camera_from_map.translation);
  EXPECT_EQ(first->inlier, second->inlier);
}

TEST(AbsolutePose, IsNotFoundWhereThereIsNone) {
  RandomEngine random(0, 1);
  EXPECT_FALSE(EstimateAbsolutePose(Sights(0, 60), kCamera, {}, &random));
  EXPECT_FALSE(EstimateAbsolutePose(Sights(3, 0), kCamera, {}, &random));
  EXPECT_FALSE(EstimateAbsolutePose({}, kCamera, {}, &random));
}

}  // namespace
}  // namespace kinemap
