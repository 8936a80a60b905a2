// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/sim3_alignment.h"
#include "geometry/sim3_ransac.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::TestCamera;

const SimilarityTransform kTruth(RotationFromVector({0.2, -0.4, 0.1}), {1, -2, 0.5}, 1.7);

double Difference(const SimilarityTransform& a, const SimilarityTransform& b) {
  return a.rotation.angularDistance(b.rotation) + (a.translation - b.translation).norm() + std::abs(a.scale - b.scale);
}

/// Points that both cameras see, the second by `first_from_second`.
std::vector<PointPair> Pairs(const SimilarityTransform& first_from_second, int count) {
  const synthetic::Scene scene(count, 2, 6, 12);
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point : scene.points()) {
    PointPair pair{point, first_from_second.Inverse() * point, {}, {}, 1, 1};
    pair.first_px = TestCamera().Project(pair.in_first);
    pair.second_px = TestCamera().Project(pair.in_second);
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(AlignPoints, FindsTheSimilarityAndNeedsThreePointsOffALine) {
  const synthetic::Scene scene(10, 3, 2, 9);
  std::vector<Eigen::Vector3d> target;
  for (const Eigen::Vector3d& point : scene.points()) target.push_back(kTruth * point);
  EXPECT_LT(Difference(*AlignPoints(scene.points(), target, false), kTruth), 1e-9);
  EXPECT_EQ(AlignPoints(scene.points(), target, true)->scale, 1.0);
  EXPECT_LT(AlignPoints(scene.points(), target, true)->rotation.angularDistance(kTruth.rotation), 1e-7);
  const std::vector<Eigen::Vector3d> line = {{0, 0, 1}, {0, 0, 2}, {0, 0, 4}, {0, 0, 5}};
  EXPECT_FALSE(AlignPoints(line, line, false));
  EXPECT_FALSE(AlignPoints({{0, 0, 1}, {1, 0, 2}}, {{0, 0, 1}, {1, 0, 2}}, false));
}

TEST(AlignPoints, NeverMirrors) {
  // In a plane the mirrored fit is as good, so that the sign of the third axis decides.
  const std::vector<Eigen::Vector3d> plane = {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {2, 3, 5}};
  std::vector<Eigen::Vector3d> turned;
  for (const Eigen::Vector3d& point : plane) turned.push_back(kTruth * point);
  EXPECT_LT(Difference(*AlignPoints(plane, turned, false), kTruth), 1e-9);
}

TEST(EstimateSim3, FindsTheSimilarityAmongWrongPairs) {
  const SimilarityTransform truth(RotationFromVector({0.02, -0.1, 0.03}), {0.4, -0.1, 0.3}, 1.2);
  std::vector<PointPair> pairs = Pairs(truth, 80);
  for (size_t i = 0; i < 30; ++i) {
    pairs[i].in_second = pairs[79 - i].in_second;
    pairs[i].second_px = pairs[79 - i].second_px;
  }
  RandomEngine one(1, 2), two(1, 2);
  const auto first = EstimateSim3(TestCamera(), pairs, {}, one), second = EstimateSim3(TestCamera(), pairs, {}, two);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->inliers, 50);
  EXPECT_LT(Difference(first->first_from_second, truth), 1e-6);
  EXPECT_EQ(Difference(first->first_from_second, second->first_from_second), 0.0);
}

TEST(EstimateSim3, RefusesPairsThatAgreeOnNothing) {
  const std::vector<PointPair> pairs = Pairs(kTruth, 60);
  std::vector<PointPair> shuffled = pairs;
  for (size_t i = 0; i < pairs.size(); ++i) {
    shuffled[i].in_second = pairs[(i * 7 + 13) % 60].in_second;
    shuffled[i].second_px = pairs[(i * 7 + 13) % 60].second_px;
  }
  RandomEngine random(3, 4);
  EXPECT_FALSE(EstimateSim3(TestCamera(), shuffled, {}, random));
  EXPECT_FALSE(EstimateSim3(TestCamera(), {pairs.begin(), pairs.begin() + 10}, {}, random));
}

}  // namespace
}  // namespace kinemap
