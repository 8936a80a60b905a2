// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "optimization/reprojection_cost.h"

namespace kinemap {

/// Error of one observation with a right image in units of its standard deviation: column and row in the left image,
/// column in the right one. Parameters: pose camera_from_map of the left camera, point in the map.
class StereoReprojectionCost : public ceres::SizedCostFunction<3, kPoseSize, 3> {
 public:
  StereoReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& pixel_px, double right_x_px,
                         double inverse_sigma)
      : camera_(camera), observed_px_(pixel_px.x(), pixel_px.y(), right_x_px), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CameraModel& camera_;
  Eigen::Vector3d observed_px_;
  double inverse_sigma_;
};

/// The same with a radial distortion, in both images, and a shift of the right image's columns as third and fourth
/// parameter.
class RadialStereoReprojectionCost : public ceres::SizedCostFunction<3, kPoseSize, 3, 1, 1> {
 public:
  RadialStereoReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& pixel_px, double right_x_px,
                               double inverse_sigma)
      : camera_(camera), observed_px_(pixel_px.x(), pixel_px.y(), right_x_px), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CameraModel& camera_;
  Eigen::Vector3d observed_px_;
  double inverse_sigma_;
};

/// Column of a point in the right image, with a radial distortion: the right camera's own, or, where a depth camera
/// stands in for it, whatever the left one's makes of the column.
double RightXRadial(const CameraModel& camera, double radial, const Eigen::Vector3d& point_in_camera);

}  // namespace kinemap
