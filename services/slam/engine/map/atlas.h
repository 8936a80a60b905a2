// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "map/slam_map.h"

namespace kinemap {

/// All maps of a session. One is active: the camera is followed in it. The others wait for a place of theirs to be
/// recognised.
class Atlas {
 public:
  Atlas(int64_t first_map_id, const PyramidScales& scales) : next_map_id_(first_map_id), scales_(scales) {}

  /// Null while there is no map yet.
  SlamMap* active() { return active_; }
  const SlamMap* active() const { return active_; }
  /// The number of the active map, or of the next one while there is none.
  int64_t active_map_id() const { return active_ != nullptr ? active_->map_id() : next_map_id_; }
  int64_t next_map_id() const { return next_map_id_; }
  int64_t TakeMapId() { return next_map_id_++; }

  /// Numbers below `next` are taken, even where their maps went into others.
  void ReserveMapIds(int64_t next) { next_map_id_ = std::max(next_map_id_, next); }

  /// Takes in a map, which becomes the active one. Its number must not be taken.
  SlamMap& Add(std::unique_ptr<SlamMap> map);
  void Activate(int64_t map_id) { active_ = Find(map_id); }
  /// No map is active until one is added or activated.
  void Deactivate() { active_ = nullptr; }

  /// Null when there is no such map (any more).
  SlamMap* Find(int64_t map_id);
  /// The map that holds a keyframe, whichever it was made in; null when none does.
  SlamMap* MapOf(KeyframeId keyframe_id);
  /// By number.
  const std::vector<std::unique_ptr<SlamMap>>& maps() const { return maps_; }

  /// Puts all of one map into another; the active map stays active, or its survivor becomes so.
  void Merge(int64_t from_map_id, int64_t into_map_id, const SimilarityTransform& into_from_from);

  const PyramidScales& scales() const { return scales_; }

 private:
  int64_t next_map_id_;
  PyramidScales scales_;
  std::vector<std::unique_ptr<SlamMap>> maps_;
  SlamMap* active_ = nullptr;
};

}  // namespace kinemap
