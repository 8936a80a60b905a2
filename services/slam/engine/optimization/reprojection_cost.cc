// SPDX-License-Identifier: Apache-2.0
#include "optimization/reprojection_cost.h"

#include "optimization/residual_jacobians.h"

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

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PointInCamera in_camera(parameters[0], parameters[1]);
  const Eigen::Vector3d& point = in_camera.point;
  Eigen::Map<Eigen::Vector2d> residual(residuals);
  residual = inverse_sigma_ * (camera_.Project(point) - pixel_px_);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, 2, 3> projection = inverse_sigma_ * camera_.ProjectionJacobian(point);
  WritePoseAndPointJacobians<2>(projection, in_camera, jacobians);
  return true;
}

bool RadialReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PointInCamera in_camera(parameters[0], parameters[1]);
  const Eigen::Vector3d& point = in_camera.point;
  const double radial = parameters[2][0];
  Eigen::Map<Eigen::Vector2d> residual(residuals);
  residual = inverse_sigma_ * (ProjectRadial(camera_, radial, point) - pixel_px_);
  if (jacobians == nullptr) return true;
  const RadialProjection projected(camera_, radial, point);
  const Eigen::Matrix<double, 2, 3> projection = inverse_sigma_ * projected.by_point;
  WritePoseAndPointJacobians<2>(projection, in_camera, jacobians);
  if (jacobians[2] != nullptr) {
    Eigen::Map<Eigen::Vector2d> by_radial(jacobians[2]);
    by_radial = inverse_sigma_ * projected.by_radial;
  }
  return true;
}

bool ZeroPriorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  residuals[0] = parameters[0][0] / sigma_;
  if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = 1 / sigma_;
  return true;
}

Eigen::Vector2d ProjectRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera) {
  const double r2 = (point_in_camera.head<2>() / point_in_camera.z()).squaredNorm();
  const double factor = 1 + radial * r2;
  return camera.Project({factor * point_in_camera.x(), factor * point_in_camera.y(), point_in_camera.z()});
}

}  // namespace kinemap
