// SPDX-License-Identifier: Apache-2.0
#include "optimization/pose_manifold.h"

namespace kinemap {

void WritePose(const RigidTransform& transform, double* pose) {
  Eigen::Map<Eigen::Vector4d>(pose, 4) = transform.rotation.coeffs();
  Eigen::Map<Eigen::Vector3d>(pose + 4, 3) = transform.translation;
}

RigidTransform ReadPose(const double* pose) {
  return {Eigen::Quaterniond(pose[3], pose[0], pose[1], pose[2]), Eigen::Vector3d(pose[4], pose[5], pose[6])};
}

bool PoseManifold::Plus(const double* pose, const double* step, double* moved) const {
  WritePose(ReadPose(pose).PerturbedInTarget(Eigen::Map<const Vector6d>(step)), moved);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>> matrix(jacobian);
  matrix.setZero();
  matrix.topRows<6>().setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* to, const double* from, double* step) const {
  const RigidTransform target = ReadPose(to), source = ReadPose(from);
  const Eigen::Quaterniond turn = target.rotation * source.rotation.conjugate();
  const Eigen::AngleAxisd angle_axis(turn);
  Eigen::Map<Vector6d> result(step);
  result.tail<3>() = angle_axis.angle() * angle_axis.axis();
  result.head<3>() = target.translation - turn * source.translation;
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>> matrix(jacobian);
  matrix.setZero();
  matrix.leftCols<6>().setIdentity();
  return true;
}

}  // namespace kinemap
