// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace kinemap {

/// How a lens bends what a pinhole would show; coefficients in OpenCV's order.
enum class Lens {
  kPlumbBob,       ///< Brown and Conrady: k1, k2, p1, p2, k3 of the distance from the axis at depth 1
  kKannalaBrandt,  ///< Kannala and Brandt 2006: k1, k2, k3, k4 of the angle from the axis (fisheye)
};

/// A pinhole camera behind a lens, alone or as the left one of a rectified pair with equal lenses. Everything but
/// Undistort and Distort knows the undistorted image only.
/// Camera frame: x right, y down, z forward. Pixels have their centre at integer coordinates.
class CameraModel {
 public:
  /// `distortion` holds 0, 4 or (plumb bob only) 5 coefficients. Throws std::invalid_argument when a size or a focal
  /// length is not positive, a value is not finite, the number of coefficients is another or the distortion cannot be
  /// undone.
  CameraModel(int width_px, int height_px, double fx_px, double fy_px, double cx_px, double cy_px,
              const std::vector<double>& distortion = {}, Lens lens = Lens::kPlumbBob);

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  double fx_px() const { return fx_px_; }
  double fy_px() const { return fy_px_; }
  double cx_px() const { return cx_px_; }
  double cy_px() const { return cy_px_; }
  /// How far the right camera stands along this one's x axis; 0: there is none. A depth camera counts as a pair whose
  /// right image nobody sees.
  double baseline_m() const { return baseline_m_; }
  bool right_is_virtual() const { return right_is_virtual_; }
  /// The same camera with another baseline. Throws std::invalid_argument when it is negative or not finite.
  CameraModel WithBaseline(double baseline_m) const;
  /// The same with a depth camera instead of a right one, which is as good as a pair with this baseline.
  CameraModel WithDepthBaseline(double baseline_m) const;
  bool is_distorted() const { return is_distorted_ || remaining_radial_ != 0; }

  /// The same camera behind a lens that bends by `radial` more than the calibration says: the distortion of a point at
  /// depth 1, p (1 + radial |p|^2), before all others. The calibrated image's box and Parameters stay what they are.
  /// Throws std::invalid_argument when it is not below kMostRemainingRadial.
  CameraModel WithRemainingRadial(double radial) const;
  static constexpr double kMostRemainingRadial = 0.1;
  double remaining_radial() const { return remaining_radial_; }

  /// All that makes up the model: two cameras with the same numbers see alike.
  std::vector<double> Parameters() const;

  /// The 3x3 calibration matrix of the undistorted camera.
  Eigen::Matrix3d Intrinsics() const;

  /// Undistorted pixel of a point in the camera frame (z > 0 is the caller's concern).
  Eigen::Vector2d Project(const Eigen::Vector3d& point_in_camera) const {
    const double inverse_depth = 1.0 / point_in_camera.z();
    return {fx_px_ * point_in_camera.x() * inverse_depth + cx_px_,
            fy_px_ * point_in_camera.y() * inverse_depth + cy_px_};
  }

  /// Undistorted column of a point in the right image; needs a baseline in the units of the point.
  double RightX(const Eigen::Vector3d& point_in_camera) const {
    return fx_px_ * (point_in_camera.x() - baseline_m_) / point_in_camera.z() + cx_px_;
  }

  /// Derivative of RightX by the point.
  Eigen::RowVector3d RightXJacobian(const Eigen::Vector3d& point_in_camera) const {
    const double inverse_depth = 1.0 / point_in_camera.z();
    return {fx_px_ * inverse_depth, 0, -fx_px_ * (point_in_camera.x() - baseline_m_) * inverse_depth * inverse_depth};
  }

  /// Column in the right image of what has this undistorted column in the left one, at a depth.
  double RightXAtDepth(double left_x_px, double depth_m) const { return left_x_px - fx_px_ * baseline_m_ / depth_m; }

  /// Metres along the optical axis.
  double DepthOfDisparity(double disparity_px) const { return fx_px_ * baseline_m_ / disparity_px; }

  /// Derivative of Project by the point (2x3).
  Eigen::Matrix<double, 2, 3> ProjectionJacobian(const Eigen::Vector3d& point_in_camera) const;

  /// Ray of an undistorted pixel, scaled to z = 1.
  Eigen::Vector3d Ray(const Eigen::Vector2d& pixel_px) const {
    return {(pixel_px.x() - cx_px_) / fx_px_, (pixel_px.y() - cy_px_) / fy_px_, 1.0};
  }

  /// Whether a raw pixel lies within 80 degrees of a fisheye's axis; beyond, the undistorted image is no longer of use.
  bool CanUndistort(const Eigen::Vector2d& raw_px) const;

  /// Raw pixel -> pixel of the undistorted camera, by iteration.
  Eigen::Vector2d Undistort(const Eigen::Vector2d& raw_px) const;

  /// Undistorted pixel -> raw pixel.
  Eigen::Vector2d Distort(const Eigen::Vector2d& pixel_px) const;

  /// How many pixels of the undistorted image here are one of the raw image, in the mean of all directions: a
  /// keypoint's error grows by as much. Only a fisheye differs from 1 enough to count.
  double SpreadAt(const Eigen::Vector2d& pixel_px) const;

  /// Smallest box that holds the undistorted image: low and high corner.
  const Eigen::Vector2d& low_corner_px() const { return low_corner_px_; }
  const Eigen::Vector2d& high_corner_px() const { return high_corner_px_; }

  bool Contains(const Eigen::Vector2d& pixel_px) const {
    return (pixel_px.array() >= low_corner_px_.array()).all() && (pixel_px.array() < high_corner_px_.array()).all();
  }

 private:
  Eigen::Vector2d DistortNormalized(const Eigen::Vector2d& normalized) const;
  Eigen::Vector2d UndistortNormalized(const Eigen::Vector2d& distorted) const;
  double FisheyeRadius(double angle_rad) const;
  double FisheyeSlope(double angle_rad) const;
  void FindCorners();

  int width_px_, height_px_;
  double fx_px_, fy_px_, cx_px_, cy_px_;
  double baseline_m_ = 0;
  bool right_is_virtual_ = false;
  Lens lens_;
  double k1_ = 0, k2_ = 0, p1_ = 0, p2_ = 0, k3_ = 0, k4_ = 0;
  bool is_distorted_ = false;  // by calibration
  double remaining_radial_ = 0;
  Eigen::Vector2d low_corner_px_, high_corner_px_;
};

}  // namespace kinemap
