// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace kinemap {
namespace {

constexpr int kUndistortIterations = 20;
constexpr int kRemainingIterations = 6;  // each leaves a thirtieth of the error
constexpr int kBorderParts = 32;
constexpr double kLastFisheyeAngle = 80 * M_PI / 180;
constexpr double kOnAxis = 1e-8;

[[noreturn]] void Fail(const std::string& expectation, double value) {
  std::ostringstream message;
  message << "camera: expected " << expectation << ", got " << value;
  throw std::invalid_argument(message.str());
}

}  // namespace

CameraModel::CameraModel(int width_px, int height_px, double fx_px, double fy_px, double cx_px, double cy_px,
                         const std::vector<double>& distortion, Lens lens)
    : width_px_(width_px),
      height_px_(height_px),
      fx_px_(fx_px),
      fy_px_(fy_px),
      cx_px_(cx_px),
      cy_px_(cy_px),
      lens_(lens) {
  if (width_px <= 0) Fail("a positive width in pixels", width_px);
  if (height_px <= 0) Fail("a positive height in pixels", height_px);
  if (!(fx_px > 0) || !std::isfinite(fx_px)) Fail("a positive focal length fx", fx_px);
  if (!(fy_px > 0) || !std::isfinite(fy_px)) Fail("a positive focal length fy", fy_px);
  if (!std::isfinite(cx_px)) Fail("a finite principal point cx", cx_px);
  if (!std::isfinite(cy_px)) Fail("a finite principal point cy", cy_px);
  const bool fisheye = lens == Lens::kKannalaBrandt;
  if (fisheye && distortion.size() != 4) {
    Fail("4 fisheye coefficients (k1, k2, k3, k4)", static_cast<double>(distortion.size()));
  }
  if (!fisheye && !distortion.empty() && distortion.size() != 4 && distortion.size() != 5) {
    Fail("0, 4 or 5 distortion coefficients (k1, k2, p1, p2, k3)", static_cast<double>(distortion.size()));
  }
  is_distorted_ = fisheye;
  for (const double coefficient : distortion) {
    if (!std::isfinite(coefficient)) Fail("finite distortion coefficients", coefficient);
    is_distorted_ |= coefficient != 0;
  }
  if (fisheye) {
    k1_ = distortion[0], k2_ = distortion[1], k3_ = distortion[2], k4_ = distortion[3];
  } else if (!distortion.empty()) {
    k1_ = distortion[0], k2_ = distortion[1], p1_ = distortion[2], p2_ = distortion[3];
    if (distortion.size() == 5) k3_ = distortion[4];
  }
  low_corner_px_ = Eigen::Vector2d::Zero();
  high_corner_px_ = Eigen::Vector2d(width_px, height_px);
  if (is_distorted_) FindCorners();
}

void CameraModel::FindCorners() {
  low_corner_px_.setConstant(1e9), high_corner_px_.setConstant(-1e9);
  // The image's border maps to curves; their extremes lie at the corners or the middles of the sides, but for what a
  // fisheye's border loses beyond its last angle.
  const int parts = lens_ == Lens::kKannalaBrandt ? kBorderParts : 2;
  for (int i = 0; i <= parts; ++i) {
    for (int j = 0; j <= parts; ++j) {
      if (i % parts != 0 && j % parts != 0) continue;
      const Eigen::Vector2d raw(static_cast<double>(i) * width_px_ / parts,
                                static_cast<double>(j) * height_px_ / parts);
      const Eigen::Vector2d pixel = Undistort(raw);
      if (CanUndistort(raw) && !((Distort(pixel) - raw).norm() < 1)) {
        std::ostringstream message;
        message << "camera: expected a distortion that can be undone everywhere in the image, got one that cannot at "
                << "pixel (" << raw.x() << ", " << raw.y() << ")";
        throw std::invalid_argument(message.str());
      }
      low_corner_px_ = low_corner_px_.cwiseMin(pixel);
      high_corner_px_ = high_corner_px_.cwiseMax(pixel);
    }
  }
}

CameraModel CameraModel::WithBaseline(double baseline_m) const {
  if (!(baseline_m >= 0) || !std::isfinite(baseline_m)) Fail("a stereo baseline of 0 m or more", baseline_m);
  CameraModel camera = *this;
  camera.baseline_m_ = baseline_m;
  camera.right_is_virtual_ = false;
  return camera;
}

CameraModel CameraModel::WithDepthBaseline(double baseline_m) const {
  CameraModel camera = WithBaseline(baseline_m);
  camera.right_is_virtual_ = true;
  return camera;
}

CameraModel CameraModel::WithRemainingRadial(double radial) const {
  if (!(std::abs(radial) < kMostRemainingRadial)) Fail("a remaining radial distortion below 0.1", radial);
  CameraModel camera = *this;
  camera.remaining_radial_ = radial;
  return camera;
}

std::vector<double> CameraModel::Parameters() const {
  return {static_cast<double>(width_px_),
          static_cast<double>(height_px_),
          fx_px_,
          fy_px_,
          cx_px_,
          cy_px_,
          k1_,
          k2_,
          p1_,
          p2_,
          k3_,
          k4_,
          static_cast<double>(lens_),
          baseline_m_,
          right_is_virtual_ ? 1.0 : 0.0};
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
  if (lens_ == Lens::kKannalaBrandt) {
    const double r = p.norm();
    return r < kOnAxis ? p : Eigen::Vector2d(p * (FisheyeRadius(std::atan(r)) / r));
  }
  const double r2 = p.squaredNorm();
  const double radial = 1 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
  return {p.x() * radial + 2 * p1_ * p.x() * p.y() + p2_ * (r2 + 2 * p.x() * p.x()),
          p.y() * radial + p1_ * (r2 + 2 * p.y() * p.y()) + 2 * p2_ * p.x() * p.y()};
}

Eigen::Vector2d CameraModel::Distort(const Eigen::Vector2d& pixel_px) const {
  const Eigen::Vector2d point = Ray(pixel_px).head<2>();
  const Eigen::Vector2d distorted = DistortNormalized(point * (1 + remaining_radial_ * point.squaredNorm()));
  return {fx_px_ * distorted.x() + cx_px_, fy_px_ * distorted.y() + cy_px_};
}

double CameraModel::FisheyeRadius(double angle_rad) const {
  const double a2 = angle_rad * angle_rad;
  return angle_rad * (1 + a2 * (k1_ + a2 * (k2_ + a2 * (k3_ + a2 * k4_))));
}

double CameraModel::FisheyeSlope(double angle_rad) const {
  const double a2 = angle_rad * angle_rad;
  return 1 + a2 * (3 * k1_ + a2 * (5 * k2_ + a2 * (7 * k3_ + a2 * 9 * k4_)));
}

Eigen::Vector2d CameraModel::UndistortNormalized(const Eigen::Vector2d& distorted) const {
  if (lens_ == Lens::kKannalaBrandt) {
    const double radius = distorted.norm();
    if (radius < kOnAxis) return distorted;
    double angle = std::min(radius, kLastFisheyeAngle);
    for (int i = 0; i < kUndistortIterations; ++i) {
      angle = std::clamp(angle + (radius - FisheyeRadius(angle)) / FisheyeSlope(angle), 0.0, kLastFisheyeAngle);
    }
    return distorted * (std::tan(angle) / radius);
  }
  Eigen::Vector2d estimate = distorted;
  for (int i = 0; i < kUndistortIterations; ++i) estimate += distorted - DistortNormalized(estimate);
  return estimate;
}

bool CameraModel::CanUndistort(const Eigen::Vector2d& raw_px) const {
  return lens_ != Lens::kKannalaBrandt || Ray(raw_px).head<2>().norm() < FisheyeRadius(kLastFisheyeAngle);
}

Eigen::Vector2d CameraModel::Undistort(const Eigen::Vector2d& raw_px) const {
  if (!is_distorted()) return raw_px;
  Eigen::Vector2d point = Ray(raw_px).head<2>();
  if (is_distorted_) point = UndistortNormalized(point);
  if (remaining_radial_ != 0) {
    const Eigen::Vector2d bent = point;
    for (int i = 0; i < kRemainingIterations; ++i) point = bent / (1 + remaining_radial_ * point.squaredNorm());
  }
  return {fx_px_ * point.x() + cx_px_, fy_px_ * point.y() + cy_px_};
}

double CameraModel::SpreadAt(const Eigen::Vector2d& pixel_px) const {
  if (lens_ != Lens::kKannalaBrandt) return 1;
  const double r = Ray(pixel_px).head<2>().norm();
  if (r < kOnAxis) return 1;
  const double angle = std::atan(r);
  const double along = (1 + r * r) / FisheyeSlope(angle), across = r / FisheyeRadius(angle);
  return std::max(1.0, std::sqrt(0.5 * (along * along + across * across)));
}

}  // namespace kinemap
