// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "geometry/camera_model.h"

namespace kinemap {

/// The part of an image below the horizon, undistorted, at a working resolution, its brightness normalised locally so
/// that exposure and shade do not matter.
struct RoadView {
  cv::Mat intensity;  ///< CV_32F, about zero mean and unit variance where there is texture
  cv::Mat usable;     ///< CV_8U, 0 on objects and outside the image
};

/// Makes road views of one camera's images. A view is a pinhole image whose rows start a little below the horizon of a
/// level camera.
class RoadViewer {
 public:
  explicit RoadViewer(const CameraModel& camera);

  /// `image` is 8-bit grey of the camera's size. No pixel of the view is held to be on an object.
  RoadView Make(const cv::Mat& image) const;

  /// Takes out what lies on an object of `track_image` (CV_32S, 0 is background), a border around it included.
  void LeaveOutObjects(const cv::Mat& track_image, RoadView* view) const;

  double focal_px() const { return focal_px_; }
  int width_px() const { return map_.cols; }
  int height_px() const { return map_.rows; }
  /// Ray of a view's pixel in the camera frame, scaled to z = 1.
  Eigen::Vector3d Ray(double column, double row) const {
    return {(column - cx_px_) / focal_px_, (row - cy_px_) / focal_px_, 1.0};
  }
  /// Pixel of the view; z > 0 is the caller's concern.
  Eigen::Vector2d Project(const Eigen::Vector3d& in_camera) const {
    return {focal_px_ * in_camera.x() / in_camera.z() + cx_px_, focal_px_ * in_camera.y() / in_camera.z() + cy_px_};
  }

 private:
  bool halved_;
  double focal_px_, cx_px_, cy_px_;
  cv::Mat map_;         // CV_32FC2, pixel of the (halved) image
  cv::Mat object_map_;  // CV_32FC2, pixel of the image as it came
  cv::Mat inside_;      // CV_8U
};

}  // namespace kinemap
