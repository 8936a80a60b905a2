// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "optimization/speed_ratio.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;

TEST(SpeedRatio, IsTheLogarithmOfTheSpeedsAndGivesItsDerivatives) {
  const std::array<RigidTransform, 3> poses{CameraAt({0, 0, 0}, 0.1), CameraAt({0.2, 0, 1}, 0.15),
                                            CameraAt({0.5, 0.1, 4}, 0.3)};
  const SpeedRatio ratio(poses, 0.1, 0.2);
  const double earlier = (Eigen::Vector3d(0.2, 0, 1)).norm() / 0.1;
  const double later = (Eigen::Vector3d(0.3, 0.1, 3)).norm() / 0.2;
  EXPECT_NEAR(ratio.logarithm, std::log(later / earlier), 1e-12);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      std::array<RigidTransform, 3> moved = poses;
      moved[i] = moved[i].PerturbedInTarget(kStep * Vector6d::Unit(axis));
      const double slope = (SpeedRatio(moved, 0.1, 0.2).logarithm - ratio.logarithm) / kStep;
      EXPECT_NEAR(slope, ratio.by_pose[i][axis], 1e-4) << "pose " << i << ", axis " << axis;
    }
  }
}

}  // namespace
}  // namespace kinemap
