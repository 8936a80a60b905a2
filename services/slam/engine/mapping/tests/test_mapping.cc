// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "mapping/local_mapper.h"
#include "mapping/object_states.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

std::vector<RigidTransform> Row(int count, double spacing) {
  std::vector<RigidTransform> cameras;
  for (int k = 0; k < count; ++k) cameras.push_back(CameraAt({spacing * k, 0, 0}));
  return cameras;
}

/// A map of two keyframes that tie half of the points; the other half waits to be triangulated.
class HalfMapped : public ::testing::Test {
 protected:
  void Make(const std::function<FeatureLabel(int)>& label) {
    std::map<int, std::pair<int, int>> keypoints;
    for (int k = 0; k < 2; ++k) {
      Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt({0.6 * k, 0, 0}), 100 * (k + 1), 0.2, label);
      if (all_unmapped_look_alike_) MakeUnmappedLookAlike(&frame);
      map_.InsertKeyframe(frame);
      for (int i = 0; i < frame.size(); ++i) {
        const int point = scene_.observed_points()[i];
        if (k == 0) {
          keypoints[point] = {i, -1};
        } else if (keypoints.count(point) > 0) {
          keypoints[point].second = i;
        }
      }
    }
    for (const auto& [point, pair] : keypoints) {
      if (pair.second < 0) continue;
      if (point % 2 == 1) {
        point_of_keypoint_[pair.second] = point;
        continue;
      }
      Landmark& landmark = map_.CreateLandmark(scene_.points()[point], 0, {});
      map_.Observe(&landmark, 0, pair.first);
      map_.Observe(&landmark, 1, pair.second);
    }
    map_.UpdateCovisibility(1);
  }

  void MakeUnmappedLookAlike(Frame* frame) const {
    auto features = std::make_shared<FrameFeatures>(*frame->features);
    for (int i = 0; i < frame->size(); ++i) {
      if (scene_.observed_points()[i] % 2 == 1) features->descriptors[i] = {};
    }
    frame->features = features;
  }

  Scene scene_{300, 3, 6, 14};
  bool all_unmapped_look_alike_ = false;
  SlamMap map_{0, TestScales()};
  std::map<int, int> point_of_keypoint_;  // unmapped points by the second keyframe's keypoint
};

TEST_F(HalfMapped, TriangulatesTheRestWhereItIs) {
  Make(nullptr);
  const std::vector<LandmarkId> made = LandmarkTriangulator({}, TestCamera()).Triangulate(&map_, 1);
  EXPECT_GT(made.size(), 0.7 * point_of_keypoint_.size());
  for (const LandmarkId id : made) {
    const Landmark& landmark = *map_.FindLandmark(id);
    const Eigen::Vector3d& truth = scene_.points()[point_of_keypoint_.at(landmark.observations.at(1))];
    EXPECT_LT((map_.PositionInMap(landmark) - truth).norm(), 0.1 * truth.norm());
    EXPECT_EQ(landmark.observations.size(), 2u);
  }
}

TEST_F(HalfMapped, WhatRepeatsAlongTheEpipolarLineIsNotTriangulated) {
  for (size_t point = 1; point < scene_.points().size(); point += 2) {
    scene_.points()[point].y() = 0.5;
    scene_.points()[point].z() = 8;
  }
  all_unmapped_look_alike_ = true;
  Make(nullptr);
  ASSERT_GT(point_of_keypoint_.size(), 20u);
  EXPECT_TRUE(LandmarkTriangulator({}, TestCamera()).Triangulate(&map_, 1).empty());
}

TEST_F(HalfMapped, ObjectsOutOfTrackingAreMappedWithTheirLabel) {
  Make([](int point) {
    return point % 2 == 1 ? FeatureLabel{FeatureRole::kMapped, MotionState::kUndecided, 8, 3} : FeatureLabel{};
  });
  const std::vector<LandmarkId> made = LandmarkTriangulator({}, TestCamera()).Triangulate(&map_, 1);
  ASSERT_GT(made.size(), 0u);
  for (const LandmarkId id : made) {
    EXPECT_EQ(map_.FindLandmark(id)->state, MotionState::kUndecided);
    EXPECT_EQ(map_.FindLandmark(id)->object_id, 8u);
    EXPECT_FALSE(map_.FindLandmark(id)->IsTrackable());
  }
  const BundleProblem problem = LocalBundleAdjuster({}).CopyProblem(map_, 1);
  for (const BundlePoint& point : problem.points) EXPECT_TRUE(map_.FindLandmark(point.landmark_id)->IsTrackable());
}

TEST_F(HalfMapped, MovingObjectsAndBordersAreNotTriangulated) {
  Make([](int point) {
    if (point % 2 == 0) return FeatureLabel{};
    return point % 4 == 1 ? FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 8, 3}
                          : FeatureLabel{FeatureRole::kIgnored, MotionState::kStatic, 0, -1};
  });
  EXPECT_TRUE(LandmarkTriangulator({}, TestCamera()).Triangulate(&map_, 1).empty());
}

TEST(LandmarkFuser, JoinsAPointThatWasMappedTwice) {
  const Scene scene(200, 3, 6, 14);
  SlamMap map = MapOf(scene, TestCamera(), Row(4, 0.3));
  // The newest keyframe's sight of a point gets a landmark of its own.
  std::vector<LandmarkId> split;
  for (const LandmarkId id : map.LiveLandmarks()) {
    Landmark* landmark = map.FindLandmark(id);
    if (landmark->observations.size() < 4 || split.size() == 20) continue;
    const int keypoint_2 = landmark->observations.at(2), keypoint_3 = landmark->observations.at(3);
    const Eigen::Vector3d position = map.PositionInMap(*landmark);
    map.EraseObservation(landmark, 2);
    map.EraseObservation(landmark, 3);
    Landmark& copy = map.CreateLandmark(position, 2, {});
    map.Observe(&copy, 2, keypoint_2);
    map.Observe(&copy, 3, keypoint_3);
    map.UpdateDescriptor(&copy);
    map.UpdateViewRange(&copy);
    split.push_back(copy.id);
  }
  ASSERT_EQ(split.size(), 20u);
  const int before = map.landmark_count();
  LandmarkFuser({}, TestCamera()).Fuse(&map, 3);
  EXPECT_EQ(map.landmark_count(), before - 20);
}

TEST(LandmarkCuller, RemovesWhatIsRarelyFoundOrSeen) {
  const Scene scene(100, 2, 6, 10);
  SlamMap map = MapOf(scene, TestCamera(), Row(4, 0.2));
  const std::vector<LandmarkId> ids = map.LiveLandmarks();
  Landmark* rarely_found = map.FindLandmark(ids[0]);
  rarely_found->visible = 100, rarely_found->found = 24;
  Landmark* often_found = map.FindLandmark(ids[1]);
  often_found->visible = 100, often_found->found = 26;
  Landmark* rarely_seen = map.FindLandmark(ids[2]);
  while (rarely_seen->observations.size() > 2)
    map.EraseObservation(rarely_seen, rarely_seen->observations.rbegin()->first);
  LandmarkCuller culler;
  culler.Add(ids);
  culler.Cull(&map);
  EXPECT_EQ(map.FindLandmark(ids[0]), nullptr);
  EXPECT_NE(map.FindLandmark(ids[2]), nullptr) << "one keyframe after it there was no chance to be seen often";
  culler.Cull(&map);
  EXPECT_NE(map.FindLandmark(ids[1]), nullptr);
  EXPECT_EQ(map.FindLandmark(ids[2]), nullptr);
  EXPECT_GT(culler.on_trial().size(), 0u);
  culler.Cull(&map);
  EXPECT_EQ(culler.on_trial().size(), 0u);
}

TEST(LandmarkCuller, EndsTheTrialOfLandmarksOfAMapThatWasMerged) {
  const Scene scene(100, 2, 6, 10);
  SlamMap elder = MapOf(scene, TestCamera(), Row(4, 0.2));
  SlamMap absorbed(7, TestScales());
  for (int k = 0; k < 3; ++k) {
    absorbed.InsertKeyframe(scene.Observe(TestCamera(), TestScales(), CameraAt({0.2 * k, 0, 0}), 1000 + k));
  }
  Landmark& seen_thrice = absorbed.CreateLandmark(scene.points()[0], int64_t{7} << 32, {});
  Landmark& seen_twice = absorbed.CreateLandmark(scene.points()[1], int64_t{7} << 32, {});
  for (int k = 0; k < 3; ++k) {
    absorbed.Observe(&seen_thrice, (int64_t{7} << 32) + k, 0);
    if (k < 2) absorbed.Observe(&seen_twice, (int64_t{7} << 32) + k, 1);
  }
  const LandmarkId kept = seen_thrice.id, removed = seen_twice.id;
  LandmarkCuller culler;
  culler.Add({kept, removed});
  culler.Cull(&absorbed);
  elder.Absorb(std::move(absorbed), SimilarityTransform());
  culler.Cull(&elder);
  culler.Cull(&elder);
  EXPECT_NE(elder.FindLandmark(kept), nullptr);
  EXPECT_EQ(elder.FindLandmark(removed), nullptr);
  EXPECT_TRUE(culler.on_trial().empty());
}

TEST(KeyframeCuller, CullsWhatOthersSeeTooButNeverTheFirst) {
  const Scene scene(200, 1.5, 6, 10);
  SlamMap map = MapOf(scene, TestCamera(), Row(6, 0.02));
  const int culled = KeyframeCuller().Cull(&map, 5);
  EXPECT_GE(culled, 1);
  EXPECT_FALSE(map.keyframe(0).culled);
  EXPECT_FALSE(map.keyframe(5).culled);
  EXPECT_EQ(map.live_keyframe_count(), 6 - culled);
  // Three must be left to see each landmark.
  EXPECT_GE(map.live_keyframe_count(), 3);
}

TEST(LocalBundleAdjuster, BringsADisturbedKeyframeBack) {
  const Scene scene(200, 3, 6, 14);
  SlamMap map = MapOf(scene, TestCamera(), Row(5, 0.3));
  const RigidTransform truth = map.MapFromKeyframe(4);
  map.SetKeyframePose(4, truth * RigidTransform(RotationFromVector({0.01, 0, 0}), Eigen::Vector3d(0.02, 0.01, 0)));
  LocalBundleOptions options;
  options.keyframes = 4;  // with the first keyframe, which is fixed
  BundleProblem problem = LocalBundleAdjuster(options).CopyProblem(map, 4);
  int moving = 0;
  for (const BundleCamera& camera : problem.cameras) moving += camera.fixed ? 0 : 1;
  EXPECT_EQ(moving, 3);
  EXPECT_EQ(problem.cameras.size(), 5u);
  SolveBundle(TestCamera(), {10, 10, 1e-8}, &problem);
  WriteBackBundle(problem, &map);
  EXPECT_LT((map.MapFromKeyframe(4).translation - truth.translation).norm(), 1e-3);
}

TEST(MergeSlot, GivesItsSolutionAtTheSetFrameOnly) {
  MergeSlot slot(TestCamera(), {});
  EXPECT_TRUE(slot.IsFree());
  slot.Start({}, 12);
  EXPECT_FALSE(slot.IsFree());
  EXPECT_FALSE(slot.IsDue(11));
  EXPECT_TRUE(slot.IsDue(12));
  EXPECT_THROW(slot.Start({}, 20), std::logic_error);
  slot.Take();
  EXPECT_TRUE(slot.IsFree());
  EXPECT_FALSE(slot.IsDue(100));
}

TEST(MovingLandmarkPlacer, PlacesByDepthInMapUnits) {
  const Scene scene(300, 3, 6, 14);
  SlamMap map = MapOf(scene, TestCamera(), Row(2, 0.5));
  const auto label = [](int point) {
    return point % 5 == 0 ? FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 2, 3} : FeatureLabel{};
  };
  Frame frame = scene.Observe(TestCamera(), TestScales(), CameraAt({0.5, 0, 0}), 700, 0, label);
  for (int i = 0; i < frame.size(); ++i) {
    if (frame.labels[i].role == FeatureRole::kTracked) frame.landmark_ids[i] = map.keyframe(1).landmark_ids[i];
  }
  // Every third depth is unknown; the others are in metres, of which two make a map unit.
  const Frame measured = synthetic::WithDepths(frame, [&](int i) {
    return i % 3 == 0 ? 0 : 2 * (frame.camera_from_map * scene.points()[scene.observed_points()[i]]).z();
  });
  const int before = map.landmark_count();
  const KeyframeId id = map.InsertKeyframe(frame).id;
  const int unplaced = MovingLandmarkPlacer(TestCamera()).Place(&map, id, measured);
  EXPECT_GT(unplaced, 5);
  int placed = 0;
  for (const LandmarkId landmark_id : map.LiveLandmarks()) {
    const Landmark& landmark = *map.FindLandmark(landmark_id);
    if (landmark.state != MotionState::kMoving) continue;
    ++placed;
    EXPECT_EQ(landmark.anchor_id, id);
    EXPECT_EQ(landmark.first_seen_ns, 700);
    EXPECT_EQ(landmark.last_seen_ns, 700);
    EXPECT_TRUE(landmark.observations.empty());
    double nearest = 1e9;
    for (const Eigen::Vector3d& point : scene.points()) {
      nearest = std::min(nearest, (point - map.PositionInMap(landmark)).norm());
    }
    EXPECT_LT(nearest, 1e-6);
  }
  EXPECT_GT(placed, 20);
  EXPECT_EQ(map.landmark_count(), before + placed);
  EXPECT_EQ(MovingLandmarkPlacer(TestCamera()).Place(&map, id, frame), placed + unplaced);
}

TEST(ObjectStates, EndAndReleaseLandmarks) {
  const Scene scene(60, 2, 6, 10);
  SlamMap map = MapOf(scene, TestCamera(), Row(3, 0.3));
  const auto on_object = [&](uint32_t object_id, MotionState state) {
    return &map.CreateLandmark({0, 0, 5}, map.first_keyframe_id(), {FeatureRole::kMapped, state, object_id, 3});
  };
  Landmark* parked = on_object(1, MotionState::kNonMoving);
  Landmark* unclear = on_object(2, MotionState::kUndecided);
  ObjectStates states;
  EXPECT_EQ(states.Update({{1, 3, MotionState::kNonMoving}, {2, 3, MotionState::kUndecided}}, 100, &map), 0);
  EXPECT_TRUE(parked->IsTrackable());
  EXPECT_FALSE(unclear->IsTrackable());
  EXPECT_EQ(states.Update({{1, 3, MotionState::kMoving}, {2, 3, MotionState::kNonMoving}}, 200, &map), 1);
  EXPECT_EQ(parked->valid_until_ns, 200);
  EXPECT_FALSE(parked->IsTrackable());
  EXPECT_TRUE(unclear->IsTrackable());
  EXPECT_EQ(states.Update({{1, 3, MotionState::kMoving}}, 300, &map), 0);
  EXPECT_EQ(parked->valid_until_ns, 200);
}

}  // namespace
}  // namespace kinemap
