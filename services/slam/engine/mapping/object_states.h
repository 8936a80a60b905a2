// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "features/object_labels.h"
#include "map/slam_map.h"

namespace kinemap {

/// Follows each object's motion state and carries a change over to its landmarks: when a standing object starts moving,
/// they end here and leave tracking (they stay in the map's past); when an undecided one turns out to stand, they
/// become trackable.
class ObjectStates {
 public:
  /// `rows` are a frame's objects with measured states. Returns how many landmarks ended.
  int Update(const std::vector<ObjectRow>& rows, int64_t timestamp_ns, SlamMap* map);

  const std::map<uint32_t, MotionState>& states() const { return state_of_object_; }
  void Restore(const std::map<uint32_t, MotionState>& states) { state_of_object_ = states; }

 private:
  static int End(uint32_t object_id, int64_t timestamp_ns, SlamMap* map);
  static void Decide(uint32_t object_id, SlamMap* map);

  std::map<uint32_t, MotionState> state_of_object_;
};

}  // namespace kinemap
