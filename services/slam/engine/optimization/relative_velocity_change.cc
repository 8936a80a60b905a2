// SPDX-License-Identifier: Apache-2.0
#include "optimization/relative_velocity_change.h"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kLeastSpeed = 1e-12;  // a step that puts two cameras at one place gives a high cost, not none

/// Mean velocity between two poses as a camera halfway sees it, so that a steady turn does not change it.
struct MeanVelocity {
  MeanVelocity(const RigidTransform& from, const RigidTransform& to, double seconds)
      : by_center(from.rotation.slerp(0.5, to.rotation).toRotationMatrix() / seconds),
        velocity(by_center * (to.Inverse().translation - from.Inverse().translation)),
        speed(std::max(velocity.norm(), kLeastSpeed)) {}

  Eigen::Matrix3d by_center;
  Eigen::Vector3d velocity;
  double speed;
};

}  // namespace

RelativeVelocityChange::RelativeVelocityChange(const std::array<RigidTransform, 3>& camera_from_map, double earlier_s,
                                               double later_s) {
  const MeanVelocity earlier(camera_from_map[0], camera_from_map[1], earlier_s);
  const MeanVelocity later(camera_from_map[1], camera_from_map[2], later_s);
  const double weight = 1 / std::sqrt(earlier.speed * later.speed);
  const Eigen::Vector3d difference = later.velocity - earlier.velocity;
  change = weight * difference;
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  const auto of_speed = [&](const MeanVelocity& mean) -> Eigen::Matrix3d {
    return difference * mean.velocity.transpose() / (2 * mean.speed * mean.speed);
  };
  const Eigen::Matrix3d by_earlier = weight * (-unit - of_speed(earlier));
  const Eigen::Matrix3d by_later = weight * (unit - of_speed(later));
  const Eigen::Matrix3d by_first = -by_earlier * earlier.by_center, by_third = by_later * later.by_center;
  // The camera halfway turns by half of what either turns; that their axes are not quite its own is left out.
  const Eigen::Matrix3d by_earlier_turn = -0.5 * by_earlier * CrossMatrix(earlier.velocity);
  const Eigen::Matrix3d by_later_turn = -0.5 * by_later * CrossMatrix(later.velocity);
  const std::array<Eigen::Matrix3d, 3> by_center{by_first, -by_first - by_third, by_third};
  const std::array<Eigen::Matrix3d, 3> by_turn{by_earlier_turn, by_earlier_turn + by_later_turn, by_later_turn};
  for (int i = 0; i < 3; ++i) {
    // A step shifts the map before the camera, the centre the other way; its turn is about the centre.
    by_pose[i] << -by_center[i] * camera_from_map[i].rotation.conjugate().toRotationMatrix(), by_turn[i];
  }
}

}  // namespace kinemap
