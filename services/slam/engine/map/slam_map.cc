// SPDX-License-Identifier: Apache-2.0
#include "map/slam_map.h"

#include <algorithm>
#include <map>

namespace kinemap {

SlamMap::SlamMap(int64_t map_id, const PyramidScales& scales) : first_id_(map_id << 32), scales_(scales) {}

Keyframe& SlamMap::InsertKeyframe(const Frame& frame) {
  auto keyframe = std::make_unique<Keyframe>();
  keyframe->id = first_id_ + static_cast<int64_t>(keyframes_.size());
  keyframe->timestamp_ns = frame.timestamp_ns;
  keyframe->features = frame.features;
  keyframe->labels = frame.labels;
  keyframe->landmark_ids.assign(frame.size(), kNoId);
  keyframe->map_from_keyframe = frame.camera_from_map.Inverse();
  keyframes_.push_back(std::move(keyframe));
  ++live_keyframes_;
  Keyframe& inserted = *keyframes_.back();
  changed_keyframes_.insert(inserted.id);
  for (int i = 0; i < frame.size(); ++i) {
    Landmark* landmark = FindLandmark(frame.landmark_ids[i]);
    if (landmark == nullptr || landmark->observations.count(inserted.id) > 0) continue;
    Observe(landmark, inserted.id, i);
    UpdateLabel(landmark);
    UpdateDescriptor(landmark);
    UpdateViewRange(landmark);
  }
  UpdateCovisibility(inserted.id);
  return inserted;
}

std::vector<KeyframeId> SlamMap::LiveKeyframes() const {
  std::vector<KeyframeId> ids;
  for (const auto& keyframe : keyframes_) {
    if (!keyframe->culled) ids.push_back(keyframe->id);
  }
  return ids;
}

KeyframeId SlamMap::LiveKeyframe(KeyframeId id) const {
  while (keyframe(id).culled) id = keyframe(id).parent_id;
  return id;
}

RigidTransform SlamMap::MapFromKeyframe(KeyframeId id) const {
  const Keyframe& node = keyframe(id);
  if (!node.culled) return node.map_from_keyframe;
  return MapFromKeyframe(node.parent_id) * node.parent_from_keyframe;
}

void SlamMap::SetKeyframePose(KeyframeId id, const RigidTransform& map_from_keyframe) {
  mutable_keyframe(id).map_from_keyframe = map_from_keyframe;
  changed_keyframes_.insert(id);
}

void SlamMap::CullKeyframe(KeyframeId id) {
  Keyframe& keyframe = mutable_keyframe(id);
  const std::vector<KeyframeId> neighbors = covisibility_.Neighbors(id, 1);
  keyframe.parent_id = neighbors.empty() ? first_id_ : neighbors.front();
  keyframe.parent_from_keyframe = MapFromKeyframe(keyframe.parent_id).Inverse() * keyframe.map_from_keyframe;
  for (const LandmarkId landmark_id : keyframe.landmark_ids) {
    Landmark* landmark = FindLandmark(landmark_id);
    if (landmark != nullptr) EraseObservation(landmark, id);
  }
  for (const auto& landmark : landmarks_) {
    if (landmark != nullptr && landmark->anchor_id == id) Reanchor(landmark.get(), keyframe.parent_id);
  }
  covisibility_.Remove(id);
  keyframe.features.reset();
  keyframe.labels.clear();
  keyframe.landmark_ids.clear();
  keyframe.culled = true;
  --live_keyframes_;
  changed_keyframes_.insert(id);
}

void SlamMap::UpdateCovisibility(KeyframeId id) {
  std::map<KeyframeId, int> shared;
  for (const LandmarkId landmark_id : keyframe(id).landmark_ids) {
    const Landmark* landmark = FindLandmark(landmark_id);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    for (const auto& [other, keypoint] : landmark->observations) ++shared[other];
  }
  covisibility_.SetEdges(id, shared);
}

int SlamMap::CountTracked(KeyframeId id, int min_observations) const {
  int count = 0;
  for (const LandmarkId landmark_id : keyframe(id).landmark_ids) {
    const Landmark* landmark = FindLandmark(landmark_id);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    if (static_cast<int>(landmark->observations.size()) >= min_observations) ++count;
  }
  return count;
}

double SlamMap::MedianDepth(KeyframeId id) const {
  const RigidTransform keyframe_from_map = MapFromKeyframe(id).Inverse();
  std::vector<double> depths;
  for (const LandmarkId landmark_id : keyframe(id).landmark_ids) {
    const Landmark* landmark = FindLandmark(landmark_id);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    depths.push_back((keyframe_from_map * PositionInMap(*landmark)).z());
  }
  if (depths.empty()) return 0;
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return depths[depths.size() / 2];
}

MapChanges SlamMap::TakeChanges() {
  for (const auto& keyframe : keyframes_) {
    // The pose of a culled keyframe changes with any of its parents'. Parents may be younger, so follow the chain.
    for (const Keyframe* node = keyframe.get(); node->culled;) {
      node = keyframes_[node->parent_id - first_id_].get();
      if (changed_keyframes_.count(node->id) > 0 && !node->culled) changed_keyframes_.insert(keyframe->id);
    }
  }
  MapChanges changes;
  changes.keyframes.assign(changed_keyframes_.begin(), changed_keyframes_.end());
  changes.landmarks.assign(changed_landmarks_.begin(), changed_landmarks_.end());
  changes.removed_landmarks.assign(removed_landmarks_.begin(), removed_landmarks_.end());
  reported_landmarks_.insert(changed_landmarks_.begin(), changed_landmarks_.end());
  changed_keyframes_.clear();
  changed_landmarks_.clear();
  removed_landmarks_.clear();
  return changes;
}

}  // namespace kinemap
