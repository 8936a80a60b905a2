// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/place_matcher.h"

#include <algorithm>
#include <map>
#include <set>

#include "features/rotation_consistency.h"

namespace kinemap {
namespace {

constexpr double kWordRatio = 0.8;

/// Of matches that meet in one train keypoint the nearest stays.
template <typename Key>
std::vector<LandmarkMatch> NearestOfEach(const std::vector<LandmarkMatch>& matches, Key key) {
  std::map<int64_t, LandmarkMatch> nearest;
  for (const LandmarkMatch& match : matches) {
    const auto [entry, is_new] = nearest.try_emplace(key(match), match);
    if (!is_new && match.distance < entry->second.distance) entry->second = match;
  }
  std::vector<LandmarkMatch> kept;
  for (const auto& [number, match] : nearest) kept.push_back(match);
  return kept;
}

}  // namespace

KeypointsByNode::KeypointsByNode(const SlamMap& map, const Keyframe& keyframe, const BagOfWords& bag)
    : features_(keyframe.features) {
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i) {
    if (bag.node_of_keypoint[i] == BagOfWords::kNoNode) continue;
    const Landmark* landmark = map.FindLandmark(keyframe.landmark_ids[i]);
    if (landmark == nullptr || !IsLasting(*landmark)) continue;
    entries_.push_back(
        {bag.node_of_keypoint[i], static_cast<int>(i), landmark->id, &keyframe.features->descriptors[i]});
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.node != b.node ? a.node < b.node : a.keypoint < b.keypoint;
  });
}

std::vector<LandmarkMatch> MatchByWords(const KeypointsByNode& one, const KeypointsByNode& other) {
  std::vector<LandmarkMatch> matches;
  std::map<LandmarkId, int> keypoint_of_landmark;
  auto first = other.entries().begin(), last = first;
  for (const KeypointsByNode::Entry& entry : one.entries()) {
    while (first != other.entries().end() && first->node < entry.node) last = ++first;
    while (last != other.entries().end() && last->node == entry.node) ++last;
    const KeypointsByNode::Entry* best = nullptr;
    int best_distance = 257, second_distance = 257;
    for (auto candidate = first; candidate != last; ++candidate) {
      const int distance = HammingDistance(*entry.descriptor, *candidate->descriptor);
      if (distance < best_distance) {
        second_distance = best_distance, best_distance = distance, best = &*candidate;
      } else if (distance < second_distance) {
        second_distance = distance;
      }
    }
    if (best_distance > kStrictHammingDistance || best_distance >= kWordRatio * second_distance) continue;
    matches.push_back({entry.keypoint, best->landmark_id, best_distance});
    keypoint_of_landmark.try_emplace(best->landmark_id, best->keypoint);
  }
  matches = NearestOfEach(matches, [](const LandmarkMatch& match) { return match.landmark_id; });
  RotationConsistency rotation;
  for (size_t i = 0; i < matches.size(); ++i) {
    rotation.Add(static_cast<int>(i), one.angle_deg(matches[i].keypoint),
                 other.angle_deg(keypoint_of_landmark[matches[i].landmark_id]));
  }
  std::set<int> inconsistent;
  for (const int match : rotation.Inconsistent()) inconsistent.insert(match);
  std::vector<LandmarkMatch> consistent;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (inconsistent.count(static_cast<int>(i)) == 0) consistent.push_back(matches[i]);
  }
  return consistent;
}

std::vector<LandmarkMatch> MatchByProjection(const SlamMap& map, const std::vector<LandmarkId>& landmarks,
                                             const CameraModel& camera, const RigidTransform& camera_from_map,
                                             const Keyframe& keyframe, double radius_px, int max_distance) {
  const Eigen::Vector3d center = camera_from_map.Inverse().translation;
  KeypointSearch search;
  std::vector<LandmarkMatch> matches;
  for (const LandmarkId id : landmarks) {
    const Landmark* landmark = map.FindLandmark(id);
    if (landmark == nullptr || landmark->observations.count(keyframe.id) > 0) continue;
    const auto view =
        PredictView(*landmark, map.PositionInMap(*landmark), camera_from_map, center, camera, map.scales());
    if (!view) continue;
    const SearchWindow window{view->pixel_px, radius_px * map.scales().scale(view->octave), view->octave - 1,
                              view->octave + 1};
    const int best = search.FindBest(*keyframe.features, landmark->descriptor, window, max_distance, 1.0,
                                     [&](int keypoint) { return IsLasting(keyframe.labels[keypoint]); });
    if (best >= 0) matches.push_back({best, landmark->id, search.distance()});
  }
  return NearestOfEach(matches, [](const LandmarkMatch& match) { return match.keypoint; });
}

}  // namespace kinemap
