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
  if (started.empty() && stands.empty()) return 0;
  int ended = 0;
  for (const LandmarkId id : map->LiveLandmarks()) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark->object_id == 0 || landmark->valid_until_ns != kStillValid) continue;
    // A sighting of a moving object has its own time and needs no end.
    if (landmark->state == MotionState::kMoving) continue;
    if (started.count(landmark->object_id) > 0) {
      landmark->valid_until_ns = timestamp_ns;
      map->MarkChanged(*landmark);
      ++ended;
    } else if (stands.count(landmark->object_id) > 0 && landmark->state == MotionState::kUndecided) {
      landmark->state = MotionState::kNonMoving;
      map->MarkChanged(*landmark);
    }
  }
  return ended;
}

}  // namespace kinemap
