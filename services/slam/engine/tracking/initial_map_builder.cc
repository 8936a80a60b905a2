// SPDX-License-Identifier: Apache-2.0
#include "tracking/initial_map_builder.h"

#include "map/depth_scale.h"
#include "optimization/bundle_adjustment.h"

namespace kinemap {
namespace {
constexpr BundleOptions kInitialBundle{10, 10, 1e-6};
constexpr int kLeastTracked = 50;
}  // namespace

void InitialMapBuilder::AddKeyframes(const RigidTransform& map_from_first_camera, const InitialMap& initial,
                                     BuiltMap* built) const {
  SlamMap& map = *built->map;
  Frame reference = initial.reference;
  reference.ForgetMatches();
  reference.camera_from_map = map_from_first_camera.Inverse();
  reference.tracked_since_ns = built->current.tracked_since_ns = reference.timestamp_ns;
  built->current.ForgetMatches();
  built->current.camera_from_map = initial.motion.second_from_first * reference.camera_from_map;
  const KeyframeId first = map.InsertKeyframe(reference).id;
  const KeyframeId second = map.InsertKeyframe(built->current).id;
  built->current.reference_keyframe_id = second;
  for (size_t i = 0; i < initial.matches.size(); ++i) {
    if (!initial.motion.triangulated[i]) continue;
    const FeatureMatch& match = initial.matches[i];
    Landmark& landmark = map.CreateLandmark(map_from_first_camera * initial.motion.points_in_first[i], first,
                                            built->current.labels[match.train]);
    map.Observe(&landmark, first, match.query);
    map.Observe(&landmark, second, match.train);
    map.UpdateDescriptor(&landmark);
  }
}

void InitialMapBuilder::Adjust(SlamMap* map) const {
  BundleProblem problem;
  const KeyframeId first = map->first_keyframe_id(), last = map->last_keyframe_id();
  for (KeyframeId id = first; id <= last; ++id) {
    problem.cameras.push_back({id, map->keyframe(id).map_from_keyframe.Inverse(), id == first});
  }
  for (const LandmarkId id : map->LiveLandmarks()) {
    const Landmark& landmark = *map->FindLandmark(id);
    for (const auto& [observer, index] : landmark.observations) {
      const Keypoint& keypoint = map->keyframe(observer).features->keypoints[index];
      problem.observations.push_back({static_cast<int>(observer - first), static_cast<int>(problem.points.size()),
                                      keypoint.pixel_px, keypoint.InverseVariance(scales_)});
    }
    problem.points.push_back({id, map->PositionInMap(landmark)});
  }
  SolveBundle(camera_, kInitialBundle, &problem);
  map->SetKeyframePose(last, problem.cameras.back().camera_from_map.Inverse());
  for (const BundlePoint& point : problem.points) {
    map->SetPositionInMap(map->FindLandmark(point.landmark_id), point.position_in_map);
  }
  for (const BundleObservation& observation : problem.observations) {
    Landmark* landmark = map->FindLandmark(problem.points[observation.point].landmark_id);
    if (observation.outlier && landmark != nullptr) map->RemoveLandmark(landmark->id);
  }
}

void InitialMapBuilder::Rescale(double factor, SlamMap* map) {
  const RigidTransform origin = map->keyframe(map->first_keyframe_id()).map_from_keyframe;
  for (const KeyframeId id : map->LiveKeyframes()) {
    RigidTransform relative = origin.Inverse() * map->keyframe(id).map_from_keyframe;
    relative.translation *= factor;
    map->SetKeyframePose(id, origin * relative);
  }
  for (const LandmarkId id : map->LiveLandmarks()) map->FindLandmark(id)->position_in_anchor *= factor;
}

BuiltMap InitialMapBuilder::Build(int64_t map_id, const RigidTransform& map_from_first_camera,
                                  const InitialMap& initial, const Frame& current) const {
  BuiltMap built;
  built.map = std::make_unique<SlamMap>(map_id, scales_);
  built.current = current;
  AddKeyframes(map_from_first_camera, initial, &built);
  Adjust(built.map.get());

  const KeyframeId second = built.map->last_keyframe_id();
  const auto take_over = [&] {
    const Keyframe& keyframe = built.map->keyframe(second);
    built.current.landmark_ids = keyframe.landmark_ids;
    built.current.camera_from_map = keyframe.map_from_keyframe.Inverse();
  };
  take_over();
  const double median_depth = built.map->MedianDepth(built.map->first_keyframe_id());
  const int tracked = built.map->CountTracked(second, 2);
  if (tracked < kLeastTracked || !(median_depth > 0)) {
    built.reason = "initial map: " + std::to_string(tracked) + " points left after bundle adjustment, " +
                   std::to_string(kLeastTracked) + " needed";
    built.map.reset();
    return built;
  }
  const double units_per_metre = MapUnitsPerMetre(*built.map, built.current);
  built.metric_scale = units_per_metre > 0;
  Rescale(built.metric_scale ? 1 / units_per_metre : 1 / median_depth, built.map.get());
  for (const LandmarkId id : built.map->LiveLandmarks()) built.map->UpdateViewRange(built.map->FindLandmark(id));
  built.map->UpdateCovisibility(second);
  take_over();
  return built;
}

}  // namespace kinemap
