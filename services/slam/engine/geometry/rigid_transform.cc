// SPDX-License-Identifier: Apache-2.0
#include "geometry/rigid_transform.h"

#include <sstream>
#include <stdexcept>

namespace kinemap {

RigidTransform RigidTransform::FromMatrix(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool orthonormal = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-4;
  if (!matrix.allFinite() || !orthonormal || rotation.determinant() < 0) {
    std::ostringstream message;
    message << "expected a rigid 4x4 transform (rotation and translation), got\n" << matrix;
    throw std::invalid_argument(message.str());
  }
  return {Eigen::Quaterniond(rotation), matrix.topRightCorner<3, 1>()};
}

Eigen::Matrix4d RigidTransform::Matrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

RigidTransform RigidTransform::Inverse() const {
  const Eigen::Quaterniond inverse = rotation.conjugate();
  return {inverse, -(inverse * translation)};
}

RigidTransform RigidTransform::PerturbedInTarget(const Vector6d& step) const {
  const Eigen::Quaterniond turn = RotationFromVector(step.tail<3>());
  return {turn * rotation, turn * translation + step.head<3>()};
}

Vector6d RigidTransform::StepInTargetFrom(const RigidTransform& from) const {
  const Eigen::Quaterniond turn = rotation * from.rotation.conjugate();
  const Eigen::AngleAxisd angle_axis(turn);
  Vector6d step;
  step << translation - turn * from.translation, angle_axis.angle() * angle_axis.axis();
  return step;
}

Eigen::Quaterniond RotationFromVector(const Eigen::Vector3d& rotation_vector) {
  const double half_angle = 0.5 * rotation_vector.norm();
  // sin(x)/x loses its digits near zero, where its series is exact to rounding.
  const double sinc = half_angle < 1e-5 ? 1.0 - half_angle * half_angle / 6.0 : std::sin(half_angle) / half_angle;
  const Eigen::Vector3d imaginary = 0.5 * sinc * rotation_vector;
  return Eigen::Quaterniond(std::cos(half_angle), imaginary.x(), imaginary.y(), imaginary.z()).normalized();
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace kinemap
