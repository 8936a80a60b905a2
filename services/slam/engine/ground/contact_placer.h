// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ground/object_contacts.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Moving points without a depth image: upright over where their object touches the road. Each is a landmark of its
/// own, with the time it was seen and no observation that could constrain a pose.
class ContactPlacer {
 public:
  explicit ContactPlacer(const CameraModel& camera) : camera_(camera) {}

  /// `frame` became the keyframe. Returns how many of its moving features were placed.
  int Place(SlamMap* map, KeyframeId keyframe_id, const Frame& frame, const ObjectContacts& contacts) const;

 private:
  CameraModel camera_;
};

}  // namespace kinemap
