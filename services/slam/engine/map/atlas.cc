// SPDX-License-Identifier: Apache-2.0
#include "map/atlas.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace kinemap {

SlamMap& Atlas::Add(std::unique_ptr<SlamMap> map) {
  if (Find(map->map_id()) != nullptr) {
    throw std::logic_error("atlas: map " + std::to_string(map->map_id()) + " is there already");
  }
  next_map_id_ = std::max(next_map_id_, map->map_id() + 1);
  active_ = map.get();
  const auto place =
      std::find_if(maps_.begin(), maps_.end(), [&](const auto& other) { return other->map_id() > active_->map_id(); });
  maps_.insert(place, std::move(map));
  return *active_;
}

SlamMap* Atlas::Find(int64_t map_id) {
  for (const auto& map : maps_) {
    if (map->map_id() == map_id) return map.get();
  }
  return nullptr;
}

SlamMap* Atlas::MapOf(KeyframeId keyframe_id) {
  for (const auto& map : maps_) {
    if (map->FindKeyframe(keyframe_id) != nullptr) return map.get();
  }
  return nullptr;
}

void Atlas::Merge(int64_t from_map_id, int64_t into_map_id, const SimilarityTransform& into_from_from) {
  SlamMap* into = Find(into_map_id);
  const auto from =
      std::find_if(maps_.begin(), maps_.end(), [&](const auto& map) { return map->map_id() == from_map_id; });
  if (into == nullptr || from == maps_.end() || from->get() == into) {
    throw std::logic_error("atlas: cannot merge map " + std::to_string(from_map_id) + " into " +
                           std::to_string(into_map_id));
  }
  into->Absorb(std::move(**from), into_from_from);
  if (active_ == from->get()) active_ = into;
  maps_.erase(from);
}

}  // namespace kinemap
