// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"

namespace kinemap {

/// What is observed of a point: column and row of its pixel, and, as a third row, its column in the right image.
template <int kRows>
using ObservedPixels = Eigen::Matrix<double, kRows, 1>;

/// Squared errors, in variances, beyond which an observation is an outlier: 95 % of chi-squared.
template <int kRows>
constexpr double kOutlierBound = kRows == 3 ? 7.815 : 5.991;

/// What a calibration left in the images: a radial distortion in both (see BundleProblem::radial), and by how much the
/// right image's columns are too high.
struct CalibrationRest {
  double radial = 0;
  double right_shift_px = 0;
};

/// camera_from_map, ready for many points.
struct CameraPose {
  explicit CameraPose(const RigidTransform& camera_from_map)
      : rotation(camera_from_map.rotation.toRotationMatrix()), translation(camera_from_map.translation) {}

  /// The point in the camera frame. One that a step put behind the camera is taken just in front of it, which keeps
  /// errors finite and high.
  Eigen::Vector3d InFront(const Eigen::Vector3d& point_in_map) const;

  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

/// Where the (left) camera and, with three rows, the right one see a point; `rest` is null for an exact calibration.
template <int kRows>
ObservedPixels<kRows> Reproject(const CameraModel& camera, const CalibrationRest* rest,
                                const Eigen::Vector3d& point_in_camera);

/// Derivatives of Reproject.
template <int kRows>
struct ReprojectionJacobians {
  ReprojectionJacobians(const CameraModel& camera, const CalibrationRest* rest, const CameraPose& pose,
                        const Eigen::Vector3d& point_in_camera);

  Eigen::Matrix<double, kRows, 6> by_pose;   ///< by a step of RigidTransform::PerturbedInTarget
  Eigen::Matrix<double, kRows, 3> by_point;  ///< in the map
  Eigen::Matrix<double, kRows, 2> by_rest;   ///< by radial distortion and shift; unset where `rest` is null
};

}  // namespace kinemap
