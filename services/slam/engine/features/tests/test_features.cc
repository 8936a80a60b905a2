// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

#include "features/brute_force_matcher.h"
#include "features/feature_budget.h"
#include "features/keypoint_distribution.h"
#include "features/keypoint_grid.h"
#include "features/object_labels.h"
#include "features/orb_extractor.h"
#include "features/rotation_consistency.h"

namespace kinemap {
namespace {

cv::Mat Texture(int width, int height, uint64_t seed = 1) {
  cv::Mat image(height, width, CV_8U);
  cv::RNG random(seed);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 2.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

const CameraModel kCamera(640, 480, 500, 500, 320, 240);

TEST(OrbExtractor, SpreadsTheWantedNumberOverImageAndLevels) {
  const PyramidScales scales(8, 1.2);
  const FrameFeaturesPtr features = OrbExtractor({1000, {20, 7}}, scales).Extract(Texture(640, 480), kCamera);
  EXPECT_NEAR(features->size(), 1000, 50);
  ASSERT_EQ(features->descriptors.size(), features->keypoints.size());
  std::set<int> octaves, cells;
  for (const Keypoint& keypoint : features->keypoints) {
    EXPECT_TRUE(kCamera.Contains(keypoint.pixel_px));
    octaves.insert(keypoint.octave);
    cells.insert(static_cast<int>(keypoint.pixel_px.x() / 80) + 8 * static_cast<int>(keypoint.pixel_px.y() / 80));
  }
  EXPECT_EQ(octaves.size(), 8u);
  EXPECT_EQ(cells.size(), 48u);
}

TEST(OrbExtractor, FindsFaintCornersWhereThereAreNoStrongOnes) {
  cv::Mat image = Texture(640, 480);
  // The right half keeps an eighth of its contrast: corners there differ by less than the first threshold.
  cv::Mat right = image(cv::Rect(320, 0, 320, 480));
  right.convertTo(right, CV_8U, 0.125, 112);
  const FrameFeaturesPtr features = OrbExtractor({1000, {20, 7}}, {8, 1.2}).Extract(image, kCamera);
  const auto in_right_half = std::count_if(features->keypoints.begin(), features->keypoints.end(),
                                           [](const Keypoint& keypoint) { return keypoint.pixel_px.x() > 330; });
  EXPECT_GT(in_right_half, 10);
  // Without the second threshold there is none.
  const FrameFeaturesPtr strong = OrbExtractor({1000, {20, 20}}, {8, 1.2}).Extract(image, kCamera);
  EXPECT_TRUE(std::none_of(strong->keypoints.begin(), strong->keypoints.end(),
                           [](const Keypoint& keypoint) { return keypoint.pixel_px.x() > 345; }));
}

TEST(OrbExtractor, NothingComesFromABlankOrTinyImage) {
  EXPECT_EQ(OrbExtractor({1000, {20, 7}}, {8, 1.2}).Extract(cv::Mat::zeros(480, 640, CV_8U), kCamera)->size(), 0);
  const CameraModel tiny(30, 20, 20, 20, 15, 10);
  EXPECT_EQ(OrbExtractor({1000, {20, 7}}, {8, 1.2}).Extract(Texture(30, 20), tiny)->size(), 0);
}

TEST(OrbExtractor, MatchesAnImageWithItsTurnedAndShiftedSelf) {
  const cv::Mat image = Texture(640, 480);
  const double angle_deg = 20;
  cv::Mat turn = cv::getRotationMatrix2D({320, 240}, angle_deg, 1.0), turned;
  turn.at<double>(0, 2) += 6;
  cv::warpAffine(image, turned, turn, image.size());
  OrbExtractor extractor({1500, {20, 7}}, {8, 1.2});
  const FrameFeaturesPtr a = extractor.Extract(image, kCamera), b = extractor.Extract(turned, kCamera);
  std::vector<int> all_a(a->size()), all_b(b->size());
  for (int i = 0; i < a->size(); ++i) all_a[i] = i;
  for (int i = 0; i < b->size(); ++i) all_b[i] = i;
  const std::vector<FeatureMatch> matches = MatchByDescriptor(*a, all_a, *b, all_b, 0.8);
  ASSERT_GT(matches.size(), 200u);
  int right = 0;
  for (const FeatureMatch& match : matches) {
    const Eigen::Vector2d& p = a->keypoints[match.query].pixel_px;
    const Eigen::Vector2d expected(
        turn.at<double>(0, 0) * p.x() + turn.at<double>(0, 1) * p.y() + turn.at<double>(0, 2),
        turn.at<double>(1, 0) * p.x() + turn.at<double>(1, 1) * p.y() + turn.at<double>(1, 2));
    const double sigma = PyramidScales(8, 1.2).scale(a->keypoints[match.query].octave);
    right += (expected - b->keypoints[match.train].pixel_px).norm() < 3 * sigma ? 1 : 0;
  }
  EXPECT_GT(right, 0.9 * matches.size());
}

TEST(OrbExtractor, OneImageGivesOneSetOfBytes) {
  OrbExtractor extractor({1000, {20, 7}}, {8, 1.2});
  const FrameFeaturesPtr a = extractor.Extract(Texture(640, 480), kCamera);
  const FrameFeaturesPtr b = extractor.Extract(Texture(640, 480), kCamera);
  EXPECT_EQ(a->descriptors, b->descriptors);
}

TEST(OrbExtractor, UndistortsItsKeypoints) {
  const CameraModel distorted(640, 480, 500, 500, 320, 240, {-0.2, 0.05, 0, 0});
  const FrameFeaturesPtr features = OrbExtractor({500, {20, 7}}, {8, 1.2}).Extract(Texture(640, 480), distorted);
  ASSERT_GT(features->size(), 0);
  for (const Keypoint& keypoint : features->keypoints) {
    EXPECT_LT((distorted.Distort(keypoint.pixel_px) - keypoint.raw_px).norm(), 0.01);
  }
}

TEST(KeypointDistribution, KeepsTheStrongestOfEachPart) {
  std::vector<Corner> corners;
  for (uint8_t i = 0; i < 100; ++i) {
    corners.push_back({static_cast<int16_t>(10 + i % 10), static_cast<int16_t>(10 + i / 10), i, 0, 0, 0, 0});
  }
  corners.push_back({300, 300, 1, 0, 0, 0, 0});
  const std::vector<Corner> chosen = DistributeEvenly(corners, {0, 0, 640, 480}, 2);
  ASSERT_GE(chosen.size(), 2u);
  EXPECT_TRUE(std::any_of(chosen.begin(), chosen.end(), [](const Corner& corner) { return corner.score == 99; }));
  EXPECT_TRUE(std::any_of(chosen.begin(), chosen.end(), [](const Corner& corner) { return corner.column == 300; }));
}

TEST(KeypointDistribution, EndsWhenCornersShareOnePlace) {
  const std::vector<Corner> corners(50, Corner{100, 100, 1, 0, 0, 0, 0});
  EXPECT_EQ(DistributeEvenly(corners, {0, 0, 640, 480}, 10).size(), 1u);
}

TEST(KeypointGrid, FindsWhatAFullSearchFinds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> x(-20, 660), y(-20, 500);
  std::vector<Keypoint> keypoints(500);
  for (Keypoint& keypoint : keypoints) {
    keypoint.pixel_px = {x(random), y(random)};
    keypoint.octave = static_cast<int>(random() % 8);
  }
  const KeypointGrid grid(keypoints, {-20, -20}, {660, 500});
  std::vector<int> found;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d center(x(random), y(random));
    const double radius = 5 + trial;
    grid.FindNear(center, radius, 2, 5, &found);
    std::set<int> expected;
    for (size_t i = 0; i < keypoints.size(); ++i) {
      const bool near = (keypoints[i].pixel_px - center).cwiseAbs().maxCoeff() <= radius;
      if (near && keypoints[i].octave >= 2 && keypoints[i].octave <= 5) expected.insert(static_cast<int>(i));
    }
    EXPECT_EQ(std::set<int>(found.begin(), found.end()), expected);
    EXPECT_EQ(found.size(), expected.size());
  }
}

TEST(KeypointGrid, VisitsAllNearASegmentOnce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(-20, 660), y(-20, 500), beyond(-900, 1500);
  std::vector<Keypoint> keypoints(2000);
  for (Keypoint& keypoint : keypoints) keypoint.pixel_px = {x(random), y(random)};
  const KeypointGrid grid(keypoints, {-20, -20}, {660, 500});
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector2d from(x(random), y(random));
    const Eigen::Vector2d to = trial % 10 == 0 ? from : Eigen::Vector2d(beyond(random), beyond(random));
    std::vector<int> visits(keypoints.size(), 0);
    grid.VisitAlong(from, to, 8, [&](const KeypointGrid::Entry& entry) { ++visits[entry.index]; });
    int visited = 0;
    for (size_t i = 0; i < keypoints.size(); ++i) {
      ASSERT_LE(visits[i], 1);
      visited += visits[i];
      const Eigen::Vector2d way = to - from, offset = keypoints[i].pixel_px - from;
      const double part = way.squaredNorm() > 0 ? std::clamp(offset.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
      const bool near = (offset - part * way).norm() < 8;
      ASSERT_TRUE(visits[i] == 1 || !near) << "trial " << trial << " keypoint " << i;
    }
    EXPECT_LT(visited, 1000);
  }
}

TEST(KeypointGrid, OnlySomeAreTheSameWithoutTheOthers) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> x(0, 640), y(0, 480);
  std::vector<Keypoint> keypoints(300);
  for (Keypoint& keypoint : keypoints) keypoint.pixel_px = {x(random), y(random)};
  const KeypointGrid grid(keypoints, {0, 0}, {640, 480});
  const auto is_third = [](int index) { return index % 3 == 0; };
  const KeypointGrid thirds = grid.Only(is_third), none = grid.Only([](int) { return false; });
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d center(x(random), y(random));
    std::vector<int> all, found, nothing;
    grid.FindNear(center, 70, 0, 7, &all);
    thirds.FindNear(center, 70, 0, 7, &found);
    none.FindNear(center, 70, 0, 7, &nothing);
    std::erase_if(all, [&](int index) { return !is_third(index); });
    EXPECT_EQ(found, all);
    EXPECT_TRUE(nothing.empty());
  }
}

TEST(RotationConsistency, RejectsMatchesThatTurnDifferently) {
  RotationConsistency rotation;
  for (int i = 0; i < 50; ++i) rotation.Add(i, 350.0f, 20.0f);  // +30 degrees across the zero
  rotation.Add(50, 10.0f, 200.0f);
  EXPECT_EQ(rotation.Inconsistent(), std::vector<int>{50});
}

TEST(FeatureBudget, AsksForMoreWhileObjectsCoverTheImage) {
  FeatureBudget budget(1000);
  std::vector<FeatureLabel> labels(100);
  budget.Observe(labels);
  EXPECT_EQ(budget.next(), 1000);
  for (int i = 0; i < 40; ++i) labels[i].role = FeatureRole::kSighted;
  budget.Observe(labels);
  EXPECT_EQ(budget.next(), 1666);
  for (FeatureLabel& label : labels) label.role = FeatureRole::kIgnored;
  budget.Observe(labels);
  EXPECT_EQ(budget.next(), 2000);
}

class Labels : public ::testing::Test {
 protected:
  Labels() : track_image_(480, 640, CV_32S, cv::Scalar(0)) { track_image_(cv::Rect(100, 100, 100, 100)).setTo(5); }

  FeatureLabel At(Stage stage, MotionState state, double x, double y, bool fresh = true, int octave = 0) const {
    Keypoint keypoint;
    keypoint.octave = octave;
    keypoint.raw_px = keypoint.pixel_px = {x, y};
    return ObjectLabels(stage, track_image_, {{5, 3, state}}, fresh, 3, PyramidScales(8, 1.2)).LabelOf(keypoint);
  }

  cv::Mat track_image_;
};

TEST_F(Labels, BaseKnowsNoObjects) {
  const FeatureLabel label = At(Stage::kBase, MotionState::kMoving, 150, 150);
  EXPECT_EQ(label.role, FeatureRole::kTracked);
  EXPECT_EQ(label.state, MotionState::kStatic);
  EXPECT_EQ(label.object_id, 0u);
}

TEST_F(Labels, DynamicKeepsEveryObjectOut) {
  const FeatureLabel label = At(Stage::kDynamic, MotionState::kNonMoving, 150, 150);
  EXPECT_EQ(label.role, FeatureRole::kMapped);
  EXPECT_EQ(label.state, MotionState::kPotentiallyDynamic);
  EXPECT_EQ(label.object_id, 5u);
  EXPECT_EQ(label.category, 3);
}

TEST_F(Labels, CoarseFeaturesKeepMoreDistanceFromWhatMoves) {
  EXPECT_EQ(At(Stage::kMoving, MotionState::kMoving, 92, 150).role, FeatureRole::kTracked);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kMoving, 92, 150, true, 7).role, FeatureRole::kIgnored);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 92, 150, true, 7).role, FeatureRole::kTracked);
}

TEST_F(Labels, MovingTracksWhatStandsAndNothingElse) {
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 150, 150).role, FeatureRole::kTracked);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kMoving, 150, 150).role, FeatureRole::kSighted);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kUndecided, 150, 150).role, FeatureRole::kMapped);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kPotentiallyDynamic, 150, 150).role, FeatureRole::kMapped);
}

TEST_F(Labels, CarriedMasksAreNotTrusted) {
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 150, 150, false).role, FeatureRole::kMapped);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kMoving, 150, 150, false).role, FeatureRole::kMapped);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 400, 150, false).role, FeatureRole::kTracked);
}

TEST_F(Labels, ABorderOnBothSidesOfTheOutlineBelongsToNobody) {
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 97, 150).role, FeatureRole::kIgnored);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 102, 150).role, FeatureRole::kIgnored);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kNonMoving, 96, 150).role, FeatureRole::kTracked);
  EXPECT_EQ(At(Stage::kMoving, MotionState::kMoving, 103, 150).role, FeatureRole::kSighted);
}

TEST_F(Labels, AnObjectWithoutARowIsNotDecided) {
  track_image_(cv::Rect(400, 100, 50, 50)).setTo(9);
  const FeatureLabel label = At(Stage::kMoving, MotionState::kMoving, 425, 125);
  EXPECT_EQ(label.role, FeatureRole::kMapped);
  EXPECT_EQ(label.object_id, 9u);
}

}  // namespace
}  // namespace kinemap
