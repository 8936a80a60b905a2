// SPDX-License-Identifier: Apache-2.0
#include "optimization/stereo_reprojection_cost.h"

#include "optimization/residual_jacobians.h"

namespace kinemap {
namespace {

Eigen::Vector3d InRightCamera(const CameraModel& camera, const Eigen::Vector3d& point) {
  return {point.x() - camera.baseline_m(), point.y(), point.z()};
}

}  // namespace

bool StereoReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PointInCamera in_camera(parameters[0], parameters[1]);
  const Eigen::Vector3d& point = in_camera.point;
  Eigen::Map<Eigen::Vector3d> residual(residuals);
  residual.head<2>() = camera_.Project(point);
  residual.z() = camera_.RightX(point);
  residual = (inverse_sigma_ * (residual - observed_px_)).eval();
  if (jacobians == nullptr) return true;
  Eigen::Matrix3d projection;
  projection.topRows<2>() = inverse_sigma_ * camera_.ProjectionJacobian(point);
  projection.row(2) = inverse_sigma_ * camera_.RightXJacobian(point);
  WritePoseAndPointJacobians<3>(projection, in_camera, jacobians);
  return true;
}

bool RadialStereoReprojectionCost::Evaluate(double const* const* parameters, double* residuals,
                                            double** jacobians) const {
  const PointInCamera in_camera(parameters[0], parameters[1]);
  const Eigen::Vector3d& point = in_camera.point;
  const double radial = parameters[2][0];
  Eigen::Map<Eigen::Vector3d> residual(residuals);
  residual.head<2>() = ProjectRadial(camera_, radial, point);
  residual.z() = RightXRadial(camera_, radial, point) + parameters[3][0];
  residual = (inverse_sigma_ * (residual - observed_px_)).eval();
  if (jacobians == nullptr) return true;
  const RadialProjection left(camera_, radial, point);
  Eigen::Matrix3d projection;
  Eigen::Vector3d by_radial;
  projection.topRows<2>() = left.by_point;
  by_radial.head<2>() = left.by_radial;
  if (camera_.right_is_virtual()) {
    const double by_depth = camera_.fx_px() * camera_.baseline_m() / (point.z() * point.z());
    projection.row(2) = left.by_point.row(0) + Eigen::RowVector3d(0, 0, by_depth);
    by_radial.z() = left.by_radial.x();
  } else {
    const RadialProjection right(camera_, radial, InRightCamera(camera_, point));
    projection.row(2) = right.by_point.row(0);
    by_radial.z() = right.by_radial.x();
  }
  projection *= inverse_sigma_;
  WritePoseAndPointJacobians<3>(projection, in_camera, jacobians);
  if (jacobians[2] != nullptr) {
    Eigen::Map<Eigen::Vector3d> scaled_by_radial(jacobians[2]);
    scaled_by_radial = inverse_sigma_ * by_radial;
  }
  if (jacobians[3] != nullptr) {
    Eigen::Map<Eigen::Vector3d> by_shift(jacobians[3]);
    by_shift = Eigen::Vector3d(0, 0, inverse_sigma_);
  }
  return true;
}

double RightXRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera) {
  if (camera.right_is_virtual()) {
    return camera.RightXAtDepth(ProjectRadial(camera, radial, point_in_camera).x(), point_in_camera.z());
  }
  return ProjectRadial(camera, radial, InRightCamera(camera, point_in_camera)).x();
}

}  // namespace kinemap
