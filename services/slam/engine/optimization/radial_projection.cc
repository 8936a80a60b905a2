// SPDX-License-Identifier: Apache-2.0
#include "optimization/radial_projection.h"

namespace kinemap {
namespace {

Eigen::Vector3d InRightCamera(const CameraModel& camera, const Eigen::Vector3d& point) {
  return {point.x() - camera.baseline_m(), point.y(), point.z()};
}

}  // namespace

Eigen::Vector2d ProjectRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera) {
  const double r2 = (point_in_camera.head<2>() / point_in_camera.z()).squaredNorm();
  const double factor = 1 + radial * r2;
  return camera.Project({factor * point_in_camera.x(), factor * point_in_camera.y(), point_in_camera.z()});
}

double RightXRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera) {
  if (camera.right_is_virtual()) {
    return camera.RightXAtDepth(ProjectRadial(camera, radial, point_in_camera).x(), point_in_camera.z());
  }
  return ProjectRadial(camera, radial, InRightCamera(camera, point_in_camera)).x();
}

template <>
RadialDerivatives<2>::RadialDerivatives(const CameraModel& camera, double radial, const Eigen::Vector3d& point) {
  const Eigen::Vector2d focal(camera.fx_px(), camera.fy_px());
  const Eigen::Vector2d normalized = point.head<2>() / point.z();
  const double r2 = normalized.squaredNorm();
  const Eigen::Matrix2d by_normalized =
      (1 + radial * r2) * Eigen::Matrix2d::Identity() + 2 * radial * normalized * normalized.transpose();
  Eigen::Matrix<double, 2, 3> normalization;
  normalization << 1, 0, -normalized.x(), 0, 1, -normalized.y();
  by_point = 1 / point.z() * focal.asDiagonal() * by_normalized * normalization;
  by_radial = r2 * focal.cwiseProduct(normalized);
}

template <>
RadialDerivatives<3>::RadialDerivatives(const CameraModel& camera, double radial, const Eigen::Vector3d& point) {
  const RadialDerivatives<2> left(camera, radial, point);
  by_point.topRows<2>() = left.by_point;
  by_radial.head<2>() = left.by_radial;
  if (camera.right_is_virtual()) {
    const double by_depth = camera.fx_px() * camera.baseline_m() / (point.z() * point.z());
    by_point.row(2) = left.by_point.row(0) + Eigen::RowVector3d(0, 0, by_depth);
    by_radial.z() = left.by_radial.x();
  } else {
    const RadialDerivatives<2> right(camera, radial, InRightCamera(camera, point));
    by_point.row(2) = right.by_point.row(0);
    by_radial.z() = right.by_radial.x();
  }
}

}  // namespace kinemap
