// SPDX-License-Identifier: Apache-2.0
#include "features/brute_force_matcher.h"

#include "features/rotation_consistency.h"

namespace kinemap {

std::vector<FeatureMatch> MatchByDescriptor(const FrameFeatures& query, const std::vector<int>& query_indices,
                                            const FrameFeatures& train, const std::vector<int>& train_indices,
                                            double ratio) {
  std::vector<int> match_of_train(train.size(), -1), distance_of_train(train.size(), 257);
  std::vector<FeatureMatch> matches;
  for (const int q : query_indices) {
    int best = -1, best_distance = 257, second_distance = 257;
    for (const int t : train_indices) {
      const int distance = HammingDistance(query.descriptors[q], train.descriptors[t]);
      if (distance < best_distance) {
        second_distance = best_distance;
        best_distance = distance;
        best = t;
      } else if (distance < second_distance) {
        second_distance = distance;
      }
    }
    if (best < 0 || best_distance > kStrictHammingDistance || best_distance >= ratio * second_distance) continue;
    if (best_distance >= distance_of_train[best]) continue;
    distance_of_train[best] = best_distance;
    if (match_of_train[best] >= 0) {
      matches[match_of_train[best]].query = q;
    } else {
      match_of_train[best] = static_cast<int>(matches.size());
      matches.push_back({q, best});
    }
  }
  RotationConsistency rotation;
  for (size_t i = 0; i < matches.size(); ++i) {
    rotation.Add(static_cast<int>(i), query.keypoints[matches[i].query].angle_deg,
                 train.keypoints[matches[i].train].angle_deg);
  }
  std::vector<bool> keep(matches.size(), true);
  for (const int match : rotation.Inconsistent()) keep[match] = false;
  std::vector<FeatureMatch> consistent;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (keep[i]) consistent.push_back(matches[i]);
  }
  return consistent;
}

}  // namespace kinemap
