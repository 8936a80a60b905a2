// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "map/atlas.h"
#include "map/place_index.h"

namespace kinemap {

struct LoopDetectorOptions {
  int candidates = 3;               ///< most similar groups of keyframes that are followed
  int consistent_keyframes = 3;     ///< keyframes in a row that must find the same place
  double least_of_neighbors = 0.5;  ///< of the least similarity among the keyframe's own neighbours
};

/// Says which keyframes may show the place of a new one again: similar ones that share no landmarks with it nor with
/// its neighbours, found by three keyframes in a row in one covisible group (Mur-Artal, Montiel and Tardos 2015,
/// section VII-A). A candidate may lie in any map.
class LoopDetector {
 public:
  explicit LoopDetector(const LoopDetectorOptions& options) : options_(options) {}

  /// Candidates that are consistent by now, most similar first. To be asked for every keyframe of the active map.
  std::vector<KeyframeId> Detect(Atlas* atlas, const PlaceIndex& places, KeyframeId keyframe_id);

  /// Starts counting anew.
  void Forget() { last_.clear(); }

  /// A candidate with its neighbours, and how many keyframes in a row have found it.
  struct Group {
    std::set<KeyframeId> keyframes;
    int streak = 0;
  };
  const std::vector<Group>& last() const { return last_; }
  void Restore(std::vector<Group> last) { last_ = std::move(last); }

 private:
  double LeastSimilarity(const SlamMap& map, const PlaceIndex& places, KeyframeId keyframe_id) const;
  int StreakOf(const std::set<KeyframeId>& keyframes) const;

  LoopDetectorOptions options_;
  std::vector<Group> last_;
};

}  // namespace kinemap
