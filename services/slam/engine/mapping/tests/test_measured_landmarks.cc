// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "map/measured_landmarks.h"
#include "mapping/landmark_culler.h"
#include "mapping/late_metric_scale.h"
#include "mapping/measured_landmark_maker.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;
using synthetic::TestStereoCamera;

SlamMap MetricMap() {
  SlamMap map(0, TestScales());
  map.set_metric_scale(true);
  return map;
}

TEST(MeasuredLandmarkMaker, MapsWhatIsCloseAtFirstSight) {
  // Forty baselines are 12 m.
  const Scene scene(600, 4, 5, 30);
  SlamMap map = MetricMap();
  const Frame frame = scene.Observe(TestStereoCamera(), TestScales(), CameraAt({1, 0, 0}), 100);
  const KeyframeId id = map.InsertKeyframe(frame).id;
  const std::vector<LandmarkId> made = MeasuredLandmarkMaker(TestStereoCamera()).Make(&map, id);
  int close = 0;
  for (const Keypoint& keypoint : frame.features->keypoints) close += IsClose(TestStereoCamera(), keypoint) ? 1 : 0;
  ASSERT_GT(close, 100);
  EXPECT_EQ(static_cast<int>(made.size()), close);
  for (const LandmarkId landmark_id : made) {
    const Landmark& landmark = *map.FindLandmark(landmark_id);
    const int point = scene.observed_points()[landmark.observations.at(id)];
    EXPECT_LT((map.PositionInMap(landmark) - scene.points()[point]).norm(), 1e-6);
    EXPECT_EQ(map.CountViews(landmark), 2) << "two images see it";
    EXPECT_GT(landmark.max_distance, 0);
  }
  EXPECT_TRUE(MeasuredLandmarkMaker(TestStereoCamera()).Make(&map, id).empty()) << "all have landmarks by now";
}

TEST(MeasuredLandmarkMaker, TakesTheNearestHundredWhereNothingIsClose) {
  const Scene scene(400, 4, 20, 40);
  SlamMap map = MetricMap();
  const KeyframeId id =
      map.InsertKeyframe(scene.Observe(TestStereoCamera(), TestScales(), CameraAt({0, 0, 0}), 100)).id;
  EXPECT_EQ(MeasuredLandmarkMaker(TestStereoCamera()).Make(&map, id).size(), 100u);
}

TEST(MeasuredLandmarkMaker, NeedsMetresAndLeavesMovingThingsAlone) {
  const Scene scene(300, 3, 5, 10);
  const auto moving = [](int) { return FeatureLabel{FeatureRole::kSighted, MotionState::kMoving, 2, 3}; };
  SlamMap map = MetricMap();
  const KeyframeId id =
      map.InsertKeyframe(scene.Observe(TestStereoCamera(), TestScales(), CameraAt({0, 0, 0}), 100, 0, moving)).id;
  EXPECT_TRUE(MeasuredLandmarkMaker(TestStereoCamera()).Make(&map, id).empty());
  SlamMap without_metres(1, TestScales());
  const KeyframeId other =
      without_metres.InsertKeyframe(scene.Observe(TestStereoCamera(), TestScales(), CameraAt({0, 0, 0}), 100)).id;
  EXPECT_TRUE(MeasuredLandmarkMaker(TestStereoCamera()).Make(&without_metres, other).empty());
}

TEST(LandmarkCuller, CountsTheRightImageAsAView) {
  const Scene scene(200, 3, 5, 10);
  SlamMap map = MetricMap();
  for (int k = 0; k < 4; ++k) {
    map.InsertKeyframe(scene.Observe(TestStereoCamera(), TestScales(), CameraAt({0.2 * k, 0, 0}), 100 * (k + 1)));
  }
  const std::vector<LandmarkId> made = MeasuredLandmarkMaker(TestStereoCamera()).Make(&map, 0);
  // The first half gets a second observation, which makes four views.
  std::map<int, LandmarkId> landmark_of_point;
  scene.Observe(TestStereoCamera(), TestScales(), CameraAt({0, 0, 0}), 1);
  for (const LandmarkId id : made) {
    landmark_of_point[scene.observed_points()[map.FindLandmark(id)->observations.at(0)]] = id;
  }
  scene.Observe(TestStereoCamera(), TestScales(), CameraAt({0.2, 0, 0}), 2);
  size_t seen_again = 0;
  for (size_t i = 0; i < scene.observed_points().size() && seen_again < made.size() / 2; ++i) {
    const auto known = landmark_of_point.find(scene.observed_points()[i]);
    if (known == landmark_of_point.end()) continue;
    map.Observe(map.FindLandmark(known->second), 1, static_cast<int>(i));
    ++seen_again;
  }
  LandmarkCuller culler;
  culler.Add(made);
  for (int keyframe = 0; keyframe < 2; ++keyframe) culler.Cull(&map);
  EXPECT_EQ(map.landmark_count(), static_cast<int>(seen_again));
}

TEST(LateMetricScale, TurnsUnitsIntoMetresAboutTheFirstKeyframe) {
  const Scene scene(200, 3, 6, 12);
  SlamMap map = MapOf(scene, TestCamera(), {CameraAt({1, 0, 0}), CameraAt({1.5, 0, 0}), CameraAt({2, 0, 0})});
  LateMetricScale scale;
  scale.Look(map, 1);
  EXPECT_FALSE(scale.IsFound()) << "nothing was measured";
  // A unit of the map is 2.5 m.
  const Frame seen = scene.Observe(TestCamera(), TestScales(), CameraAt({2.2, 0, 0}), 500);
  Frame measured = synthetic::WithDepths(seen, [&](int i) {
    return i % 2 == 0 ? 0 : 2.5 * (seen.camera_from_map * scene.points()[scene.observed_points()[i]]).z();
  });
  for (int i = 0; i < measured.size(); ++i) {
    for (const LandmarkId id : map.LiveLandmarks()) {
      const bool same =
          (map.PositionInMap(*map.FindLandmark(id)) - scene.points()[scene.observed_points()[i]]).norm() < 1e-9;
      if (same) measured.landmark_ids[i] = id;
    }
  }
  scale.Look(map, map.InsertKeyframe(measured).id);
  ASSERT_TRUE(scale.IsFound());
  map.TakeChanges();
  const LandmarkId some = map.LiveLandmarks().front();
  const Eigen::Vector3d before = map.PositionInMap(*map.FindLandmark(some));
  EXPECT_NEAR(scale.Apply(&map), 2.5, 1e-9);
  EXPECT_TRUE(map.metric_scale());
  EXPECT_FALSE(scale.IsFound()) << "done";
  const Eigen::Vector3d origin(1, 0, 0);
  EXPECT_LT((map.MapFromKeyframe(0).translation - origin).norm(), 1e-9);
  EXPECT_LT((map.MapFromKeyframe(2).translation - Eigen::Vector3d(3.5, 0, 0)).norm(), 1e-9);
  EXPECT_LT((map.PositionInMap(*map.FindLandmark(some)) - (origin + 2.5 * (before - origin))).norm(), 1e-9);
  const MapChanges changes = map.TakeChanges();
  EXPECT_EQ(changes.keyframes.size(), 4u) << "all keyframes are reported again";
  EXPECT_TRUE(changes.landmarks.empty()) << "landmarks are relative to them";
}

}  // namespace
}  // namespace kinemap
