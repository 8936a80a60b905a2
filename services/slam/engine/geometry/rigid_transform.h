// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kinemap {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid motion, named target_from_source: `point_target = target_from_source * point_source`.
struct RigidTransform {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  RigidTransform() = default;
  RigidTransform(const Eigen::Quaterniond& rotation_in, const Eigen::Vector3d& translation_in)
      : rotation(rotation_in.normalized()), translation(translation_in) {}

  /// Throws std::invalid_argument when the upper left 3x3 block is not a rotation (to 1e-4).
  static RigidTransform FromMatrix(const Eigen::Matrix4d& matrix);

  Eigen::Matrix4d Matrix() const;
  RigidTransform Inverse() const;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }
  RigidTransform operator*(const RigidTransform& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }

  /// Moves this transform by a small step (translation, rotation vector) expressed in its target frame:
  /// R' = Exp(phi) R, t' = Exp(phi) t + rho.
  RigidTransform PerturbedInTarget(const Vector6d& step) const;

  /// The step that moves `from` here: from.PerturbedInTarget(step) is this transform.
  Vector6d StepInTargetFrom(const RigidTransform& from) const;
};

/// The rotation of `rotation_vector` (axis times angle, radians).
Eigen::Quaterniond RotationFromVector(const Eigen::Vector3d& rotation_vector);

/// The matrix with CrossMatrix(a) * b == a x b.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& vector);

}  // namespace kinemap
