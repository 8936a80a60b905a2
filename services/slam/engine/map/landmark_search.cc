// SPDX-License-Identifier: Apache-2.0
#include "map/landmark_search.h"

namespace kinemap {
namespace {
constexpr double kLeastViewCosine = 0.5;
// The range of distances is known from one octave, so it is widened a little on both sides.
constexpr double kNearer = 0.8, kFarther = 1.2;
}  // namespace

std::optional<LandmarkView> PredictView(const Landmark& landmark, const Eigen::Vector3d& position_in_map,
                                        const RigidTransform& camera_from_map, const Eigen::Vector3d& center_in_map,
                                        const CameraModel& camera, const PyramidScales& scales) {
  const Eigen::Vector3d in_camera = camera_from_map * position_in_map;
  if (in_camera.z() <= 0) return std::nullopt;
  LandmarkView view;
  view.pixel_px = camera.Project(in_camera);
  if (!camera.Contains(view.pixel_px)) return std::nullopt;
  const Eigen::Vector3d sight = position_in_map - center_in_map;
  const double distance = sight.norm();
  if (distance < kNearer * landmark.min_distance || distance > kFarther * landmark.max_distance) return std::nullopt;
  view.view_cosine = sight.dot(landmark.mean_view_direction) / distance;
  if (view.view_cosine < kLeastViewCosine) return std::nullopt;
  view.octave = scales.LevelOf(landmark.max_distance / distance);
  return view;
}

}  // namespace kinemap
