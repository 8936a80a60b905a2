// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"
#include "semi_dense/view_builder.h"

namespace kinemap::synthetic {

/// A textured wall x = any, z = wall_z + slope * x in the map, seen by pinhole cameras: images and depths in closed
/// form.
class TexturedWall {
 public:
  TexturedWall(double wall_z, double slope) : wall_z_(wall_z), slope_(slope), texture_(512, 512, CV_8U) {
    cv::RNG random(7);
    random.fill(texture_, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(texture_, texture_, {0, 0}, 2.5);
    cv::normalize(texture_, texture_, 0, 255, cv::NORM_MINMAX);
  }

  /// Depth along the optical axis of a camera at `map_from_camera`.
  double DepthAt(const CameraModel& camera, const RigidTransform& map_from_camera, double x, double y) const {
    const Eigen::Vector3d direction = map_from_camera.rotation * camera.Ray({x, y});
    const Eigen::Vector3d& center = map_from_camera.translation;
    return (wall_z_ + slope_ * center.x() - center.z()) / (direction.z() - slope_ * direction.x());
  }

  KeyframeView View(const CameraModel& camera, const RigidTransform& map_from_camera, KeyframeId id) const {
    KeyframeView view;
    view.id = id;
    view.grey.create(camera.height_px(), camera.width_px(), CV_8U);
    for (int row = 0; row < view.grey.rows; ++row) {
      for (int column = 0; column < view.grey.cols; ++column) {
        const double depth = DepthAt(camera, map_from_camera, column, row);
        const Eigen::Vector3d point = map_from_camera * (depth * camera.Ray({column, row}));
        view.grey.at<uint8_t>(row, column) = Texture(point.x(), point.y());
      }
    }
    view.range = {static_cast<float>(0.4 / wall_z_), static_cast<float>(2.5 / wall_z_)};
    ViewBuilder(camera).Complete(&view);
    return view;
  }

 private:
  uint8_t Texture(double x, double y) const {
    constexpr double kTexelsPerUnit = 60;
    const double u = x * kTexelsPerUnit + 5000 * 512, v = y * kTexelsPerUnit + 5000 * 512;
    const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
    const double du = u - column, dv = v - row;
    const auto texel = [&](int c, int r) { return static_cast<double>(texture_.at<uint8_t>(r & 511, c & 511)); };
    const double above = (1 - du) * texel(column, row) + du * texel(column + 1, row);
    const double below = (1 - du) * texel(column, row + 1) + du * texel(column + 1, row + 1);
    return cv::saturate_cast<uint8_t>((1 - dv) * above + dv * below);
  }

  double wall_z_, slope_;
  cv::Mat texture_;
};

}  // namespace kinemap::synthetic
