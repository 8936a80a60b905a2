// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "map/depth_scale.h"
#include "map/landmark_search.h"
#include "map/slam_map.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

class ThreeKeyframes : public ::testing::Test {
 protected:
  ThreeKeyframes()
      : map_(MapOf(scene_, TestCamera(), {CameraAt({0, 0, 0}), CameraAt({0.5, 0, 0}), CameraAt({1, 0, 0})})) {}

  Scene scene_{120, 3, 6, 14};
  SlamMap map_;
};

TEST_F(ThreeKeyframes, IdsStartAtTheMapsOwnRange) {
  SlamMap other(3, TestScales());
  const Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt({0, 0, 0}), 1);
  EXPECT_EQ(other.InsertKeyframe(frame).id, int64_t{3} << 32);
  EXPECT_EQ(other.CreateLandmark({0, 0, 5}, int64_t{3} << 32, {}).id, int64_t{3} << 32);
  EXPECT_EQ(other.map_id(), 3);
}

TEST_F(ThreeKeyframes, LandmarksMoveWithTheirAnchor) {
  const LandmarkId id = map_.LiveLandmarks().front();
  const Landmark& landmark = *map_.FindLandmark(id);
  const Eigen::Vector3d before = map_.PositionInMap(landmark);
  const RigidTransform shift(Eigen::Quaterniond::Identity(), {0, 0, 2});
  map_.SetKeyframePose(landmark.anchor_id, shift * map_.keyframe(landmark.anchor_id).map_from_keyframe);
  EXPECT_LT((map_.PositionInMap(landmark) - before - Eigen::Vector3d(0, 0, 2)).norm(), 1e-12);
}

TEST_F(ThreeKeyframes, ACulledKeyframeStaysWithItsParentAndGivesItsLandmarksAway) {
  const KeyframeId culled = 1;
  std::map<LandmarkId, Eigen::Vector3d> before;
  for (const LandmarkId id : map_.LiveLandmarks()) before[id] = map_.PositionInMap(*map_.FindLandmark(id));
  const RigidTransform pose = map_.MapFromKeyframe(culled);
  map_.CullKeyframe(culled);
  EXPECT_LT((map_.MapFromKeyframe(culled).Matrix() - pose.Matrix()).norm(), 1e-12);
  for (const LandmarkId id : map_.LiveLandmarks()) {
    const Landmark& landmark = *map_.FindLandmark(id);
    EXPECT_NE(landmark.anchor_id, culled);
    EXPECT_EQ(landmark.observations.count(culled), 0u);
    EXPECT_LT((map_.PositionInMap(landmark) - before[id]).norm(), 1e-9);
  }
  const KeyframeId parent = map_.keyframe(culled).parent_id;
  EXPECT_EQ(map_.LiveKeyframe(culled), parent);
  const RigidTransform shift(Eigen::Quaterniond::Identity(), {0, 5, 0});
  map_.SetKeyframePose(parent, shift * map_.MapFromKeyframe(parent));
  EXPECT_LT((map_.MapFromKeyframe(culled).translation - pose.translation - Eigen::Vector3d(0, 5, 0)).norm(), 1e-9);
}

TEST_F(ThreeKeyframes, AChangedParentReportsItsCulledChildrenToo) {
  map_.CullKeyframe(1);
  const KeyframeId parent = map_.keyframe(1).parent_id;
  map_.TakeChanges();
  map_.SetKeyframePose(parent, map_.MapFromKeyframe(parent));
  EXPECT_EQ(map_.TakeChanges().keyframes,
            (std::vector<KeyframeId>{std::min<KeyframeId>(parent, 1), std::max<KeyframeId>(parent, 1)}));
}

TEST_F(ThreeKeyframes, OnlyWhatWasReportedLeavesATombstone) {
  const std::vector<LandmarkId> ids = map_.LiveLandmarks();
  map_.RemoveLandmark(ids[0]);
  MapChanges changes = map_.TakeChanges();
  EXPECT_TRUE(changes.removed_landmarks.empty());
  EXPECT_EQ(changes.landmarks.size(), ids.size() - 1);
  map_.RemoveLandmark(ids[1]);
  changes = map_.TakeChanges();
  EXPECT_EQ(changes.removed_landmarks, std::vector<LandmarkId>{ids[1]});
  EXPECT_TRUE(changes.landmarks.empty());
}

TEST_F(ThreeKeyframes, FusedLandmarksKeepAllObservationsUnderOneId) {
  const std::vector<LandmarkId> ids = map_.LiveLandmarks();
  Landmark& kept = *map_.FindLandmark(ids[0]);
  // Split the last observation off into a landmark of its own, as if the point had been mapped twice.
  const auto [keyframe_id, keypoint] = *kept.observations.rbegin();
  ASSERT_EQ(kept.observations.size(), 3u);
  map_.EraseObservation(&kept, keyframe_id);
  Landmark& copy = map_.CreateLandmark(map_.PositionInMap(kept), keyframe_id, {});
  const LandmarkId copy_id = copy.id;
  map_.Observe(&copy, keyframe_id, keypoint);
  map_.FuseLandmarks(copy_id, ids[0]);
  EXPECT_EQ(map_.FindLandmark(copy_id), map_.FindLandmark(ids[0]));
  EXPECT_EQ(kept.observations.size(), 3u);
  EXPECT_EQ(map_.keyframe(keyframe_id).landmark_ids[keypoint], ids[0]);
}

TEST_F(ThreeKeyframes, ALandmarkGoesWithItsLastButOneObservationUnlessItEnded) {
  const std::vector<LandmarkId> ids = map_.LiveLandmarks();
  for (const LandmarkId id : {ids[0], ids[1]}) {
    Landmark* landmark = map_.FindLandmark(id);
    if (id == ids[1]) landmark->valid_until_ns = 500;
    const std::map<KeyframeId, int> observations = landmark->observations;
    for (const auto& [keyframe_id, keypoint] : observations) {
      if (map_.FindLandmark(id) != nullptr) map_.EraseObservation(landmark, keyframe_id);
    }
  }
  EXPECT_EQ(map_.FindLandmark(ids[0]), nullptr);
  EXPECT_NE(map_.FindLandmark(ids[1]), nullptr);
}

TEST_F(ThreeKeyframes, CovisibilityCountsSharedLandmarksMostFirst) {
  // Two of its points are taken out of the third keyframe.
  int erased = 0;
  for (const LandmarkId id : map_.LiveLandmarks()) {
    if (erased++ < 2) map_.EraseObservation(map_.FindLandmark(id), 2);
  }
  map_.UpdateCovisibility(0);
  const int shared = map_.covisibility().Shared(0, 1);
  EXPECT_EQ(map_.covisibility().Shared(0, 2), shared - 2);
  EXPECT_EQ(map_.covisibility().Shared(1, 0), shared);
  EXPECT_EQ(map_.covisibility().Neighbors(0, 10), (std::vector<KeyframeId>{1, 2}));
  EXPECT_EQ(map_.covisibility().Neighbors(0, 1), std::vector<KeyframeId>{1});
  EXPECT_EQ(map_.covisibility().Neighbors(0, 10, shared), std::vector<KeyframeId>{1});
}

TEST_F(ThreeKeyframes, LandmarksThatMayNotConstrainPosesDoNotTieKeyframes) {
  for (const LandmarkId id : map_.LiveLandmarks()) map_.FindLandmark(id)->state = MotionState::kPotentiallyDynamic;
  map_.UpdateCovisibility(0);
  EXPECT_TRUE(map_.covisibility().Neighbors(0, 10).empty());
  EXPECT_EQ(map_.CountTracked(0, 1), 0);
}

TEST_F(ThreeKeyframes, TheMajorityOfItsSightingsLabelsALandmark) {
  SlamMap map(0, TestScales());
  FeatureLabel car{FeatureRole::kTracked, MotionState::kNonMoving, 4, 3};
  const Eigen::Vector3d point(0, 0, 8);
  Scene one(1, 0, 8, 8);
  Landmark* landmark = nullptr;
  for (int k = 0; k < 3; ++k) {
    const Frame frame = one.Observe(TestCamera(), TestScales(), CameraAt({0.1 * k, 0, 0}), k + 1, 0,
                                    [&](int) { return k == 0 ? FeatureLabel{} : car; });
    const KeyframeId id = map.InsertKeyframe(frame).id;
    if (k == 0) landmark = &map.CreateLandmark(point, id, frame.labels[0]);
    map.Observe(landmark, id, 0);
    map.UpdateLabel(landmark);
    EXPECT_EQ(landmark->state, k == 0 ? MotionState::kStatic : MotionState::kNonMoving) << k;
  }
  EXPECT_EQ(landmark->object_id, 4u);
  EXPECT_EQ(landmark->category, 3);
}

TEST_F(ThreeKeyframes, AnObjectFoundToStandIsNotVotedDownByItsUndecidedPast) {
  SlamMap map(0, TestScales());
  Scene one(1, 0, 8, 8);
  Landmark* landmark = nullptr;
  for (int k = 0; k < 4; ++k) {
    const MotionState state = k < 3 ? MotionState::kUndecided : MotionState::kNonMoving;
    const FeatureLabel label{k < 3 ? FeatureRole::kMapped : FeatureRole::kTracked, state, 4, 3};
    const Frame frame =
        one.Observe(TestCamera(), TestScales(), CameraAt({0.1 * k, 0, 0}), k + 1, 0, [&](int) { return label; });
    const KeyframeId id = map.InsertKeyframe(frame).id;
    if (k == 0) landmark = &map.CreateLandmark({0, 0, 8}, id, label);
    map.Observe(landmark, id, 0);
  }
  map.UpdateLabel(landmark);
  EXPECT_EQ(landmark->state, MotionState::kNonMoving);
}

TEST(Landmark, MeetsOnlyFeaturesOfItsOwnKind) {
  const FeatureLabel background{FeatureRole::kTracked, MotionState::kStatic, 0, -1};
  const FeatureLabel own{FeatureRole::kMapped, MotionState::kUndecided, 5, 3};
  const FeatureLabel other{FeatureRole::kMapped, MotionState::kUndecided, 6, 3};
  const FeatureLabel border{FeatureRole::kIgnored, MotionState::kUndecided, 5, 3};
  Landmark landmark;
  EXPECT_TRUE(landmark.IsCompatibleWith(background));
  EXPECT_FALSE(landmark.IsCompatibleWith(own));
  landmark.state = MotionState::kUndecided;
  landmark.object_id = 5;
  EXPECT_FALSE(landmark.IsCompatibleWith(background));
  EXPECT_TRUE(landmark.IsCompatibleWith(own));
  EXPECT_FALSE(landmark.IsCompatibleWith(other));
  EXPECT_FALSE(landmark.IsCompatibleWith(border));
  landmark.valid_until_ns = 10;
  EXPECT_FALSE(landmark.IsCompatibleWith(own));
}

TEST_F(ThreeKeyframes, PredictsWhereALandmarkAppears) {
  const RigidTransform camera_from_map = CameraAt({0.2, 0.1, 0.3});
  const Landmark& landmark = *map_.FindLandmark(map_.LiveLandmarks().front());
  const Eigen::Vector3d position = map_.PositionInMap(landmark);
  const auto view = PredictView(landmark, position, camera_from_map, {0.2, 0.1, 0.3}, TestCamera(), TestScales());
  ASSERT_TRUE(view);
  EXPECT_LT((view->pixel_px - TestCamera().Project(camera_from_map * position)).norm(), 1e-9);
  EXPECT_GT(view->view_cosine, 0.95);
  const RigidTransform behind = CameraAt({0, 0, 40});
  EXPECT_FALSE(PredictView(landmark, position, behind, {0, 0, 40}, TestCamera(), TestScales()));
  const RigidTransform far_away = CameraAt({0, 0, -400});
  EXPECT_FALSE(PredictView(landmark, position, far_away, {0, 0, -400}, TestCamera(), TestScales()));
}

TEST_F(ThreeKeyframes, MeasuredDepthsGiveTheMapsUnits) {
  Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt({0, 0, 0}), 1);
  frame.landmark_ids = map_.keyframe(0).landmark_ids;
  EXPECT_EQ(MapUnitsPerMetre(map_, frame), 0);
  const Frame measured = synthetic::WithDepths(frame, [&](int i) {
    const Landmark* landmark = map_.FindLandmark(frame.landmark_ids[i]);
    return landmark == nullptr ? 0 : 2 * map_.PositionInMap(*landmark).z();
  });
  EXPECT_NEAR(MapUnitsPerMetre(map_, measured), 0.5, 1e-6);
}

}  // namespace
}  // namespace kinemap
