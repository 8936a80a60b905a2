// SPDX-License-Identifier: Apache-2.0
#include "optimization/reprojection_cost.h"

#include <algorithm>

namespace kinemap {
namespace {
// A point that a step put behind the camera is evaluated just in front of it, which keeps the cost finite and high.
constexpr double kNearestDepth = 1e-6;
}  // namespace

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

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Matrix3d rotation_matrix = rotation.toRotationMatrix();
  Eigen::Vector3d point = rotation_matrix * Eigen::Map<const Eigen::Vector3d>(parameters[1]) + translation;
  point.z() = std::max(point.z(), kNearestDepth);
  Eigen::Map<Eigen::Vector2d> residual(residuals);
  residual = inverse_sigma_ * (camera_.Project(point) - pixel_px_);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, 2, 3> projection = inverse_sigma_ * camera_.ProjectionJacobian(point);
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>> by_pose(jacobians[0]);
    by_pose.leftCols<3>() = projection;
    by_pose.middleCols<3>(3) = -projection * CrossMatrix(point);
    by_pose.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> by_point(jacobians[1]);
    by_point = projection * rotation_matrix;
  }
  return true;
}

}  // namespace kinemap
