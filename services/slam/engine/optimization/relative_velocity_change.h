// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/rigid_transform.h"

namespace kinemap {

/// How a camera's mean velocity, in the directions of its own axes, changed from one interval to the next, as a part of
/// its speed: white noise on acceleration (Anderson and Barfoot 2015), with the velocities left out as unknowns. Unlike
/// the change itself it is the same in any unit, so a map cannot lower it by shrinking.
struct RelativeVelocityChange {
  /// The camera's poses, in the order of time, and what lies between them.
  RelativeVelocityChange(const std::array<RigidTransform, 3>& camera_from_map, double earlier_s, double later_s);

  Eigen::Vector3d change;
  std::array<Eigen::Matrix<double, 3, 6>, 3> by_pose;  ///< derivatives by steps of RigidTransform::PerturbedInTarget
};

}  // namespace kinemap
