// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace kinemap {
namespace {

constexpr int kUndistortIterations = 20;

[[noreturn]] void Fail(const std::string& expectation, double value) {
  std::ostringstream message;
  message << "camera: expected " << expectation << ", got " << value;
  throw std::invalid_argument(message.str());
}

}  // namespace

CameraModel::CameraModel(int width_px, int height_px, double fx_px, double fy_px, double cx_px, double cy_px,
                         const std::vector<double>& distortion)
    : width_px_(width_px), height_px_(height_px), fx_px_(fx_px), fy_px_(fy_px), cx_px_(cx_px), cy_px_(cy_px) {
  if (width_px <= 0) Fail("a positive width in pixels", width_px);
  if (height_px <= 0) Fail("a positive height in pixels", height_px);
  if (!(fx_px > 0) || !std::isfinite(fx_px)) Fail("a positive focal length fx", fx_px);
  if (!(fy_px > 0) || !std::isfinite(fy_px)) Fail("a positive focal length fy", fy_px);
  if (!std::isfinite(cx_px)) Fail("a finite principal point cx", cx_px);
  if (!std::isfinite(cy_px)) Fail("a finite principal point cy", cy_px);
  if (!distortion.empty() && distortion.size() != 4 && distortion.size() != 5) {
    Fail("0, 4 or 5 distortion coefficients (k1, k2, p1, p2, k3)", static_cast<double>(distortion.size()));
  }
  for (const double coefficient : distortion) {
    if (!std::isfinite(coefficient)) Fail("finite distortion coefficients", coefficient);
    is_distorted_ |= coefficient != 0;
  }
  if (!distortion.empty()) {
    k1_ = distortion[0], k2_ = distortion[1], p1_ = distortion[2], p2_ = distortion[3];
    if (distortion.size() == 5) k3_ = distortion[4];
  }
  low_corner_px_ = Eigen::Vector2d::Zero();
  high_corner_px_ = Eigen::Vector2d(width_px, height_px);
  if (is_distorted_) {
    // The image's border maps to curves; their extremes lie at the corners or the middles of the sides.
    low_corner_px_.setConstant(1e9), high_corner_px_.setConstant(-1e9);
    for (const double x : {0.0, 0.5 * width_px, 1.0 * width_px}) {
      for (const double y : {0.0, 0.5 * height_px, 1.0 * height_px}) {
        const Eigen::Vector2d pixel = Undistort({x, y});
        const double error_px = (Distort(pixel) - Eigen::Vector2d(x, y)).norm();
        if (!(error_px < 1)) Fail("a distortion that can be undone within 1 px at the image's border", error_px);
        low_corner_px_ = low_corner_px_.cwiseMin(pixel);
        high_corner_px_ = high_corner_px_.cwiseMax(pixel);
      }
    }
  }
}

CameraModel CameraModel::WithBaseline(double baseline_m) const {
  if (!(baseline_m >= 0) || !std::isfinite(baseline_m)) Fail("a stereo baseline of 0 m or more", baseline_m);
  CameraModel camera = *this;
  camera.baseline_m_ = baseline_m;
  return camera;
}

Eigen::Matrix3d CameraModel::Intrinsics() const {
  Eigen::Matrix3d intrinsics;
  intrinsics << fx_px_, 0, cx_px_, 0, fy_px_, cy_px_, 0, 0, 1;
  return intrinsics;
}

Eigen::Matrix<double, 2, 3> CameraModel::ProjectionJacobian(const Eigen::Vector3d& point) const {
  const double inverse_depth = 1.0 / point.z();
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << fx_px_ * inverse_depth, 0, -fx_px_ * point.x() * inverse_depth * inverse_depth, 0, fy_px_ * inverse_depth,
      -fy_px_ * point.y() * inverse_depth * inverse_depth;
  return jacobian;
}

Eigen::Vector2d CameraModel::DistortNormalized(const Eigen::Vector2d& p) const {
  const double r2 = p.squaredNorm();
  const double radial = 1 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
  return {p.x() * radial + 2 * p1_ * p.x() * p.y() + p2_ * (r2 + 2 * p.x() * p.x()),
          p.y() * radial + p1_ * (r2 + 2 * p.y() * p.y()) + 2 * p2_ * p.x() * p.y()};
}

Eigen::Vector2d CameraModel::Distort(const Eigen::Vector2d& pixel_px) const {
  const Eigen::Vector2d distorted = DistortNormalized(Ray(pixel_px).head<2>());
  return {fx_px_ * distorted.x() + cx_px_, fy_px_ * distorted.y() + cy_px_};
}

Eigen::Vector2d CameraModel::Undistort(const Eigen::Vector2d& raw_px) const {
  if (!is_distorted_) return raw_px;
  const Eigen::Vector2d target = Ray(raw_px).head<2>();
  Eigen::Vector2d estimate = target;
  for (int i = 0; i < kUndistortIterations; ++i) estimate += target - DistortNormalized(estimate);
  return {fx_px_ * estimate.x() + cx_px_, fy_px_ * estimate.y() + cy_px_};
}

}  // namespace kinemap
