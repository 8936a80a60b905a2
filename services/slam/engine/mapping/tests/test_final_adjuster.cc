// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "mapping/final_adjuster.h"
#include "mapping/lens_finder.h"
#include "optimization/radial_projection.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

const std::vector<RigidTransform> kCameras{CameraAt({0, 0, 0}), CameraAt({0.5, 0, 0.1}, 0.05),
                                           CameraAt({1.0, 0.1, 0.1}, 0.1), CameraAt({1.5, 0, 0.3}, 0.2)};

/// What the cameras see through a lens with this distortion and a fifth of a pixel of noise, with the last camera
/// misplaced.
SlamMap MapThrough(double radial) {
  const Scene scene(400, 4, 6, 10);
  SlamMap map(0, TestScales());
  std::map<int, LandmarkId> landmark_of_point;
  for (size_t k = 0; k < kCameras.size(); ++k) {
    Frame frame = scene.Observe(TestCamera(), TestScales(), kCameras[k], static_cast<int64_t>(k + 1) * 100, 0.2);
    const std::vector<int> points = scene.observed_points();
    auto features = std::make_shared<FrameFeatures>(*frame.features);
    for (int i = 0; i < frame.size(); ++i) {
      const Eigen::Vector3d in_camera = kCameras[k] * scene.points()[points[i]];
      features->keypoints[i].pixel_px +=
          ProjectRadial(TestCamera(), radial, in_camera) - ProjectRadial(TestCamera(), 0, in_camera);
    }
    frame.features = features;
    const KeyframeId id = map.InsertKeyframe(frame).id;
    for (int i = 0; i < frame.size(); ++i) {
      const auto [entry, is_new] = landmark_of_point.try_emplace(points[i], kNoId);
      if (is_new) entry->second = map.CreateLandmark(scene.points()[points[i]], id, {}).id;
      map.Observe(map.FindLandmark(entry->second), id, i);
    }
  }
  map.SetKeyframePose(3, CameraAt({1.5, 0.05, 0.3}, 0.2).Inverse());
  return map;
}

TEST(FinalAdjuster, BelievesADistortionThatExplainsTheImages) {
  SlamMap map = MapThrough(0.03);
  FinalAdjusterOptions options;
  options.bundle.radial_sigma = 0.05;
  EXPECT_NEAR(FinalAdjuster(options, TestCamera()).Adjust(&map), 0.03, 0.01);
}

TEST(FinalAdjuster, BelievesNoMoreThanACalibrationMayHaveLeft) {
  SlamMap map = MapThrough(0.03);
  FinalAdjusterOptions options;
  options.bundle.radial_sigma = 0.05;
  EXPECT_EQ(FinalAdjuster(options, TestCamera()).Adjust(&map, 0.04), 0);
  EXPECT_NEAR(FinalAdjuster(options, TestCamera()).Adjust(&map, -0.04), 0.03, 0.01);
}

TEST(FinalAdjuster, TakesNoneFromNoiseAndStillAdjusts) {
  SlamMap map = MapThrough(0);
  EXPECT_EQ(FinalAdjuster({}, TestCamera()).Adjust(&map), 0);
  const double scale = map.MapFromKeyframe(3).translation.norm() / kCameras[3].Inverse().translation.norm();
  const Eigen::Vector3d truth = scale * kCameras[3].Inverse().translation;
  EXPECT_LT((map.MapFromKeyframe(3).translation - truth).norm(), 0.02);
}

TEST(FinalAdjuster, LeavesAMapOfTwoKeyframes) {
  SlamMap map = synthetic::MapOf(Scene(100, 2, 6, 10), TestCamera(), {kCameras[0], kCameras[1]}, 0.5);
  const Eigen::Matrix4d before = map.MapFromKeyframe(1).Matrix();
  EXPECT_EQ(FinalAdjuster({}, TestCamera()).Adjust(&map), 0);
  EXPECT_EQ(map.MapFromKeyframe(1).Matrix(), before);
}

LensFinderOptions OfFourKeyframes() {
  LensFinderOptions options;
  options.adjustment.bundle.radial_sigma = 0.05;
  options.first_keyframes = 4;
  return options;
}

TEST(LensFinder, FindsTheDistortionAtAFrameFixedWhenItBegins) {
  const SlamMap map = MapThrough(0.03);
  LensFinder finder(OfFourKeyframes(), TestCamera());
  finder.Look(map, 100);
  ASSERT_FALSE(finder.IsFree());
  int64_t due = 100;
  while (!finder.IsDue(due)) ++due;
  EXPECT_GE(due, 110);
  EXPECT_LT(due, 130);
  EXPECT_NEAR(finder.Take().radial, 0.03, 0.01);
  EXPECT_EQ(finder.next_keyframes(), 8);
  finder.Look(map, due);
  EXPECT_TRUE(finder.IsFree()) << "before the map has grown";
}

TEST(LensFinder, BelievesNothingOfAPerfectCameraAndLooksAgainSoon) {
  const SlamMap map = MapThrough(0);
  LensFinder finder(OfFourKeyframes(), TestCamera());
  finder.Look(map, 0);
  EXPECT_EQ(finder.Take().radial, 0);
  EXPECT_EQ(finder.next_keyframes(), 5);
}

TEST(LensFinder, BeginsAgainAfterItWasCancelledAndLeavesOldMapsAlone) {
  const SlamMap map = MapThrough(0.03);
  LensFinderOptions options = OfFourKeyframes();
  LensFinder finder(options, TestCamera());
  finder.Look(map, 0);
  finder.Cancel();
  EXPECT_TRUE(finder.IsFree());
  finder.Look(map, 1);
  EXPECT_FALSE(finder.IsFree());
  options.most_keyframes = 3;
  LensFinder young(options, TestCamera());
  young.Look(map, 0);
  EXPECT_TRUE(young.IsFree());
}

}  // namespace
}  // namespace kinemap
