// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"

namespace kinemap {

/// A pose as Ceres sees it: quaternion x, y, z, w, then translation.
constexpr int kPoseSize = 7;

void WritePose(const RigidTransform& transform, double* pose);
RigidTransform ReadPose(const double* pose);

/// Steps of six numbers (translation, rotation vector) in the pose's target frame. Its Jacobian is the unit matrix over
/// a row of zeros: the cost below hands Ceres the derivative by the step itself, and so spares two matrix products an
/// observation.
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* pose, const double* step, double* moved) const override;
  bool PlusJacobian(const double* pose, double* jacobian) const override;
  bool Minus(const double* to, const double* from, double* step) const override;
  bool MinusJacobian(const double* pose, double* jacobian) const override;
};

/// Error of one observation in units of its standard deviation; parameters: pose camera_from_map, point in the map.
class ReprojectionCost : public ceres::SizedCostFunction<2, kPoseSize, 3> {
 public:
  ReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& pixel_px, double inverse_sigma)
      : camera_(camera), pixel_px_(pixel_px), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CameraModel& camera_;
  Eigen::Vector2d pixel_px_;
  double inverse_sigma_;
};

/// The same with a radial distortion as third parameter.
class RadialReprojectionCost : public ceres::SizedCostFunction<2, kPoseSize, 3, 1> {
 public:
  RadialReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& pixel_px, double inverse_sigma)
      : camera_(camera), pixel_px_(pixel_px), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CameraModel& camera_;
  Eigen::Vector2d pixel_px_;
  double inverse_sigma_;
};

/// Pulls what calibration left towards zero: parameter over its standard deviation.
class ZeroPriorCost : public ceres::SizedCostFunction<1, 1> {
 public:
  explicit ZeroPriorCost(double sigma) : sigma_(sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double sigma_;
};

/// Pixel of a point in the camera frame, with a radial distortion.
Eigen::Vector2d ProjectRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera);

}  // namespace kinemap
