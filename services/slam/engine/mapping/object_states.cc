// SPDX-License-Identifier: Apache-2.0
#include "mapping/object_states.h"

#include <set>

namespace kinemap {

int ObjectStates::Update(const std::vector<ObjectRow>& rows, int64_t timestamp_ns, SlamMap* map) {
  std::set<uint32_t> started, stands;
  for (const ObjectRow& row : rows) {
    const auto [entry, is_new] = state_of_object_.try_emplace(row.id, row.state);
    if (is_new || entry->second == row.state) continue;
    entry->second = row.state;
    if (row.state == MotionState::kMoving) started.insert(row.id);
    if (row.state == MotionState::kNonMoving || row.state == MotionState::kStatic) stands.insert(row.id);
  }
  int ended = 0;
  for (const uint32_t object_id : started) ended += End(object_id, timestamp_ns, map);
  for (const uint32_t object_id : stands) Decide(object_id, map);
  return ended;
}

int ObjectStates::End(uint32_t object_id, int64_t timestamp_ns, SlamMap* map) {
  int ended = 0;
  for (const LandmarkId id : map->LandmarksOfObject(object_id)) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr || landmark->object_id != object_id || landmark->valid_until_ns != kStillValid) continue;
    // A sighting of a moving object has its own time and needs no end.
    if (landmark->state == MotionState::kMoving) continue;
    landmark->valid_until_ns = timestamp_ns;
    map->MarkChanged(*landmark);
    ++ended;
  }
  return ended;
}

void ObjectStates::Decide(uint32_t object_id, SlamMap* map) {
  for (const LandmarkId id : map->LandmarksOfObject(object_id)) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr || landmark->object_id != object_id || landmark->valid_until_ns != kStillValid) continue;
    if (landmark->state != MotionState::kUndecided) continue;
    landmark->state = MotionState::kNonMoving;
    map->MarkChanged(*landmark);
  }
}

}  // namespace kinemap
