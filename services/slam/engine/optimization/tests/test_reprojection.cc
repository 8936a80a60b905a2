// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "optimization/reprojection.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::TestStereoCamera;

template <int kRows>
void ExpectDerivatives(const CameraModel& camera, const CalibrationRest* rest) {
  const RigidTransform pose = CameraAt({0.3, 0.1, -0.5}, 0.2);
  const Eigen::Vector3d point(1.4, -1.6, 6);
  const auto project = [&](const RigidTransform& from, const Eigen::Vector3d& at, const CalibrationRest* with) {
    return Reproject<kRows>(camera, with, CameraPose(from).InFront(at));
  };
  const ObservedPixels<kRows> pixels = project(pose, point, rest);
  const ReprojectionJacobians<kRows> by(camera, rest, CameraPose(pose), CameraPose(pose).InFront(point));
  constexpr double kStep = 1e-6, kTolerance = 2e-3;
  const auto expect = [&](const ObservedPixels<kRows>& moved, const ObservedPixels<kRows>& derivative) {
    EXPECT_LT(((moved - pixels) / kStep - derivative).cwiseAbs().maxCoeff(), kTolerance);
  };
  for (int axis = 0; axis < 6; ++axis) {
    expect(project(pose.PerturbedInTarget(kStep * Vector6d::Unit(axis)), point, rest), by.by_pose.col(axis));
  }
  for (int axis = 0; axis < 3; ++axis) {
    expect(project(pose, point + kStep * Eigen::Vector3d::Unit(axis), rest), by.by_point.col(axis));
  }
  if (rest == nullptr) return;
  const CalibrationRest bent{rest->radial + kStep, rest->right_shift_px};
  const CalibrationRest shifted{rest->radial, rest->right_shift_px + kStep};
  expect(project(pose, point, &bent), by.by_rest.col(0));
  expect(project(pose, point, &shifted), by.by_rest.col(1));
}

TEST(ReprojectionJacobians, AreDerivatives) {
  const CalibrationRest rest{-0.1, 0.3};
  for (const CameraModel& camera : {TestStereoCamera(), TestStereoCamera().WithDepthBaseline(0.3)}) {
    for (const CalibrationRest* left : {static_cast<const CalibrationRest*>(nullptr), &rest}) {
      ExpectDerivatives<2>(camera, left);
      ExpectDerivatives<3>(camera, left);
    }
  }
}

TEST(Reprojection, PointBehindTheCameraIsFarOff) {
  const Eigen::Vector3d in_front = CameraPose(CameraAt({0, 0, 0})).InFront({0.5, 0, -2});
  const Eigen::Vector2d pixel = Reproject<2>(TestStereoCamera(), nullptr, in_front);
  EXPECT_TRUE(pixel.allFinite());
  EXPECT_GT(pixel.x(), 1e5);
}

}  // namespace
}  // namespace kinemap
