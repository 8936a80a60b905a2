// SPDX-License-Identifier: Apache-2.0
#include "map/covisibility_graph.h"

#include <algorithm>

namespace kinemap {

void CovisibilityGraph::SetEdges(KeyframeId keyframe_id, const std::map<KeyframeId, int>& shared_landmarks) {
  Remove(keyframe_id);
  for (const auto& [other, shared] : shared_landmarks) {
    if (other == keyframe_id || shared <= 0) continue;
    edges_[keyframe_id][other] = shared;
    edges_[other][keyframe_id] = shared;
  }
}

void CovisibilityGraph::Remove(KeyframeId keyframe_id) {
  const auto found = edges_.find(keyframe_id);
  if (found == edges_.end()) return;
  for (const auto& [other, shared] : found->second) edges_[other].erase(keyframe_id);
  edges_.erase(keyframe_id);
}

std::vector<KeyframeId> CovisibilityGraph::Neighbors(KeyframeId keyframe_id, int max_count, int min_shared) const {
  std::vector<std::pair<int, KeyframeId>> ranked;
  const auto found = edges_.find(keyframe_id);
  if (found == edges_.end()) return {};
  for (const auto& [other, shared] : found->second) {
    if (shared >= min_shared) ranked.emplace_back(-shared, other);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> neighbors;
  for (const auto& [negative_shared, other] : ranked) {
    if (static_cast<int>(neighbors.size()) == max_count) break;
    neighbors.push_back(other);
  }
  return neighbors;
}

const std::map<KeyframeId, int>& CovisibilityGraph::Edges(KeyframeId keyframe_id) const {
  static const std::map<KeyframeId, int> kNone;
  const auto found = edges_.find(keyframe_id);
  return found == edges_.end() ? kNone : found->second;
}

int CovisibilityGraph::Shared(KeyframeId a, KeyframeId b) const {
  const auto from = edges_.find(a);
  if (from == edges_.end()) return 0;
  const auto to = from->second.find(b);
  return to == from->second.end() ? 0 : to->second;
}

}  // namespace kinemap
