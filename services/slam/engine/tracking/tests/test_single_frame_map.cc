// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "map/measured_landmarks.h"
#include "synthetic/scene.h"
#include "tracking/camera_tracker.h"
#include "tracking/keyframe_policy.h"
#include "tracking/single_frame_map_builder.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestScales;
using synthetic::TestStereoCamera;

Frame See(const Scene& scene, const Eigen::Vector3d& center, int64_t timestamp_ns) {
  return scene.Observe(TestStereoCamera(), TestScales(), CameraAt(center), timestamp_ns, 0.3);
}

TEST(SingleFrameMapBuilder, NeedsAHundredClosePoints) {
  const SingleFrameMapBuilder builder(TestStereoCamera(), TestScales());
  EXPECT_TRUE(builder.CanBuild(See(Scene(600, 3, 5, 11), {0, 0, 0}, 1)));
  EXPECT_FALSE(builder.CanBuild(See(Scene(600, 3, 20, 40), {0, 0, 0}, 1))) << "all are far";
  EXPECT_FALSE(builder.CanBuild(See(Scene(80, 3, 5, 11), {0, 0, 0}, 1)));
}

TEST(SingleFrameMapBuilder, GivesAMetricMapThatIsTracked) {
  const Scene scene(600, 3, 5, 20);
  const RigidTransform start(RotationFromVector({0, 0.5, 0}), Eigen::Vector3d(10, 0, 3));
  Frame frame = See(scene, {0, 0, 0}, 100);
  const std::unique_ptr<SlamMap> map = SingleFrameMapBuilder(TestStereoCamera(), TestScales()).Build(5, start, &frame);
  EXPECT_TRUE(map->metric_scale());
  EXPECT_EQ(map->map_id(), 5);
  EXPECT_EQ(map->live_keyframe_count(), 1);
  EXPECT_LT((map->MapFromKeyframe(frame.reference_keyframe_id).Matrix() - start.Matrix()).norm(), 1e-12);
  EXPECT_EQ(map->landmark_count(), frame.size());
  EXPECT_EQ(map->CountTracked(frame.reference_keyframe_id, 2), frame.size());
  CameraTracker tracker({}, TestStereoCamera());
  tracker.Start(*map, frame, std::nullopt);
  Frame next = See(scene, {0.1, 0, 0.3}, 200);
  const TrackedPose pose = tracker.Track(map.get(), &next);
  ASSERT_TRUE(pose.tracked) << pose.reason;
  const Eigen::Vector3d moved = (start.Inverse() * next.camera_from_map.Inverse()).translation;
  EXPECT_LT((moved - Eigen::Vector3d(0.1, 0, 0.3)).norm(), 0.03);
}

TEST(KeyframePolicy, WantsAKeyframeForNewClosePoints) {
  const KeyframePolicy policy({});
  TrackingQuality quality{1000, 3, true, 190, 200};
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
  quality.close_tracked = 99, quality.close_new = 71;
  EXPECT_TRUE(policy.NeedsKeyframe(quality));
  quality.close_tracked = 100;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
  quality.close_tracked = 99, quality.close_new = 70;
  EXPECT_FALSE(policy.NeedsKeyframe(quality));
}

}  // namespace
}  // namespace kinemap
