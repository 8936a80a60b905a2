// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "geometry/camera_model.h"
#include "map/slam_map.h"
#include "tracking/map_initializer.h"

namespace kinemap {

/// A new map of two keyframes, or the reason why it was not good enough.
struct BuiltMap {
  std::unique_ptr<SlamMap> map;
  Frame current;  ///< with pose, matches and reference keyframe
  bool metric_scale = false;
  std::string reason;
};

/// Makes a map of an initial pair: bundle adjustment of both views, then its scale: metres when the second view knows
/// depths, else a median scene depth of 1.
class InitialMapBuilder {
 public:
  InitialMapBuilder(const CameraModel& camera, const PyramidScales& scales) : camera_(camera), scales_(scales) {}

  BuiltMap Build(int64_t map_id, const RigidTransform& map_from_first_camera, const InitialMap& initial,
                 const Frame& current) const;

 private:
  void AddKeyframes(const RigidTransform& map_from_first_camera, const InitialMap& initial, BuiltMap* built) const;
  void Adjust(SlamMap* map) const;
  static void Rescale(double factor, SlamMap* map);

  CameraModel camera_;
  PyramidScales scales_;
};

}  // namespace kinemap
