// SPDX-License-Identifier: Apache-2.0
#include "map/slam_map.h"

#include <algorithm>
#include <map>
#include <utility>

namespace kinemap {

SlamMap::SlamMap(int64_t map_id, const PyramidScales& scales) : map_id_(map_id), id_block_(map_id), scales_(scales) {}

Keyframe& SlamMap::InsertKeyframe(const Frame& frame) {
  auto keyframe = std::make_unique<Keyframe>();
  keyframe->id = last_keyframe_id_ = keyframes_.NextId(id_block_);
  keyframe->timestamp_ns = frame.timestamp_ns;
  keyframe->tracked_since_ns = frame.tracked_since_ns;
  keyframe->features = frame.features;
  keyframe->labels = frame.labels;
  keyframe->landmark_ids.assign(frame.size(), kNoId);
  keyframe->map_from_keyframe = frame.camera_from_map.Inverse();
  Keyframe& inserted = keyframes_.Append(id_block_, std::move(keyframe));
  ++keyframe_count_;
  ++live_keyframes_;
  changed_keyframes_.insert(inserted.id);
  turnover_.inserted.push_back(inserted.id);
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
  keyframes_.ForEach([&](const Keyframe& keyframe) {
    if (!keyframe.culled) ids.push_back(keyframe.id);
  });
  return ids;
}

KeyframeId SlamMap::LiveKeyframe(KeyframeId id) const {
  while (keyframe(id).culled) id = keyframe(id).parent_id;
  return id;
}

SimilarityTransform SlamMap::MapFromAnchor(KeyframeId id) const {
  const Keyframe& node = keyframe(id);
  if (!node.culled) return SimilarityTransform(node.map_from_keyframe, node.scale);
  return MapFromAnchor(node.parent_id) * node.parent_from_keyframe;
}

void SlamMap::SetKeyframePose(KeyframeId id, const RigidTransform& map_from_keyframe) {
  mutable_keyframe(id).map_from_keyframe = map_from_keyframe;
  changed_keyframes_.insert(id);
}

void SlamMap::SetKeyframePose(KeyframeId id, const SimilarityTransform& map_from_anchor) {
  mutable_keyframe(id).scale = map_from_anchor.scale;
  SetKeyframePose(id, map_from_anchor.WithoutScale());
}

RigidTransform SlamMap::CameraFromReference(const RigidTransform& camera_from_map, KeyframeId reference_id) const {
  const SimilarityTransform map_from_anchor = MapFromAnchor(reference_id);
  RigidTransform camera_from_reference = camera_from_map * map_from_anchor.WithoutScale();
  camera_from_reference.translation /= map_from_anchor.scale;
  return camera_from_reference;
}

RigidTransform SlamMap::CameraFromMap(const RigidTransform& camera_from_reference, KeyframeId reference_id) const {
  const SimilarityTransform map_from_anchor = MapFromAnchor(reference_id);
  RigidTransform scaled = camera_from_reference;
  scaled.translation *= map_from_anchor.scale;
  return scaled * map_from_anchor.WithoutScale().Inverse();
}

void SlamMap::UndistortFeatures(const CameraModel& camera) {
  for (const KeyframeId id : LiveKeyframes()) {
    Keyframe& keyframe = mutable_keyframe(id);
    keyframe.features = Undistorted(*keyframe.features, camera);
  }
}

void SlamMap::AddLoopEdge(KeyframeId a, KeyframeId b) {
  mutable_keyframe(a).loop_edges.insert(b);
  mutable_keyframe(b).loop_edges.insert(a);
}

void SlamMap::CullKeyframe(KeyframeId id) {
  Keyframe& keyframe = mutable_keyframe(id);
  const std::vector<KeyframeId> neighbors = covisibility_.Neighbors(id, 1);
  keyframe.parent_id = neighbors.empty() ? first_keyframe_id() : neighbors.front();
  keyframe.parent_from_keyframe = MapFromAnchor(keyframe.parent_id).Inverse() * MapFromAnchor(id);
  for (const LandmarkId landmark_id : keyframe.landmark_ids) {
    Landmark* landmark = FindLandmark(landmark_id);
    if (landmark != nullptr) EraseObservation(landmark, id);
  }
  for (const LandmarkId landmark_id : keyframe.anchored) {
    Landmark* landmark = landmarks_.Find(landmark_id);
    if (landmark != nullptr && landmark->anchor_id == id) Reanchor(landmark, keyframe.parent_id);
  }
  keyframe.anchored = {};
  mutable_keyframe(keyframe.parent_id).culled_children.push_back(id);
  covisibility_.Remove(id);
  keyframe.features.reset();
  keyframe.labels = {};
  keyframe.landmark_ids = {};
  keyframe.culled = true;
  --live_keyframes_;
  changed_keyframes_.insert(id);
  turnover_.culled.push_back(id);
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

int SlamMap::CountViews(const Landmark& landmark) const {
  int views = static_cast<int>(landmark.observations.size());
  if (!metric_scale_) return views;
  for (const auto& [keyframe_id, keypoint] : landmark.observations) {
    views += keyframe(keyframe_id).features->keypoints[keypoint].HasDepth() ? 1 : 0;
  }
  return views;
}

int SlamMap::CountTracked(KeyframeId id, int min_views) const {
  int count = 0;
  for (const LandmarkId landmark_id : keyframe(id).landmark_ids) {
    const Landmark* landmark = FindLandmark(landmark_id);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    if (CountViews(*landmark) >= min_views) ++count;
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
  // The pose of a culled keyframe changes with that of the live one it hangs on.
  std::vector<KeyframeId> moved;
  for (const KeyframeId id : changed_keyframes_) {
    if (!keyframe(id).culled) moved.push_back(id);
  }
  while (!moved.empty()) {
    const KeyframeId id = moved.back();
    moved.pop_back();
    for (const KeyframeId child : keyframe(id).culled_children) {
      changed_keyframes_.insert(child);
      moved.push_back(child);
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

KeyframeTurnover SlamMap::TakeTurnover() { return std::exchange(turnover_, {}); }

void SlamMap::Absorb(SlamMap&& other, const SimilarityTransform& this_from_other) {
  const std::vector<KeyframeId> moved = other.LiveKeyframes();
  for (const KeyframeId id : moved) {
    other.SetKeyframePose(id, this_from_other * other.MapFromAnchor(id));
    covisibility_.SetEdges(id, other.covisibility_.Edges(id));
  }
  other.keyframes_.ForEach([&](const Keyframe& keyframe) { changed_keyframes_.insert(keyframe.id); });
  keyframes_.Absorb(std::move(other.keyframes_));
  landmarks_.Absorb(std::move(other.landmarks_));
  fused_into_.merge(other.fused_into_);
  changed_landmarks_.merge(other.changed_landmarks_);
  removed_landmarks_.merge(other.removed_landmarks_);
  for (auto& [object_id, ids] : other.landmarks_of_object_) {
    std::vector<LandmarkId>& all = landmarks_of_object_[object_id];
    all.insert(all.end(), ids.begin(), ids.end());
  }
  reported_landmarks_.merge(other.reported_landmarks_);
  const KeyframeTurnover turnover = other.TakeTurnover();
  turnover_.inserted.insert(turnover_.inserted.end(), turnover.inserted.begin(), turnover.inserted.end());
  turnover_.culled.insert(turnover_.culled.end(), turnover.culled.begin(), turnover.culled.end());
  last_keyframe_id_ = std::max(last_keyframe_id_, other.last_keyframe_id_);
  keyframe_count_ += other.keyframe_count_;
  live_keyframes_ += other.live_keyframes_;
  live_landmarks_ += other.live_landmarks_;
  for (const KeyframeId id : moved) {
    for (const LandmarkId landmark_id : keyframe(id).landmark_ids) {
      Landmark* landmark = FindLandmark(landmark_id);
      if (landmark != nullptr) UpdateViewRange(landmark);
    }
  }
}

}  // namespace kinemap
