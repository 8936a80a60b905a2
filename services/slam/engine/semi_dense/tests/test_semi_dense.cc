// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "semi_dense/epipolar_search.h"
#include "semi_dense/gradient_pixels.h"
#include "semi_dense/hypothesis_fusion.h"
#include "semi_dense/inter_keyframe_check.h"
#include "semi_dense/intra_keyframe_check.h"
#include "semi_dense/landmark_range.h"
#include "semi_dense/semi_dense_mapper.h"
#include "semi_dense/tests/textured_scene.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

const CameraModel kCamera(320, 240, 250, 250, 160, 120);
const synthetic::TexturedWall kWall(5, 0.3);

RigidTransform MapFromCamera(double x, double z = 0, double yaw_rad = 0) {
  return synthetic::CameraAt({x, 0, z}, yaw_rad).Inverse();
}

SimilarityTransform OtherFromOwn(const RigidTransform& map_from_other, const RigidTransform& map_from_own) {
  return SimilarityTransform(map_from_other.Inverse() * map_from_own);
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

class EpipolarSearchOnWall : public testing::TestWithParam<RigidTransform> {};

TEST_P(EpipolarSearchOnWall, FindsTheDepthOfMostPixels) {
  const RigidTransform map_from_own = MapFromCamera(0), map_from_other = GetParam();
  const KeyframeView own = kWall.View(kCamera, map_from_own, 0), other = kWall.View(kCamera, map_from_other, 1);
  const EpipolarSearch search({}, kCamera, own, other, OtherFromOwn(map_from_other, map_from_own));
  const std::vector<cv::Point> pixels = FindGradientPixels(own, 8, 100000, 4);
  ASSERT_GT(pixels.size(), 10000u);
  std::vector<double> errors, sigmas_off;
  for (const cv::Point& pixel : pixels) {
    const auto found = search.Find(pixel.x, pixel.y, own.range);
    if (!found) continue;
    const double truth = 1 / kWall.DepthAt(kCamera, map_from_own, pixel.x, pixel.y);
    errors.push_back(std::abs(found->value - truth) / truth);
    sigmas_off.push_back(std::abs(found->value - truth) / found->sigma);
  }
  EXPECT_GT(errors.size(), 0.4 * static_cast<double>(pixels.size()));
  EXPECT_LT(Median(errors), 0.005);
  EXPECT_LT(Median(sigmas_off), 1);
}

INSTANTIATE_TEST_SUITE_P(Motions, EpipolarSearchOnWall,
                         testing::Values(MapFromCamera(0.3), MapFromCamera(-0.3), MapFromCamera(0.1, 0.8),
                                         MapFromCamera(0.3, 0.2, 0.05)));

TEST(EpipolarSearch, GivesDepthInTheUnitsOfItsOwnAnchor) {
  const RigidTransform map_from_own = MapFromCamera(0), map_from_other = MapFromCamera(0.3);
  KeyframeView own = kWall.View(kCamera, map_from_own, 0);
  own.range = {own.range.farthest * 2, own.range.nearest * 2};
  const KeyframeView other = kWall.View(kCamera, map_from_other, 1);
  const SimilarityTransform other_from_own =
      SimilarityTransform(map_from_other, 3).Inverse() * SimilarityTransform(map_from_own, 2);
  const EpipolarSearch search({}, kCamera, own, other, other_from_own);
  std::vector<double> ratios;
  for (const cv::Point& pixel : FindGradientPixels(own, 8, 100000, 4)) {
    const auto found = search.Find(pixel.x, pixel.y, own.range);
    if (found) ratios.push_back(1 / found->value / kWall.DepthAt(kCamera, map_from_own, pixel.x, pixel.y));
  }
  EXPECT_NEAR(Median(ratios), 0.5, 0.005);
}

TEST(EpipolarSearch, LeavesOutWhatBelongsToAnotherObjectOrMoves) {
  const RigidTransform map_from_own = MapFromCamera(0), map_from_other = MapFromCamera(0.3);
  const KeyframeView own = kWall.View(kCamera, map_from_own, 0);
  KeyframeView other = kWall.View(kCamera, map_from_other, 1);
  const cv::Mat all_one(240, 320, CV_32S, cv::Scalar(9));
  other.labels = PixelLabels(Stage::kMoving, all_one, {{9, 3, MotionState::kMoving}}, true, 3);
  const EpipolarSearch search({}, kCamera, own, other, OtherFromOwn(map_from_other, map_from_own));
  for (const cv::Point& pixel : FindGradientPixels(own, 8, 100000, 4)) {
    EXPECT_FALSE(search.Find(pixel.x, pixel.y, own.range).has_value());
  }
  EXPECT_TRUE(FindGradientPixels(other, 8, 100000, 4).empty());
}

TEST(GradientPixels, KeepsTheStrongest) {
  const KeyframeView view = kWall.View(kCamera, MapFromCamera(0), 0);
  const std::vector<cv::Point> all = FindGradientPixels(view, 8, 100000, 4);
  const std::vector<cv::Point> few = FindGradientPixels(view, 8, 2000, 4);
  EXPECT_LE(few.size(), 2000u);
  EXPECT_GT(few.size(), 1000u);
  const auto modulus = [&](const cv::Point& pixel) { return cv::norm(view.gradient.at<cv::Vec2s>(pixel)) / 8; };
  double least_kept = 1e9;
  for (const cv::Point& pixel : few) least_kept = std::min(least_kept, modulus(pixel));
  for (const cv::Point& pixel : all) {
    if (modulus(pixel) >= least_kept + 1) {
      EXPECT_NE(std::find(few.begin(), few.end(), pixel), few.end());
    }
  }
}

TEST(HypothesisFusion, TakesTheLargestSetThatAgrees) {
  const InverseDepth fused = FuseHypotheses({{0.5f, 0.01f}, {0.1f, 0.01f}, {0.11f, 0.01f}, {0.105f, 0.005f}}, 3);
  EXPECT_NEAR(fused.value, 0.105f, 1e-4);
  EXPECT_LT(fused.sigma, 0.005f);
  EXPECT_FALSE(FuseHypotheses({{0.5f, 0.01f}, {0.1f, 0.01f}, {0.11f, 0.01f}}, 3).IsKnown());
  EXPECT_FALSE(FuseHypotheses({}, 1).IsKnown());
}

TEST(IntraKeyframeCheck, RemovesWhatStandsAloneGrowsAndSmooths) {
  const KeyframeView view = kWall.View(kCamera, MapFromCamera(0), 0);
  InverseDepthImage estimates(320, 240);
  std::vector<cv::Point> pixels;
  for (int column = 10; column < 20; ++column) {
    pixels.emplace_back(column, 50);
    if (column != 15) estimates.At(column, 50) = {0.2f + (column % 2 == 0 ? 0.01f : -0.01f), 0.02f};
  }
  pixels.emplace_back(100, 100);
  estimates.At(100, 100) = {0.2f, 0.02f};
  estimates.At(12, 50) = {0.9f, 0.02f};
  CheckAgainstNeighbors(view, pixels, &estimates);
  EXPECT_FALSE(estimates.At(100, 100).IsKnown());
  EXPECT_FALSE(estimates.At(12, 50).IsKnown());
  EXPECT_NEAR(estimates.At(15, 50).value, 0.21f, 1e-3);
  EXPECT_NEAR(estimates.At(17, 50).value, 0.2f, 5e-3);
}

TEST(InterKeyframeCheck, KeepsWhatOthersConfirmAndTakesTheMean) {
  InverseDepthImage own(320, 240);
  const std::vector<cv::Point> pixels{{100, 100}, {200, 120}};
  for (const cv::Point& pixel : pixels) own.At(pixel.x, pixel.y) = {0.2f, 0.01f};
  std::vector<InverseDepthImage> images(2, InverseDepthImage(320, 240));
  std::vector<OtherEstimates> others;
  for (int i = 0; i < 2; ++i) {
    // Half as large a unit, and a step to the side: depth 5 is 10 there, and the pixel moves by 250 * 0.4 / 5 = 20.
    const SimilarityTransform other_from_own(Eigen::Quaterniond::Identity(), {0.8, 0, 0}, 2);
    images[i].At(120, 100) = {0.101f, 0.005f};
    others.push_back({&images[i], other_from_own});
  }
  CheckAgainstKeyframes(kCamera, pixels, others, 2, &own);
  EXPECT_NEAR(own.At(100, 100).value, (0.2 + 2 * 0.202) / 3, 1e-5);
  EXPECT_FALSE(own.At(200, 120).IsKnown());
}

TEST(PixelLabels, BorderBelongsToNobodyAndBaseKnowsNoObjects) {
  cv::Mat track_image(40, 60, CV_32S, cv::Scalar(0));
  track_image(cv::Rect(20, 10, 20, 20)) = 7;
  const std::vector<ObjectRow> rows{{7, 3, MotionState::kNonMoving}};
  const PixelLabels labels(Stage::kMoving, track_image, rows, true, 2);
  EXPECT_EQ(labels.LabelAt(30, 20).object_id, 7u);
  EXPECT_EQ(labels.LabelAt(30, 20).state, MotionState::kNonMoving);
  EXPECT_EQ(labels.LabelAt(30, 20).category, 3);
  EXPECT_EQ(labels.LabelAt(21, 20).role, FeatureRole::kIgnored);
  EXPECT_EQ(labels.LabelAt(18, 20).role, FeatureRole::kIgnored);
  EXPECT_EQ(labels.LabelAt(5, 5).role, FeatureRole::kTracked);
  EXPECT_EQ(PixelLabels(Stage::kBase, track_image, rows, true, 2).LabelAt(30, 20).object_id, 0u);
}

// A drive along a wall: sparse landmarks near it give the range, the images give the rest.
std::vector<SemiDenseCloud> MapWall(int keyframes, const CameraModel& camera) {
  const synthetic::Scene points(300, 3, 3.5, 7);
  std::vector<RigidTransform> cameras;
  for (int i = 0; i < keyframes; ++i) cameras.push_back(MapFromCamera(0.15 * i).Inverse());
  const SlamMap map = synthetic::MapOf(points, camera, cameras);
  SemiDenseMapper mapper({}, camera);
  for (int i = 0; i < keyframes; ++i) {
    const cv::Mat image = kWall.View(camera, cameras[i].Inverse(), i).grey;
    mapper.Add(map, i, image, PixelLabels(), 10 * i);
    mapper.Collect(10 * i + 5);
  }
  mapper.Finish(map);
  return mapper.TakeFinished();
}

TEST(SemiDenseMapper, MapsEveryKeyframeOnceAndTruly) {
  const std::vector<SemiDenseCloud> clouds = MapWall(6, kCamera);
  ASSERT_EQ(clouds.size(), 6u);
  for (size_t i = 0; i < clouds.size(); ++i) {
    EXPECT_EQ(clouds[i].keyframe_id, static_cast<KeyframeId>(i));
    EXPECT_GT(clouds[i].points.size(), 3000u);
    std::vector<double> errors;
    for (const SemiDensePoint& point : clouds[i].points) {
      const Eigen::Vector3d position(point.position[0], point.position[1], point.position[2]);
      const Eigen::Vector2d pixel = kCamera.Project(position);
      const double truth = kWall.DepthAt(kCamera, MapFromCamera(0.15 * static_cast<double>(i)), pixel.x(), pixel.y());
      errors.push_back(std::abs(position.z() - truth) / truth);
    }
    EXPECT_LT(Median(errors), 0.005);
  }
}

TEST(SemiDenseMapper, GivesTheSameBytesAgain) {
  const std::vector<SemiDenseCloud> first = MapWall(4, kCamera), second = MapWall(4, kCamera);
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].points.size(), second[i].points.size());
    for (size_t j = 0; j < first[i].points.size(); ++j) {
      EXPECT_EQ(first[i].points[j].position, second[i].points[j].position);
      EXPECT_EQ(first[i].points[j].depth_sigma, second[i].points[j].depth_sigma);
    }
  }
}

TEST(SemiDenseMapper, LeavesOutKeyframesThatComeFasterThanItsShare) {
  const synthetic::Scene points(300, 3, 3.5, 7);
  std::vector<RigidTransform> cameras;
  for (int i = 0; i < 5; ++i) cameras.push_back(MapFromCamera(0.15 * i).Inverse());
  const SlamMap map = synthetic::MapOf(points, kCamera, cameras);
  SemiDenseMapper mapper({}, kCamera);
  for (int i = 0; i < 5; ++i) {
    mapper.Add(map, i, kWall.View(kCamera, cameras[i].Inverse(), i).grey, PixelLabels(), i);
    mapper.Collect(i);
  }
  mapper.Finish(map);
  EXPECT_EQ(mapper.TakeFinished().size(), static_cast<size_t>(SemiDenseOptions{}.most_under_way));
}

TEST(LandmarkRange, HoldsTheLandmarks) {
  const synthetic::Scene points(300, 3, 4, 8);
  const SlamMap map = synthetic::MapOf(points, kCamera, {MapFromCamera(0).Inverse(), MapFromCamera(0.2).Inverse()});
  const DepthRange range = RangeOfLandmarks(map, 0);
  EXPECT_TRUE(range.IsKnown());
  EXPECT_LT(range.farthest, 1.0 / 8);
  EXPECT_GT(range.nearest, 1.0 / 4);
}

}  // namespace
}  // namespace kinemap
