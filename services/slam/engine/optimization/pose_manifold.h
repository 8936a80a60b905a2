// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/manifold.h>

#include "geometry/rigid_transform.h"

namespace kinemap {

/// A pose as Ceres sees it: quaternion x, y, z, w, then translation.
constexpr int kPoseSize = 7;

void WritePose(const RigidTransform& transform, double* pose);
RigidTransform ReadPose(const double* pose);

/// Steps of six numbers (translation, rotation vector) in the pose's target frame. Its Jacobian is the unit matrix over
/// a row of zeros: the reprojection costs hand Ceres the derivative by the step itself, and so spare two matrix
/// products an observation.
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* pose, const double* step, double* moved) const override;
  bool PlusJacobian(const double* pose, double* jacobian) const override;
  bool Minus(const double* to, const double* from, double* step) const override;
  bool MinusJacobian(const double* pose, double* jacobian) const override;
};

}  // namespace kinemap
