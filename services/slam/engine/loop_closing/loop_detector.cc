// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/loop_detector.h"

#include <algorithm>

namespace kinemap {
namespace {

constexpr int kNeighborsOfEach = 10;
constexpr int kMostNeighbors = 1000;
constexpr int kLeastShared = 15;  // below it two keyframes hardly see the same

/// The keyframe, its neighbours and theirs: what it need not recognise.
std::set<KeyframeId> Surroundings(const SlamMap& map, KeyframeId keyframe_id) {
  std::set<KeyframeId> known{keyframe_id};
  for (const auto& [neighbor, shared] : map.covisibility().Edges(keyframe_id)) {
    known.insert(neighbor);
    for (const KeyframeId second : map.covisibility().Neighbors(neighbor, kNeighborsOfEach)) known.insert(second);
  }
  return known;
}

}  // namespace

double LoopDetector::LeastSimilarity(const SlamMap& map, const PlaceIndex& places, KeyframeId keyframe_id) const {
  double least = 1;
  for (const KeyframeId neighbor : map.covisibility().Neighbors(keyframe_id, kMostNeighbors, kLeastShared)) {
    const BagOfWords* bag = places.bag(neighbor);
    if (bag != nullptr) least = std::min(least, Similarity(*places.bag(keyframe_id), *bag));
  }
  return options_.least_of_neighbors * least;
}

int LoopDetector::StreakOf(const std::set<KeyframeId>& keyframes) const {
  int streak = 0;
  for (const Group& group : last_) {
    const bool same =
        std::any_of(keyframes.begin(), keyframes.end(), [&](KeyframeId id) { return group.keyframes.count(id) > 0; });
    if (same) streak = std::max(streak, group.streak);
  }
  return streak + 1;
}

std::vector<KeyframeId> LoopDetector::Detect(Atlas* atlas, const PlaceIndex& places, KeyframeId keyframe_id) {
  const SlamMap& map = *atlas->MapOf(keyframe_id);
  const BagOfWords* bag = places.bag(keyframe_id);
  if (bag == nullptr) return {};
  const std::set<KeyframeId> known = Surroundings(map, keyframe_id);
  const double least = LeastSimilarity(map, places, keyframe_id);
  const auto neighbors = [&](KeyframeId id) {
    return atlas->MapOf(id)->covisibility().Neighbors(id, kNeighborsOfEach);
  };
  const auto accept = [&](KeyframeId id) {
    if (known.count(id) > 0) return false;
    const SlamMap* holder = atlas->MapOf(id);
    return holder != nullptr && !holder->keyframe(id).culled;
  };
  std::vector<Group> groups;
  std::vector<KeyframeId> consistent;
  for (const PlaceCandidate& candidate : places.QueryGroups(*bag, options_.candidates, accept, neighbors)) {
    if (Similarity(*bag, *places.bag(candidate.keyframe_id)) < least) continue;
    const std::vector<KeyframeId> around = neighbors(candidate.keyframe_id);
    Group group{{around.begin(), around.end()}, 0};
    group.keyframes.insert(candidate.keyframe_id);
    group.streak = StreakOf(group.keyframes);
    if (group.streak >= options_.consistent_keyframes) consistent.push_back(candidate.keyframe_id);
    groups.push_back(std::move(group));
  }
  last_ = std::move(groups);
  return consistent;
}

}  // namespace kinemap
