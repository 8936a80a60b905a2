// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "synthetic/scene.h"
#include "tracking/camera_tracker.h"
#include "tracking/initial_map_builder.h"
#include "tracking/keyframe_policy.h"
#include "tracking/map_initializer.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

Frame Seen(const Scene& scene, const Eigen::Vector3d& center, int64_t timestamp_ns, double noise_px = 0.3) {
  return scene.Observe(TestCamera(), TestScales(), CameraAt(center), timestamp_ns, noise_px);
}

double CenterError(const Frame& frame, const Eigen::Vector3d& center) {
  return (frame.camera_from_map.Inverse().translation - center).norm();
}

TEST(KeyframePolicy, NeedsEveryConditionOfTheThesis) {
  const KeyframePolicy policy({});
  const TrackingQuality due{1000, 3, true, 260, 400};
  EXPECT_TRUE(policy.NeedsKeyframe(due));
  TrackingQuality quality = due;
  quality.frames_since_relocalization = 19;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
  quality.tracked = 249;
  EXPECT_TRUE(policy.NeedsKeyframe(quality)) << "the camera is about to be lost again";
  quality = due;
  quality.mapper_is_free = false;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
  quality.frames_since_keyframe = 20;
  EXPECT_TRUE(policy.NeedsKeyframe(quality));
  quality = due;
  quality.tracked = 49;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
  quality.tracked = 50;
  EXPECT_TRUE(policy.NeedsKeyframe(quality));
  quality.tracked = 360;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
  quality.tracked = 359;
  EXPECT_TRUE(policy.NeedsKeyframe(quality));
}

TEST(KeyframePolicy, WaitsForNothingWhenTheMapRunsOut) {
  const KeyframePolicy policy({});
  const TrackingQuality starving{1, 1, false, 40, 30, 60};
  EXPECT_TRUE(policy.NeedsKeyframe(starving));
  TrackingQuality quality = starving;
  quality.newest_tracked = 44;
  EXPECT_FALSE(policy.NeedsKeyframe(quality)) << "the newest keyframe sees no more than this frame";
  quality = starving;
  quality.tracked = 11;
  EXPECT_FALSE(policy.NeedsKeyframe(quality)) << "the pose is too uncertain to map by";
  quality.tracked = 100;
  quality.newest_tracked = 200;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
}

TEST(MapInitializer, WaitsForParallaxAndThenFindsTheMotion) {
  const Scene scene(400, 4, 6, 16);
  MapInitializer initializer({}, TestCamera());
  RandomEngine random(0, 1);
  EXPECT_FALSE(initializer.Try(Seen(scene, {0, 0, 0}, 1), random));
  EXPECT_EQ(initializer.reason(), "waiting for a second view");
  EXPECT_FALSE(initializer.Try(Seen(scene, {0.01, 0, 0}, 2), random));
  EXPECT_NE(initializer.reason(), "");
  const std::optional<InitialMap> initial = initializer.Try(Seen(scene, {0.8, 0, 0.2}, 3), random);
  ASSERT_TRUE(initial) << initializer.reason();
  EXPECT_EQ(initial->reference.timestamp_ns, 1);
  const Eigen::Vector3d direction = initial->motion.second_from_first.Inverse().translation.normalized();
  EXPECT_GT(direction.dot(Eigen::Vector3d(0.8, 0, 0.2).normalized()), 0.99);
}

TEST(MapInitializer, SaysThatTheCameraStandsStill) {
  const Scene scene(400, 4, 6, 16);
  MapInitializer initializer({}, TestCamera());
  RandomEngine random(0, 1);
  initializer.Try(Seen(scene, {0, 0, 0}, 1), random);
  EXPECT_FALSE(initializer.Try(Seen(scene, {0, 0, 0}, 2), random));
  EXPECT_EQ(initializer.reason().find("the camera stands still"), 0u) << initializer.reason();
}

TEST(MapInitializer, WaitsWhileTheCameraOnlyTurns) {
  const Scene scene(400, 4, 6, 16);
  MapInitializer initializer({}, TestCamera());
  RandomEngine random(0, 1);
  initializer.Try(Seen(scene, {0, 0, 0}, 1), random);
  for (int i = 1; i <= 5; ++i) {
    const RigidTransform turned(Eigen::Quaterniond(Eigen::AngleAxisd(0.02 * i, Eigen::Vector3d::UnitY())), {0, 0, 0});
    EXPECT_FALSE(initializer.Try(scene.Observe(TestCamera(), TestScales(), turned, i + 1), random)) << i;
    EXPECT_NE(initializer.reason().find("homography"), std::string::npos) << initializer.reason();
  }
}

TEST(MapInitializer, SaysThatAnEmptyImageHasTooFewFeatures) {
  const Scene scene(50, 4, 6, 16);
  MapInitializer initializer({}, TestCamera());
  RandomEngine random(0, 1);
  EXPECT_FALSE(initializer.Try(Seen(scene, {0, 0, 0}, 1), random));
  EXPECT_NE(initializer.reason().find("trackable features, 100 needed"), std::string::npos);
}

TEST(MapInitializer, LooksAtNothingThatStaysOutOfTracking) {
  const Scene scene(400, 4, 6, 16);
  const auto all_moving = [](int) { return FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 1, 3}; };
  MapInitializer initializer({}, TestCamera());
  RandomEngine random(0, 1);
  initializer.Try(scene.Observe(TestCamera(), TestScales(), CameraAt({0, 0, 0}), 1, 0, all_moving), random);
  EXPECT_EQ(initializer.reason(), "0 trackable features, 100 needed");
}

class InitialMaps : public ::testing::Test {
 protected:
  InitialMap Initial() {
    MapInitializer initializer({}, TestCamera());
    RandomEngine random(0, 1);
    initializer.Try(Seen(scene_, {0, 0, 0}, 1), random);
    current_ = Seen(scene_, second_center_, 2);
    return *initializer.Try(current_, random);
  }

  Scene scene_{400, 4, 6, 16};
  Eigen::Vector3d second_center_{0.8, 0, 0.2};
  Frame current_;
};

TEST_F(InitialMaps, HaveMedianDepthOneWithoutDepth) {
  const BuiltMap built = InitialMapBuilder(TestCamera(), TestScales()).Build(0, {}, Initial(), current_);
  ASSERT_NE(built.map, nullptr) << built.reason;
  EXPECT_FALSE(built.metric_scale);
  EXPECT_NEAR(built.map->MedianDepth(0), 1, 0.02);
}

TEST_F(InitialMaps, AreMetricWithDepths) {
  const InitialMap initial = Initial();
  const Frame measured = synthetic::WithDepths(
      current_, [&](int i) { return (CameraAt(second_center_) * scene_.points()[scene_.observed_points()[i]]).z(); });
  const BuiltMap built = InitialMapBuilder(TestCamera(), TestScales()).Build(0, {}, initial, measured);
  ASSERT_NE(built.map, nullptr) << built.reason;
  EXPECT_TRUE(built.metric_scale);
  EXPECT_NEAR(built.map->MapFromKeyframe(1).translation.norm(), second_center_.norm(), 0.03);
}

TEST_F(InitialMaps, StartAtTheGivenPose) {
  const RigidTransform start(RotationFromVector({0, 0.5, 0}), Eigen::Vector3d(10, 0, 3));
  const BuiltMap built = InitialMapBuilder(TestCamera(), TestScales()).Build(0, start, Initial(), current_);
  ASSERT_NE(built.map, nullptr) << built.reason;
  EXPECT_LT((built.map->MapFromKeyframe(0).Matrix() - start.Matrix()).norm(), 1e-12);
}

class Tracker : public ::testing::Test {
 protected:
  Tracker()
      : map_(MapOf(scene_, TestCamera(), {CameraAt({0, 0, 0}), CameraAt({0.3, 0, 0}), CameraAt({0.6, 0, 0})}, 0.3)) {
    Frame start = Seen(scene_, {0.6, 0, 0}, 1000);
    start.landmark_ids = map_.keyframe(2).landmark_ids;
    start.reference_keyframe_id = 2;
    tracker_.Start(map_, start, CameraAt({0.5, 0, 0}));
  }

  Scene scene_{400, 4, 6, 16};
  SlamMap map_;
  CameraTracker tracker_{{}, TestCamera()};
};

TEST_F(Tracker, FollowsSteadyMotion) {
  for (int step = 1; step <= 10; ++step) {
    const Eigen::Vector3d center(0.6 + 0.1 * step, 0, 0.05 * step);
    Frame frame = Seen(scene_, center, 1000 + step);
    const TrackedPose pose = tracker_.Track(&map_, &frame);
    ASSERT_TRUE(pose.tracked) << pose.reason;
    EXPECT_LT(CenterError(frame, center), 0.05) << "step " << step;
    EXPECT_FALSE(pose.relocalized);
  }
}

TEST_F(Tracker, SurvivesAJumpByTheReferenceKeyframe) {
  const Eigen::Vector3d center(0.2, 0.4, -1.5);
  Frame frame = Seen(scene_, center, 1001);
  const TrackedPose pose = tracker_.Track(&map_, &frame);
  ASSERT_TRUE(pose.tracked) << pose.reason;
  EXPECT_LT(CenterError(frame, center), 0.05);
}

TEST_F(Tracker, IsLostInAnEmptyImageAndFoundAgain) {
  const Scene nothing(0, 1, 1, 2);
  for (int i = 0; i < 12; ++i) {
    Frame frame = Seen(nothing, {0, 0, 0}, 1001 + i);
    const TrackedPose pose = tracker_.Track(&map_, &frame);
    EXPECT_FALSE(pose.tracked);
    EXPECT_EQ(pose.reason, "lost: no keyframe recognised");
  }
  const Eigen::Vector3d center(0.4, 0.3, 0.5);
  Frame frame = Seen(scene_, center, 1020);
  const TrackedPose pose = tracker_.Track(&map_, &frame);
  ASSERT_TRUE(pose.tracked) << pose.reason;
  EXPECT_TRUE(pose.relocalized);
  EXPECT_EQ(tracker_.frames_since_relocalization(), 0);
  EXPECT_LT(CenterError(frame, center), 0.05);
  Frame next = Seen(scene_, {0.4, 0.3, 0.6}, 1021);
  EXPECT_TRUE(tracker_.Track(&map_, &next).tracked);
  EXPECT_TRUE(tracker_.state().motion.velocity.has_value()) << "two frames tell how it moves";
}

TEST_F(Tracker, HoldsThePoseByFewLandmarksWhereItIsExpected) {
  const auto label = [](int point) {
    return point % 20 == 0 ? FeatureLabel{} : FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 1, 3};
  };
  for (int step = 1; step <= 6; ++step) {
    const Eigen::Vector3d center(0.6 + 0.1 * step, 0, 0);
    Frame frame = step < 3 ? Seen(scene_, center, 1000 + step)
                           : scene_.Observe(TestCamera(), TestScales(), CameraAt(center), 1000 + step, 0.3, label);
    const TrackedPose pose = tracker_.Track(&map_, &frame);
    ASSERT_TRUE(pose.tracked) << "step " << step << ": " << pose.reason;
    if (step >= 3) {
      EXPECT_LT(pose.estimate.inliers, 30);
    }
    EXPECT_LT(CenterError(frame, center), 0.05) << "step " << step;
  }
}

TEST_F(Tracker, FewLandmarksElsewhereAreNotEnough) {
  const auto label = [](int point) {
    return point % 20 == 0 ? FeatureLabel{} : FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 1, 3};
  };
  Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt({0.2, 0.4, -1.5}), 1001, 0.3, label);
  EXPECT_FALSE(tracker_.Track(&map_, &frame).tracked);
}

TEST_F(Tracker, GoesOnWhereItIsExpectedAfterAShortBlindness) {
  const Scene nothing(0, 1, 1, 2);
  for (int step = 1; step <= 8; ++step) {
    const Eigen::Vector3d center(0.6 + 0.1 * step, 0, 0);
    Frame frame = Seen(step > 2 && step < 7 ? nothing : scene_, center, 1000 + step);
    const TrackedPose pose = tracker_.Track(&map_, &frame);
    ASSERT_EQ(pose.tracked, step <= 2 || step >= 7) << "step " << step << ": " << pose.reason;
    EXPECT_FALSE(pose.relocalized);
    if (pose.tracked) {
      EXPECT_LT(CenterError(frame, center), 0.05);
    }
  }
}

TEST_F(Tracker, DoesNotCountAsVisibleWhatAnObjectHides) {
  // The same scene, but what is on the left belongs to something that moves in front: other descriptors, its labels.
  const Scene objects(6000, 4, 6, 16, 2);
  const auto moving = [](int) { return FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 1, 3}; };
  std::vector<int> visible;
  for (const LandmarkId id : map_.LiveLandmarks()) visible.push_back(map_.FindLandmark(id)->visible);
  const Eigen::Vector3d center(0.7, 0, 0);
  Frame hidden = objects.Observe(TestCamera(), TestScales(), CameraAt(center), 1001, 0.3, moving);
  hidden.camera_from_map = CameraAt(center);
  // What it matched of the map is all that the tracker chooses the local map by.
  hidden.landmark_ids[0] = map_.LiveLandmarks().front();
  LocalMapTracker(TestCamera()).Track(&map_, 1, &hidden);
  int counted = 0;
  for (size_t i = 0; i < visible.size(); ++i) {
    counted += map_.FindLandmark(map_.LiveLandmarks()[i])->visible - visible[i];
  }
  EXPECT_LT(counted, static_cast<int>(visible.size()) / 4);
}

TEST_F(Tracker, MovingObjectsDoNotPullThePoseAlong) {
  // A third of the points belongs to an object that moves with the camera; its features are labelled so.
  const auto is_car = [](int point) { return point % 3 == 0; };
  const auto label = [&](int point) {
    return is_car(point) ? FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 1, 3} : FeatureLabel{};
  };
  for (int step = 1; step <= 5; ++step) {
    Scene moved = scene_;
    for (size_t i = 0; i < moved.points().size(); ++i) {
      if (is_car(static_cast<int>(i))) moved.points()[i].x() += 0.1 * step;
    }
    const Eigen::Vector3d center(0.6 + 0.1 * step, 0, 0);
    Frame frame = moved.Observe(TestCamera(), TestScales(), CameraAt(center), 1000 + step, 0.3, label);
    const TrackedPose pose = tracker_.Track(&map_, &frame);
    ASSERT_TRUE(pose.tracked) << pose.reason;
    EXPECT_LT(CenterError(frame, center), 0.05);
    for (int i = 0; i < frame.size(); ++i) {
      if (frame.labels[i].role == FeatureRole::kTracked) continue;
      EXPECT_EQ(frame.landmark_ids[i], kNoId);
    }
  }
}

TEST_F(Tracker, MovesWithAKeyframeTheMapperMoved) {
  const RigidTransform shift(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 3));
  for (const KeyframeId id : map_.LiveKeyframes()) {
    map_.SetKeyframePose(id, shift * map_.keyframe(id).map_from_keyframe);
  }
  for (const LandmarkId id : map_.LiveLandmarks()) map_.UpdateViewRange(map_.FindLandmark(id));
  Frame frame = Seen(scene_, {0.7, 0, 0}, 1001);
  const TrackedPose pose = tracker_.Track(&map_, &frame);
  ASSERT_TRUE(pose.tracked) << pose.reason;
  EXPECT_LT(CenterError(frame, {0.7, 0, 3}), 0.05);
}

}  // namespace
}  // namespace kinemap
