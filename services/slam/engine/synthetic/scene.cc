// SPDX-License-Identifier: Apache-2.0
#include "synthetic/scene.h"

#include <map>

namespace kinemap::synthetic {

Scene::Scene(int count, double half_width, double near, double far, uint32_t seed) : noise_(seed + 1) {
  std::mt19937 random(seed);
  std::mt19937_64 bits(seed);
  std::uniform_real_distribution<double> across(-half_width, half_width), along(near, far);
  for (int i = 0; i < count; ++i) {
    points_.emplace_back(across(random), across(random), along(random));
    descriptors_.push_back({bits(), bits(), bits(), bits()});
  }
}

Frame Scene::Observe(const CameraModel& camera, const PyramidScales& scales, const RigidTransform& camera_from_map,
                     int64_t timestamp_ns, double noise_px, const std::function<FeatureLabel(int point)>& label) const {
  auto features = std::make_shared<FrameFeatures>();
  Frame frame;
  std::normal_distribution<double> error(0, 1);
  observed_points_.clear();
  for (size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d in_camera = camera_from_map * points_[i];
    if (in_camera.z() < 0.1) continue;
    Keypoint keypoint;
    keypoint.pixel_px = camera.Project(in_camera) + noise_px * Eigen::Vector2d(error(noise_), error(noise_));
    if (!camera.Contains(keypoint.pixel_px)) continue;
    keypoint.raw_px = keypoint.pixel_px;
    // Every point has one size, so that its octave falls with its distance, as it does in images.
    keypoint.octave = scales.LevelOf(16.0 / in_camera.norm());
    if (camera.baseline_m() > 0) {
      keypoint.right_x_px = camera.RightX(in_camera) + noise_px * error(noise_);
      keypoint.depth_m = camera.DepthOfDisparity(keypoint.pixel_px.x() - keypoint.right_x_px);
    }
    features->keypoints.push_back(keypoint);
    features->descriptors.push_back(descriptors_[i]);
    frame.labels.push_back(label ? label(static_cast<int>(i)) : FeatureLabel{});
    observed_points_.push_back(static_cast<int>(i));
  }
  features->grid = KeypointGrid(features->keypoints, camera.low_corner_px(), camera.high_corner_px());
  frame.timestamp_ns = timestamp_ns;
  frame.features = features;
  frame.camera_from_map = camera_from_map;
  frame.ForgetMatches();
  return frame;
}

CameraModel TestCamera() { return {640, 480, 500, 500, 320, 240}; }

CameraModel TestStereoCamera() { return TestCamera().WithBaseline(0.3); }

Frame WithDepths(const Frame& frame, const std::function<double(int keypoint)>& depth_of) {
  auto features = std::make_shared<FrameFeatures>(*frame.features);
  for (int i = 0; i < features->size(); ++i) features->keypoints[i].depth_m = depth_of(i);
  Frame measured = frame;
  measured.features = features;
  return measured;
}

PyramidScales TestScales() { return {8, 1.2}; }

RigidTransform CameraAt(const Eigen::Vector3d& center, double yaw_rad) {
  const RigidTransform map_from_camera(Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY())),
                                       center);
  return map_from_camera.Inverse();
}

SlamMap MapOf(const Scene& scene, const CameraModel& camera, const std::vector<RigidTransform>& cameras_from_map,
              double noise_px, int64_t interval_ns) {
  SlamMap map(0, TestScales());
  std::map<int, LandmarkId> landmark_of_point;
  std::map<int, std::pair<KeyframeId, int>> first_sight;
  for (size_t k = 0; k < cameras_from_map.size(); ++k) {
    const int64_t timestamp_ns = static_cast<int64_t>(k + 1) * interval_ns;
    const Frame frame = scene.Observe(camera, TestScales(), cameras_from_map[k], timestamp_ns, noise_px);
    const KeyframeId id = map.InsertKeyframe(frame).id;
    const std::vector<int>& points = scene.observed_points();
    for (int i = 0; i < frame.size(); ++i) {
      const int point = points[i];
      if (landmark_of_point.count(point) > 0) {
        map.Observe(map.FindLandmark(landmark_of_point[point]), id, i);
      } else if (first_sight.count(point) > 0) {
        // A landmark exists from its second view on, as it does after triangulation.
        const auto [first_id, first_keypoint] = first_sight[point];
        Landmark& landmark = map.CreateLandmark(scene.points()[point], first_id, frame.labels[i]);
        map.Observe(&landmark, first_id, first_keypoint);
        map.Observe(&landmark, id, i);
        landmark_of_point[point] = landmark.id;
      } else {
        first_sight[point] = {id, i};
      }
    }
  }
  for (const LandmarkId id : map.LiveLandmarks()) {
    map.UpdateDescriptor(map.FindLandmark(id));
    map.UpdateViewRange(map.FindLandmark(id));
  }
  for (const KeyframeId id : map.LiveKeyframes()) map.UpdateCovisibility(id);
  return map;
}

}  // namespace kinemap::synthetic
