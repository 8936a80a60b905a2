// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/slam_map.h"

namespace kinemap {

struct FuserOptions {
  int neighbors = 10;        ///< covisible keyframes of the new one
  int second_neighbors = 3;  ///< of each of these
};

/// Joins what was mapped twice: projects the landmarks of a new keyframe into its neighbours and theirs into it. A
/// landmark that meets a free keypoint gains an observation; one that meets another landmark is fused with it.
class LandmarkFuser {
 public:
  LandmarkFuser(const FuserOptions& options, const CameraModel& camera) : options_(options), camera_(camera) {}

  void Fuse(SlamMap* map, KeyframeId keyframe_id) const;

 private:
  std::vector<KeyframeId> Targets(const SlamMap& map, KeyframeId keyframe_id) const;
  void FuseInto(SlamMap* map, KeyframeId target_id, const std::vector<LandmarkId>& landmarks) const;

  FuserOptions options_;
  CameraModel camera_;
};

}  // namespace kinemap
