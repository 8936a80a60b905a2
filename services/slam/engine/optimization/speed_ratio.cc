// SPDX-License-Identifier: Apache-2.0
#include "optimization/speed_ratio.h"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {
constexpr double kLeastSquaredWay = 1e-24;  // a step that puts two cameras at one place gives a high cost, not none
}  // namespace

SpeedRatio::SpeedRatio(const std::array<RigidTransform, 3>& camera_from_map, double earlier_s, double later_s) {
  std::array<RigidTransform, 3> map_from_camera;
  for (int i = 0; i < 3; ++i) map_from_camera[i] = camera_from_map[i].Inverse();
  const Eigen::Vector3d earlier = map_from_camera[1].translation - map_from_camera[0].translation;
  const Eigen::Vector3d later = map_from_camera[2].translation - map_from_camera[1].translation;
  const double earlier_squared = std::max(earlier.squaredNorm(), kLeastSquaredWay);
  const double later_squared = std::max(later.squaredNorm(), kLeastSquaredWay);
  logarithm = 0.5 * std::log(later_squared / earlier_squared) + std::log(earlier_s / later_s);
  const Eigen::Vector3d by_first = earlier / earlier_squared, by_third = later / later_squared;
  const std::array<Eigen::Vector3d, 3> by_center{by_first, -by_first - by_third, by_third};
  for (int i = 0; i < 3; ++i) {
    // A step shifts the map before the camera, the centre the other way; its turn is about the centre.
    by_pose[i] << -(camera_from_map[i].rotation * by_center[i]), Eigen::Vector3d::Zero();
  }
}

}  // namespace kinemap
