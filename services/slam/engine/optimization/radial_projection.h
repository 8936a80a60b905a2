// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "geometry/camera_model.h"

namespace kinemap {

/// Pixel of a point in the camera frame, with a radial distortion that a calibration left.
Eigen::Vector2d ProjectRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera);

/// Column of a point in the right image, with a radial distortion: the right camera's own, or, where a depth camera
/// stands in for it, whatever the left one's makes of the column.
double RightXRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera);

/// Derivatives of the pixel and, in a third row, of the column in the right image.
template <int kRows>
struct RadialDerivatives {
  RadialDerivatives(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera);

  Eigen::Matrix<double, kRows, 3> by_point;
  Eigen::Matrix<double, kRows, 1> by_radial;
};

}  // namespace kinemap
