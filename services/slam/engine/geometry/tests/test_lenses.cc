// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "geometry/camera_model.h"

namespace kinemap {
namespace {

CameraModel Fisheye() { return {640, 480, 200, 200, 320, 240, {-0.02, 0.01, -0.004, 0.0005}, Lens::kKannalaBrandt}; }

TEST(Fisheye, UndistortsByTheAngleFromTheAxis) {
  const CameraModel camera = Fisheye();
  for (const double angle : {0.0, 0.01, 0.4, 0.9, 1.3}) {
    const double a2 = angle * angle;
    const double radius = angle * (1 + a2 * (-0.02 + a2 * (0.01 + a2 * (-0.004 + a2 * 0.0005))));
    const Eigen::Vector2d raw(320 + 0.6 * 200 * radius, 240 - 0.8 * 200 * radius);
    const Eigen::Vector2d pixel = camera.Undistort(raw);
    EXPECT_NEAR(camera.Ray(pixel).head<2>().norm(), std::tan(angle), 1e-6);
    EXPECT_LT((camera.Distort(pixel) - raw).norm(), 1e-6);
  }
}

TEST(Fisheye, EndsBeforeThePlaneBesideTheCamera) {
  const CameraModel camera = Fisheye();
  EXPECT_TRUE(camera.CanUndistort({320 + 200 * 1.3, 240}));
  EXPECT_FALSE(camera.CanUndistort({320 + 200 * 1.5, 240}));
  EXPECT_NEAR(camera.high_corner_px().x(), 320 + 200 * std::tan(80 * M_PI / 180), 1);
  const CameraModel pinhole(640, 480, 200, 200, 320, 240);
  EXPECT_TRUE(pinhole.CanUndistort({1e4, 1e4}));
}

TEST(Fisheye, ErrorsGrowWithTheUndistortedImage) {
  const CameraModel camera = Fisheye();
  EXPECT_EQ(camera.SpreadAt({320, 240}), 1);
  const Eigen::Vector2d raw(540, 260), pixel = camera.Undistort(raw);
  // The mean square of what steps of a pixel in two directions become.
  const double step = 1e-4;
  const double across = (camera.Undistort(raw + Eigen::Vector2d(0, step)) - pixel).norm() / step;
  const double along = (camera.Undistort(raw + Eigen::Vector2d(step, 0)) - pixel).norm() / step;
  EXPECT_NEAR(camera.SpreadAt(pixel), std::sqrt(0.5 * (along * along + across * across)), 0.02);
  EXPECT_EQ(CameraModel(640, 480, 200, 200, 320, 240, {-0.02, 0, 0, 0}).SpreadAt({600, 400}), 1);
}

TEST(Lenses, AreRefusedByName) {
  EXPECT_THROW(CameraModel(640, 480, 200, 200, 320, 240, {0, 0, 0, 0, 0}, Lens::kKannalaBrandt), std::invalid_argument);
  try {
    CameraModel(640, 480, 200, 200, 320, 240, {-3.0, 0, 0, 0});
    FAIL() << "a lens that folds the image over was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "camera: expected a distortion that can be undone everywhere in the image, got one that cannot at "
                 "pixel (0, 0)");
  }
}

TEST(Lenses, BendByWhatCalibrationLeftBeforeAnythingElse) {
  const CameraModel pinhole(640, 480, 400, 400, 320, 240);
  const CameraModel radial(640, 480, 400, 400, 320, 240, {-0.1, 0.01, 0.001, 0});
  for (const CameraModel& calibrated : {pinhole, radial, Fisheye()}) {
    const CameraModel camera = calibrated.WithRemainingRadial(0.02);
    EXPECT_TRUE(camera.is_distorted());
    EXPECT_EQ(camera.Parameters(), calibrated.Parameters());
    const Eigen::Vector3d ray(0.5, -0.3, 1);
    const double factor = 1 + 0.02 * (0.25 + 0.09);
    const Eigen::Vector2d raw = camera.Distort(camera.Project(ray));
    EXPECT_LT((raw - calibrated.Distort(calibrated.Project({factor * ray.x(), factor * ray.y(), 1}))).norm(), 1e-9);
    EXPECT_LT((camera.Undistort(raw) - camera.Project(ray)).norm(), 1e-4);
  }
  EXPECT_FALSE(pinhole.WithRemainingRadial(0).is_distorted());
  for (const double wrong : {0.1, std::nan("")}) {
    EXPECT_THROW(pinhole.WithRemainingRadial(wrong), std::invalid_argument);
  }
}

TEST(StereoPair, SeesAPointFartherLeftInTheRightImage) {
  const CameraModel camera = CameraModel(640, 480, 500, 500, 320, 240).WithBaseline(0.4);
  const Eigen::Vector3d point(1, 0.5, 8);
  const double right_x = camera.RightX(point);
  EXPECT_DOUBLE_EQ(right_x, camera.Project({1 - 0.4, 0.5, 8}).x());
  EXPECT_DOUBLE_EQ(right_x, camera.RightXAtDepth(camera.Project(point).x(), 8));
  EXPECT_DOUBLE_EQ(camera.DepthOfDisparity(camera.Project(point).x() - right_x), 8);
  EXPECT_EQ(CameraModel(640, 480, 500, 500, 320, 240).baseline_m(), 0);
  EXPECT_FALSE(camera.right_is_virtual());
  EXPECT_TRUE(camera.WithDepthBaseline(0.4).right_is_virtual());
  for (const double wrong : {-0.1, std::nan("")}) EXPECT_THROW(camera.WithBaseline(wrong), std::invalid_argument);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d moved = point;
    moved[axis] += 1e-6;
    EXPECT_NEAR((camera.RightX(moved) - right_x) / 1e-6, camera.RightXJacobian(point)[axis], 1e-3);
  }
}

}  // namespace
}  // namespace kinemap
