// SPDX-License-Identifier: Apache-2.0
#include "optimization/reprojection_cost.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "optimization/radial_projection.h"

namespace kinemap {
namespace {

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

}  // namespace

template <int kRows>
bool ReprojectionCost<kRows>::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PointInCamera in_camera(parameters[0], parameters[1]);
  ObservedPixels<kRows> expected_px;
  expected_px.template head<2>() = camera_.Project(in_camera.point);
  if constexpr (kRows == 3) expected_px[2] = camera_.RightX(in_camera.point);
  Eigen::Map<ObservedPixels<kRows>> residual(residuals);
  residual = inverse_sigma_ * (expected_px - observed_px_);
  if (jacobians == nullptr) return true;
  Eigen::Matrix<double, kRows, 3> projection;
  projection.template topRows<2>() = inverse_sigma_ * camera_.ProjectionJacobian(in_camera.point);
  if constexpr (kRows == 3) projection.row(2) = inverse_sigma_ * camera_.RightXJacobian(in_camera.point);
  WritePoseAndPointJacobians<kRows>(projection, in_camera, jacobians);
  return true;
}

template <int kRows>
bool RadialReprojectionCost<kRows>::Evaluate(double const* const* parameters, double* residuals,
                                             double** jacobians) const {
  const PointInCamera in_camera(parameters[0], parameters[1]);
  const double radial = parameters[2][0];
  ObservedPixels<kRows> expected_px;
  expected_px.template head<2>() = ProjectRadial(camera_, radial, in_camera.point);
  if constexpr (kRows == 3) expected_px[2] = RightXRadial(camera_, radial, in_camera.point) + parameters[3][0];
  Eigen::Map<ObservedPixels<kRows>> residual(residuals);
  residual = inverse_sigma_ * (expected_px - observed_px_);
  if (jacobians == nullptr) return true;
  const RadialDerivatives<kRows> derivatives(camera_, radial, in_camera.point);
  WritePoseAndPointJacobians<kRows>(inverse_sigma_ * derivatives.by_point, in_camera, jacobians);
  if (jacobians[2] != nullptr) {
    Eigen::Map<ObservedPixels<kRows>> by_radial(jacobians[2]);
    by_radial = inverse_sigma_ * derivatives.by_radial;
  }
  if constexpr (kRows == 3) {
    if (jacobians[3] != nullptr) {
      Eigen::Map<Eigen::Vector3d> by_shift(jacobians[3]);
      by_shift = Eigen::Vector3d(0, 0, inverse_sigma_);
    }
  }
  return true;
}

template class ReprojectionCost<2>;
template class ReprojectionCost<3>;
template class RadialReprojectionCost<2>;
template class RadialReprojectionCost<3>;

bool ZeroPriorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  residuals[0] = parameters[0][0] / sigma_;
  if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = 1 / sigma_;
  return true;
}

}  // namespace kinemap
