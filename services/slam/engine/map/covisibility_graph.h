// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "map/ids.h"

namespace kinemap {

/// Which keyframes see the same landmarks, and how many.
class CovisibilityGraph {
 public:
  /// Replaces all edges of a keyframe, on both sides.
  void SetEdges(KeyframeId keyframe_id, const std::map<KeyframeId, int>& shared_landmarks);
  void Remove(KeyframeId keyframe_id);

  /// Neighbours that share at least `min_shared` landmarks, most first, equal ones by id; at most `max_count`.
  std::vector<KeyframeId> Neighbors(KeyframeId keyframe_id, int max_count, int min_shared = 1) const;

  /// All neighbours of a keyframe and what each shares with it.
  const std::map<KeyframeId, int>& Edges(KeyframeId keyframe_id) const;

  int Shared(KeyframeId a, KeyframeId b) const;

 private:
  std::map<KeyframeId, std::map<KeyframeId, int>> edges_;
};

}  // namespace kinemap
