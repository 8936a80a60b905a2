// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap::synthetic {

/// Points with descriptors of their own, seen without rendering: what a perfect feature extractor would give.
class Scene {
 public:
  /// `count` points spread over a box ahead of the origin: x, y in [-half_width, half_width], z in [near, far].
  Scene(int count, double half_width, double near, double far, uint32_t seed = 1);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  std::vector<Eigen::Vector3d>& points() { return points_; }

  /// The frame a camera at this pose takes; keypoints in the order of the points it sees, with Gaussian noise.
  /// `label` gives each point's label; without it all are static. A camera with a baseline knows all depths.
  Frame Observe(const CameraModel& camera, const PyramidScales& scales, const RigidTransform& camera_from_map,
                int64_t timestamp_ns, double noise_px = 0,
                const std::function<FeatureLabel(int point)>& label = nullptr) const;

  /// Which point each keypoint of the frame observed last is, in keypoint order.
  const std::vector<int>& observed_points() const { return observed_points_; }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> descriptors_;
  mutable std::vector<int> observed_points_;
  mutable std::mt19937 noise_;
};

CameraModel TestCamera();
/// The same with a right camera.
CameraModel TestStereoCamera();
PyramidScales TestScales();

/// The frame with other depths measured, by keypoint; 0: none.
Frame WithDepths(const Frame& frame, const std::function<double(int keypoint)>& depth_of);

/// camera_from_map of a camera at `center`, turned by `yaw_rad` about its y axis (to the right).
RigidTransform CameraAt(const Eigen::Vector3d& center, double yaw_rad = 0);

/// A map whose keyframes stand at these poses, `interval_ns` after one another, and see all points of the scene they
/// can, exactly.
SlamMap MapOf(const Scene& scene, const CameraModel& camera, const std::vector<RigidTransform>& cameras_from_map,
              double noise_px = 0, int64_t interval_ns = 100);

}  // namespace kinemap::synthetic
