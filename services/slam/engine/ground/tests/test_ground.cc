// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "ground/contact_placer.h"
#include "ground/object_contacts.h"
#include "ground/road_alignment.h"
#include "ground/road_odometer.h"
#include "ground/road_view.h"
#include "ground/scale_field.h"
#include "ground/scale_smoother.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

constexpr double kHeight = 1.6;

CameraModel Camera() { return CameraModel(640, 240, 400, 400, 320, 100); }

// A texture of blobs on a plane, by place in units of length.
double RoadGrey(double x, double z) {
  return 120 + 30 * std::sin(7.1 * x + 2.7 * std::sin(1.3 * z)) +
         30 * std::sin(4.3 * z + 3.1 * std::sin(2.9 * x + 0.4 * z));
}

// What a level camera at `forward` sees of a road whose normal in the camera frame is `normal`.
cv::Mat RenderRoad(const CameraModel& camera, const Eigen::Vector3d& normal, double forward) {
  cv::Mat image(camera.height_px(), camera.width_px(), CV_8U, cv::Scalar(0));
  const double height = kHeight - forward * normal.z();
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const Eigen::Vector3d ray = camera.Ray({column, row});
      const double slope = normal.dot(ray);
      if (slope < 0.02) continue;
      const Eigen::Vector3d point = height / slope * ray;
      image.at<uint8_t>(row, column) = cv::saturate_cast<uint8_t>(RoadGrey(point.x(), point.z() + forward));
    }
  }
  return image;
}

RigidTransform OlderFromNewer(double forward) { return {Eigen::Quaterniond::Identity(), {0, 0, forward}}; }

TEST(RoadAlignment, FindsHeightAndTilt) {
  const CameraModel camera = Camera();
  const RoadViewer viewer(camera);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.01, 1, -0.015).normalized();
  const RoadView older = viewer.Make(RenderRoad(camera, normal, 0));
  const RoadView newer = viewer.Make(RenderRoad(camera, normal, 1.5));
  RoadAlignmentOptions options;
  options.tilt_sigma_rad = 0.1;  // nothing is known of the mounting
  const auto road = RoadAlignment(options, viewer).Align(newer, older, OlderFromNewer(1.5), {0, 1, 0}, 1.2, 2.2);
  ASSERT_TRUE(road);
  EXPECT_NEAR(road->plane.height, kHeight - 1.5 * normal.z(), 0.02);
  EXPECT_NEAR(road->plane.normal.z(), normal.z(), 0.005);
  EXPECT_LT(road->sigma, 0.03);
}

TEST(RoadAlignment, RefusesViewsThatShowNoCommonRoad) {
  const CameraModel camera = Camera();
  const RoadViewer viewer(camera);
  cv::Mat noise(camera.height_px(), camera.width_px(), CV_8U);
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 255);
  const RoadView older = viewer.Make(RenderRoad(camera, {0, 1, 0}, 0)), newer = viewer.Make(noise);
  EXPECT_FALSE(RoadAlignment({}, viewer).Align(newer, older, OlderFromNewer(1.5), {0, 1, 0}, 1.2, 2.2));
}

TEST(RoadView, LeavesOutObjectsOfOneViewOnly) {
  const CameraModel camera = Camera();
  const RoadViewer viewer(camera);
  const cv::Mat image = RenderRoad(camera, {0, 1, 0}, 0);
  RoadView with_object = viewer.Make(image);
  const int before = cv::countNonZero(with_object.usable);
  cv::Mat track_image(image.size(), CV_32S, cv::Scalar(0));
  track_image(cv::Rect(250, 150, 100, 60)).setTo(7);
  viewer.LeaveOutObjects(track_image, &with_object);
  EXPECT_LT(cv::countNonZero(with_object.usable), before - 100 * 60 / 2);
  EXPECT_EQ(cv::countNonZero(viewer.Make(image).usable), before);
}

TEST(ScaleField, EqualFactorsScaleTheWholeMapAboutItsFirstKeyframe) {
  const synthetic::Scene scene(200, 5, 5, 15);
  SlamMap map = synthetic::MapOf(
      scene, synthetic::TestCamera(),
      {synthetic::CameraAt({0, 0, 0}), synthetic::CameraAt({0.5, 0, 1}), synthetic::CameraAt({0, 0, 2})});
  std::vector<Eigen::Vector3d> before;
  for (const LandmarkId id : map.LiveLandmarks()) before.push_back(map.PositionInMap(*map.FindLandmark(id)));
  std::vector<ScaleChange> changes;
  for (const KeyframeId id : map.LiveKeyframes()) changes.push_back({id, std::log(3.0)});
  ApplyScaleField(changes, &map);
  size_t i = 0;
  for (const LandmarkId id : map.LiveLandmarks()) {
    EXPECT_LT((map.PositionInMap(*map.FindLandmark(id)) - 3 * before[i++]).norm(), 1e-9);
  }
  EXPECT_NEAR(map.MapFromKeyframe(map.last_keyframe_id()).translation.z(), 6, 1e-9);
}

TEST(ScaleSmoother, FollowsDriftAndBearsWrongSamples) {
  std::vector<ScaleMeasurement> measurements;
  for (int i = 0; i < 400; ++i) {
    const double truth = 0.0003 * i;
    const double noise = 0.02 * std::sin(12.9898 * i);
    measurements.push_back(
        {static_cast<double>(i), i % 10 == 3 ? truth + (i % 4 == 1 ? 0.4 : -0.4) : truth + noise, 0.015});
  }
  const std::vector<ScaleEstimate> smoothed = SmoothScale(measurements);
  for (int i = 20; i < 380; i += 40) EXPECT_NEAR(smoothed[i].log_scale, 0.0003 * i, 0.02) << i;
  EXPECT_GT(smoothed[200].sigma, 0.002);
}

TEST(ObjectContacts, StandsAnObjectOnTheRoadByItsLowerOutline) {
  const CameraModel camera = Camera();
  const GroundPlane plane{{0, 1, 0}, kHeight};
  // Feet at row 164: slope 0.16125 from row + 0.5, so 9.92 m ahead; the body between the wheels ends higher.
  cv::Mat track_image(240, 640, CV_32S, cv::Scalar(0));
  track_image(cv::Rect(300, 120, 61, 45)).setTo(4);
  track_image(cv::Rect(315, 155, 31, 10)).setTo(0);
  const ObjectContacts contacts(track_image, camera, plane);
  const double expected = kHeight / ((164.5 - 100) / 400);
  ASSERT_EQ(contacts.All().size(), 1u);
  EXPECT_EQ(contacts.All()[0].object_id, 4u);
  EXPECT_NEAR(contacts.All()[0].nearest.z(), expected, 1e-9);
  ASSERT_TRUE(contacts.Depth(4, 330));
  EXPECT_NEAR(*contacts.Depth(4, 330), expected, 1e-9);
  EXPECT_FALSE(contacts.Depth(5, 330));
}

TEST(ObjectContacts, KnowsNothingOfAnObjectCutOffBelow) {
  const GroundPlane plane{{0, 1, 0}, kHeight};
  cv::Mat track_image(240, 640, CV_32S, cv::Scalar(0));
  track_image(cv::Rect(100, 120, 60, 120)).setTo(1);  // by the image's end
  track_image(cv::Rect(300, 120, 60, 40)).setTo(2);   // by object 3
  track_image(cv::Rect(280, 160, 100, 40)).setTo(3);
  const ObjectContacts contacts(track_image, Camera(), plane);
  ASSERT_EQ(contacts.All().size(), 1u);
  EXPECT_EQ(contacts.All()[0].object_id, 3u);
}

}  // namespace
}  // namespace kinemap
