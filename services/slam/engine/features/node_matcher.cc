// SPDX-License-Identifier: Apache-2.0
#include "features/node_matcher.h"

#include <algorithm>

#include "features/rotation_consistency.h"

namespace kinemap {
namespace {

std::vector<int> ByNode(const std::vector<int>& indices, const BagOfWords& bag) {
  std::vector<int> sorted;
  for (const int index : indices) {
    if (bag.node_of_keypoint[index] != BagOfWords::kNoNode) sorted.push_back(index);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int a, int b) { return bag.node_of_keypoint[a] < bag.node_of_keypoint[b]; });
  return sorted;
}

}  // namespace

std::vector<FeatureMatch> MatchByNode(const FrameFeatures& query, const std::vector<int>& query_indices,
                                      const BagOfWords& query_bag, const FrameFeatures& train,
                                      const std::vector<int>& train_indices, const BagOfWords& train_bag,
                                      const NodeMatchLimits& limits) {
  const std::vector<int> trains = ByNode(train_indices, train_bag);
  std::vector<int> query_of_train(train.size(), -1), distance_of_train(train.size(), 257);
  size_t begin = 0, end = 0;
  for (const int q : ByNode(query_indices, query_bag)) {
    const uint32_t node = query_bag.node_of_keypoint[q];
    while (begin < trains.size() && train_bag.node_of_keypoint[trains[begin]] < node) ++begin;
    end = std::max(begin, end);
    while (end < trains.size() && train_bag.node_of_keypoint[trains[end]] == node) ++end;
    int best = -1, best_distance = 257, second_distance = 257;
    for (size_t i = begin; i < end; ++i) {
      const int distance = HammingDistance(query.descriptors[q], train.descriptors[trains[i]]);
      if (distance < best_distance) {
        second_distance = best_distance;
        best_distance = distance;
        best = trains[i];
      } else if (distance < second_distance) {
        second_distance = distance;
      }
    }
    if (best < 0 || best_distance > limits.max_distance || best_distance >= limits.ratio * second_distance) continue;
    if (best_distance >= distance_of_train[best]) continue;
    distance_of_train[best] = best_distance;
    query_of_train[best] = q;
  }
  RotationConsistency rotation;
  for (int t = 0; t < train.size(); ++t) {
    if (query_of_train[t] < 0) continue;
    rotation.Add(t, query.keypoints[query_of_train[t]].angle_deg, train.keypoints[t].angle_deg);
  }
  for (const int t : rotation.Inconsistent()) query_of_train[t] = -1;
  std::vector<FeatureMatch> matches;
  for (int t = 0; t < train.size(); ++t) {
    if (query_of_train[t] >= 0) matches.push_back({query_of_train[t], t});
  }
  return matches;
}

}  // namespace kinemap
