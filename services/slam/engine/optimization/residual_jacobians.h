// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"
#include "optimization/reprojection_cost.h"

namespace kinemap {

/// A point that a step put behind the camera is evaluated just in front of it, which keeps the cost finite and high.
constexpr double kNearestDepth = 1e-6;

/// What every cost begins with: the point in the camera frame, from Ceres' pose and point.
struct PointInCamera {
  PointInCamera(const double* pose, const double* point_in_map)
      : rotation(Eigen::Map<const Eigen::Quaterniond>(pose).toRotationMatrix()),
        point(rotation * Eigen::Map<const Eigen::Vector3d>(point_in_map) +
              Eigen::Map<const Eigen::Vector3d>(pose + 4)) {
    point.z() = std::max(point.z(), kNearestDepth);
  }

  Eigen::Matrix3d rotation;
  Eigen::Vector3d point;
};

/// `projection`: derivative of the residual by the point in the camera frame.
template <int kRows>
void WritePoseAndPointJacobians(const Eigen::Matrix<double, kRows, 3>& projection, const PointInCamera& in_camera,
                                double** jacobians) {
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, kPoseSize, Eigen::RowMajor>> by_pose(jacobians[0]);
    by_pose.template leftCols<3>() = projection;
    by_pose.template middleCols<3>(3) = -projection * CrossMatrix(in_camera.point);
    by_pose.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 3, Eigen::RowMajor>> by_point(jacobians[1]);
    by_point = projection * in_camera.rotation;
  }
}

/// Derivatives of ProjectRadial.
struct RadialProjection {
  RadialProjection(const CameraModel& camera, double radial, const Eigen::Vector3d& point) {
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

  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Vector2d by_radial;
};

}  // namespace kinemap
