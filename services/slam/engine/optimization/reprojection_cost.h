// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/sized_cost_function.h>

#include <type_traits>

#include "geometry/camera_model.h"
#include "optimization/pose_manifold.h"

namespace kinemap {

/// What is observed of a point: column and row of its pixel, and, as a third row, its column in the right image.
template <int kRows>
using ObservedPixels = Eigen::Matrix<double, kRows, 1>;

/// Error of one observation in units of its standard deviation, with two rows or, where there is a right image, three.
/// Parameters: pose camera_from_map of the (left) camera, point in the map.
template <int kRows>
class ReprojectionCost : public ceres::SizedCostFunction<kRows, kPoseSize, 3> {
 public:
  ReprojectionCost(const CameraModel& camera, const ObservedPixels<kRows>& observed_px, double inverse_sigma)
      : camera_(camera), observed_px_(observed_px), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CameraModel& camera_;
  ObservedPixels<kRows> observed_px_;
  double inverse_sigma_;
};

template <int kRows>
using CalibratingCost = std::conditional_t<kRows == 2, ceres::SizedCostFunction<2, kPoseSize, 3, 1>,
                                           ceres::SizedCostFunction<3, kPoseSize, 3, 1, 1>>;

/// The same with what the calibration left: a radial distortion, in both images, as third parameter and, where there is
/// a right image, a shift of its columns as fourth.
template <int kRows>
class RadialReprojectionCost : public CalibratingCost<kRows> {
 public:
  RadialReprojectionCost(const CameraModel& camera, const ObservedPixels<kRows>& observed_px, double inverse_sigma)
      : camera_(camera), observed_px_(observed_px), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CameraModel& camera_;
  ObservedPixels<kRows> observed_px_;
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

}  // namespace kinemap
