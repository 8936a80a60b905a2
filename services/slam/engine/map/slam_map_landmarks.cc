// SPDX-License-Identifier: Apache-2.0
// The half of SlamMap that is about landmarks.
#include <algorithm>
#include <map>

#include "map/slam_map.h"

namespace kinemap {

Landmark& SlamMap::CreateLandmark(const Eigen::Vector3d& position_in_map, KeyframeId anchor_id,
                                  const FeatureLabel& label) {
  auto landmark = std::make_unique<Landmark>();
  landmark->id = landmarks_.NextId(id_block_);
  landmark->anchor_id = anchor_id;
  landmark->position_in_anchor = MapFromAnchor(anchor_id).Inverse() * position_in_map;
  landmark->first_keyframe_id = anchor_id;
  landmark->first_seen_ns = landmark->last_seen_ns = keyframe(anchor_id).timestamp_ns;
  mutable_keyframe(anchor_id).anchored.push_back(landmark->id);
  SetObject(landmark.get(), label);
  Landmark& created = landmarks_.Append(id_block_, std::move(landmark));
  ++live_landmarks_;
  MarkChanged(created);
  return created;
}

Landmark* SlamMap::FindLandmark(LandmarkId id) {
  while (id != kNoId) {
    Landmark* landmark = landmarks_.Find(id);
    if (landmark != nullptr) return landmark;
    const auto survivor = fused_into_.find(id);
    id = survivor == fused_into_.end() ? kNoId : survivor->second;
  }
  return nullptr;
}

std::vector<LandmarkId> SlamMap::LiveLandmarks() const {
  std::vector<LandmarkId> ids;
  landmarks_.ForEach([&](const Landmark& landmark) { ids.push_back(landmark.id); });
  return ids;
}

void SlamMap::SetObject(Landmark* landmark, const FeatureLabel& label) {
  const bool is_new = label.object_id != 0 && landmark->object_id != label.object_id;
  if (is_new) landmarks_of_object_[label.object_id].push_back(landmark->id);
  landmark->state = label.state;
  landmark->category = label.category;
  landmark->object_id = label.object_id;
}

const std::vector<LandmarkId>& SlamMap::LandmarksOfObject(uint32_t object_id) const {
  static const std::vector<LandmarkId> kNone;
  const auto found = landmarks_of_object_.find(object_id);
  return found == landmarks_of_object_.end() ? kNone : found->second;
}

Eigen::Vector3d SlamMap::PositionInMap(const Landmark& landmark) const {
  return MapFromAnchor(landmark.anchor_id) * landmark.position_in_anchor;
}

void SlamMap::SetPositionInMap(Landmark* landmark, const Eigen::Vector3d& position_in_map) {
  landmark->position_in_anchor = MapFromAnchor(landmark->anchor_id).Inverse() * position_in_map;
  MarkChanged(*landmark);
}

void SlamMap::Observe(Landmark* landmark, KeyframeId keyframe_id, int keypoint) {
  Keyframe& keyframe = mutable_keyframe(keyframe_id);
  landmark->observations[keyframe_id] = keypoint;
  keyframe.landmark_ids[keypoint] = landmark->id;
  landmark->first_seen_ns = std::min(landmark->first_seen_ns, keyframe.timestamp_ns);
  landmark->last_seen_ns = std::max(landmark->last_seen_ns, keyframe.timestamp_ns);
  MarkChanged(*landmark);
}

void SlamMap::EraseObservation(Landmark* landmark, KeyframeId keyframe_id) {
  const auto found = landmark->observations.find(keyframe_id);
  if (found == landmark->observations.end()) return;
  mutable_keyframe(keyframe_id).landmark_ids[found->second] = kNoId;
  landmark->observations.erase(found);
  // A landmark whose end is known is the map's past and no longer needs to be seen.
  if (landmark->observations.size() < 2 && landmark->valid_until_ns == kStillValid) {
    RemoveLandmark(landmark->id);
  } else if (landmark->anchor_id == keyframe_id && !landmark->observations.empty()) {
    Reanchor(landmark, landmark->observations.begin()->first);
  }
}

void SlamMap::Reanchor(Landmark* landmark, KeyframeId anchor_id) {
  const Eigen::Vector3d position_in_map = PositionInMap(*landmark);
  landmark->anchor_id = anchor_id;
  mutable_keyframe(anchor_id).anchored.push_back(landmark->id);
  SetPositionInMap(landmark, position_in_map);
}

void SlamMap::RemoveLandmark(LandmarkId id) {
  const Landmark* landmark = landmarks_.Find(id);
  if (landmark == nullptr) return;
  for (const auto& [keyframe_id, keypoint] : landmark->observations) {
    mutable_keyframe(keyframe_id).landmark_ids[keypoint] = kNoId;
  }
  landmarks_.Remove(id);
  --live_landmarks_;
  changed_landmarks_.erase(id);
  if (reported_landmarks_.erase(id) > 0) removed_landmarks_.insert(id);
}

void SlamMap::FuseLandmarks(LandmarkId from_id, LandmarkId into_id) {
  if (from_id == into_id) return;
  Landmark* from = FindLandmark(from_id);
  Landmark* into = FindLandmark(into_id);
  const std::map<KeyframeId, int> observations = from->observations;
  into->visible += from->visible;
  into->found += from->found;
  into->first_seen_ns = std::min(into->first_seen_ns, from->first_seen_ns);
  RemoveLandmark(from_id);
  fused_into_[from_id] = into_id;
  for (const auto& [keyframe_id, keypoint] : observations) {
    if (into->observations.count(keyframe_id) == 0) Observe(into, keyframe_id, keypoint);
  }
  UpdateDescriptor(into);
  UpdateViewRange(into);
}

void SlamMap::UpdateDescriptor(Landmark* landmark) {
  std::vector<const Descriptor*> descriptors;
  for (const auto& [keyframe_id, keypoint] : landmark->observations) {
    descriptors.push_back(&keyframe(keyframe_id).features->descriptors[keypoint]);
  }
  int best_median = 257;
  std::vector<int> distances(descriptors.size());
  for (const Descriptor* candidate : descriptors) {
    for (size_t i = 0; i < descriptors.size(); ++i) distances[i] = HammingDistance(*candidate, *descriptors[i]);
    const auto middle = distances.begin() + (distances.size() - 1) / 2;
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      landmark->descriptor = *candidate;
    }
  }
}

void SlamMap::UpdateViewRange(Landmark* landmark) {
  if (landmark->observations.empty()) return;
  const Eigen::Vector3d position = PositionInMap(*landmark);
  landmark->mean_view_direction.setZero();
  for (const auto& [keyframe_id, keypoint] : landmark->observations) {
    landmark->mean_view_direction += (position - keyframe(keyframe_id).map_from_keyframe.translation).normalized();
  }
  landmark->mean_view_direction.normalize();
  const auto& [reference_id, reference_keypoint] = *landmark->observations.begin();
  const Keyframe& reference = keyframe(reference_id);
  const double distance = (position - reference.map_from_keyframe.translation).norm();
  landmark->max_distance = distance * scales_.scale(reference.features->keypoints[reference_keypoint].octave);
  landmark->min_distance = landmark->max_distance / scales_.scale(scales_.levels() - 1);
}

void SlamMap::UpdateLabel(Landmark* landmark) {
  std::map<uint32_t, int> votes;
  uint32_t winner = landmark->object_id;
  int most = 0;
  for (const auto& [keyframe_id, keypoint] : landmark->observations) {
    const uint32_t object_id = keyframe(keyframe_id).labels[keypoint].object_id;
    const int count = ++votes[object_id];
    if (count < most) continue;
    most = count;
    winner = object_id;
  }
  for (const auto& [keyframe_id, keypoint] : landmark->observations) {
    const FeatureLabel& label = keyframe(keyframe_id).labels[keypoint];
    if (label.object_id != winner) continue;
    SetObject(landmark, label);
  }
}

}  // namespace kinemap
