// SPDX-License-Identifier: Apache-2.0
#include "optimization/reprojection.h"

#include <algorithm>

#include "optimization/radial_projection.h"

namespace kinemap {
namespace {

constexpr double kNearestDepth = 1e-6;

template <int kRows>
Eigen::Matrix<double, kRows, 3> PinholeJacobian(const CameraModel& camera, const Eigen::Vector3d& point_in_camera) {
  Eigen::Matrix<double, kRows, 3> jacobian;
  jacobian.template topRows<2>() = camera.ProjectionJacobian(point_in_camera);
  if constexpr (kRows == 3) jacobian.row(2) = camera.RightXJacobian(point_in_camera);
  return jacobian;
}

}  // namespace

Eigen::Vector3d CameraPose::InFront(const Eigen::Vector3d& point_in_map) const {
  Eigen::Vector3d point = rotation * point_in_map + translation;
  point.z() = std::max(point.z(), kNearestDepth);
  return point;
}

template <int kRows>
ObservedPixels<kRows> Reproject(const CameraModel& camera, const CalibrationRest* rest,
                                const Eigen::Vector3d& point_in_camera) {
  ObservedPixels<kRows> pixels;
  if (rest == nullptr) {
    pixels.template head<2>() = camera.Project(point_in_camera);
    if constexpr (kRows == 3) pixels[2] = camera.RightX(point_in_camera);
  } else {
    pixels.template head<2>() = ProjectRadial(camera, rest->radial, point_in_camera);
    if constexpr (kRows == 3) {
      pixels[2] = RightXRadial(camera, rest->radial, point_in_camera) + rest->right_shift_px;
    }
  }
  return pixels;
}

template <int kRows>
ReprojectionJacobians<kRows>::ReprojectionJacobians(const CameraModel& camera, const CalibrationRest* rest,
                                                    const CameraPose& pose, const Eigen::Vector3d& point_in_camera) {
  Eigen::Matrix<double, kRows, 3> projection;
  if (rest == nullptr) {
    projection = PinholeJacobian<kRows>(camera, point_in_camera);
  } else {
    const RadialDerivatives<kRows> derivatives(camera, rest->radial, point_in_camera);
    projection = derivatives.by_point;
    by_rest.col(0) = derivatives.by_radial;
    by_rest.col(1).setZero();
    if constexpr (kRows == 3) by_rest(2, 1) = 1;
  }
  by_pose.template leftCols<3>() = projection;
  by_pose.template rightCols<3>().noalias() = -projection * CrossMatrix(point_in_camera);
  by_point.noalias() = projection * pose.rotation;
}

template ObservedPixels<2> Reproject<2>(const CameraModel&, const CalibrationRest*, const Eigen::Vector3d&);
template ObservedPixels<3> Reproject<3>(const CameraModel&, const CalibrationRest*, const Eigen::Vector3d&);
template struct ReprojectionJacobians<2>;
template struct ReprojectionJacobians<3>;

}  // namespace kinemap
