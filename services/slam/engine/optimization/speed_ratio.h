// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/rigid_transform.h"

namespace kinemap {

/// By how much a camera became faster from one interval to the next: the logarithm of the ratio of its mean speeds.
/// Unlike a difference it is the same in any unit, so a map cannot lower it by shrinking.
struct SpeedRatio {
  /// The camera's poses, in the order of time, and what lies between them.
  SpeedRatio(const std::array<RigidTransform, 3>& camera_from_map, double earlier_s, double later_s);

  double logarithm;
  std::array<Vector6d, 3> by_pose;  ///< derivatives by steps of RigidTransform::PerturbedInTarget
};

}  // namespace kinemap
