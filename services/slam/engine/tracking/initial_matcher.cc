// SPDX-License-Identifier: Apache-2.0
#include "tracking/initial_matcher.h"

#include "features/rotation_consistency.h"
#include "map/landmark_search.h"

namespace kinemap {
namespace {
constexpr double kWindowPx = 100;
constexpr double kRatio = 0.9;
}  // namespace

InitialMatcher::InitialMatcher(const Frame& reference) {
  for (const Keypoint& keypoint : reference.features->keypoints) last_seen_px_.push_back(keypoint.pixel_px);
}

std::vector<FeatureMatch> InitialMatcher::Match(const Frame& reference, const Frame& current) {
  std::vector<int> reference_of(current.size(), -1), distance_of(current.size(), 257);
  KeypointSearch search;
  for (int i = 0; i < reference.size(); ++i) {
    const int octave = reference.features->keypoints[i].octave;
    if (!reference.IsFree(i)) continue;
    const SearchWindow window{last_seen_px_[i], kWindowPx, octave, octave};
    const int best = search.FindBest(*current.features, reference.features->descriptors[i], window,
                                     kStrictHammingDistance, kRatio, [&](int j) { return current.IsFree(j); });
    if (best < 0 || search.distance() >= distance_of[best]) continue;
    reference_of[best] = i;
    distance_of[best] = search.distance();
  }
  RotationConsistency rotation;
  for (int j = 0; j < current.size(); ++j) {
    if (reference_of[j] < 0) continue;
    rotation.Add(j, reference.features->keypoints[reference_of[j]].angle_deg, current.features->keypoints[j].angle_deg);
  }
  for (const int j : rotation.Inconsistent()) reference_of[j] = -1;
  std::vector<FeatureMatch> matches;
  for (int j = 0; j < current.size(); ++j) {
    if (reference_of[j] < 0) continue;
    last_seen_px_[reference_of[j]] = current.features->keypoints[j].pixel_px;
    matches.push_back({reference_of[j], j});
  }
  return matches;
}

}  // namespace kinemap
