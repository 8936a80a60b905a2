// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/camera_model.h"
#include "loop_closing/loop_verifier.h"
#include "map/slam_map.h"

namespace kinemap {

/// Makes one of what was mapped twice around a recognised place, once both sides lie where they belong: the loop's own
/// matches, then all lasting landmarks around the matched keyframe, projected into the keyframes around the other one.
/// The elder landmark of two stays.
class PlaceFuser {
 public:
  explicit PlaceFuser(const CameraModel& camera) : camera_(camera) {}

  /// Both sides must be in this map. Ties the two keyframes with a loop edge.
  void Fuse(SlamMap* map, const VerifiedLoop& loop) const;

 private:
  CameraModel camera_;
};

}  // namespace kinemap
