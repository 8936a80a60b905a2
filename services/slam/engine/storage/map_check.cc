// SPDX-License-Identifier: Apache-2.0
// What a map must hold to before anything walks through it: a file may lie in spite of its checksum.
#include <cmath>
#include <set>
#include <string>

#include "storage/map_codec.h"

namespace kinemap {
namespace {

void Require(bool holds, const char* what, int64_t id) {
  if (!holds) throw MapFileError("damaged: " + std::string(what) + " (" + std::to_string(id) + ")");
}

// Differences of what lies nearer fit into their type.
constexpr int64_t kEndOfTimeNs = int64_t{1} << 62;

bool IsPose(const RigidTransform& pose) {
  return pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1) < 1e-6;
}

bool IsScale(double scale) { return std::isfinite(scale) && scale > 0; }

bool IsState(MotionState state) { return state <= MotionState::kPotentiallyDynamic; }

}  // namespace

void MapCodec::CheckKeyframe(const SlamMap& map, const Keyframe& keyframe) {
  Require(IsPose(keyframe.map_from_keyframe) && IsScale(keyframe.scale), "pose of a keyframe", keyframe.id);
  Require(std::abs(keyframe.timestamp_ns) < kEndOfTimeNs && std::abs(keyframe.tracked_since_ns) < kEndOfTimeNs,
          "time of a keyframe", keyframe.id);
  for (const KeyframeId other : keyframe.loop_edges) {
    Require(map.FindKeyframe(other) != nullptr, "a loop to a keyframe that is not there", keyframe.id);
  }
  for (const KeyframeId child : keyframe.culled_children) {
    const Keyframe* found = map.FindKeyframe(child);
    Require(found != nullptr && found->culled && found->parent_id == keyframe.id, "a child of another", keyframe.id);
  }
  if (keyframe.culled) {
    Require(IsPose(keyframe.parent_from_keyframe.WithoutScale()) && IsScale(keyframe.parent_from_keyframe.scale),
            "pose of a culled keyframe", keyframe.id);
    const Keyframe* parent = &keyframe;
    for (int steps = 0; parent != nullptr && parent->culled; ++steps) {
      Require(steps <= map.keyframe_count(), "parents in a circle", keyframe.id);
      parent = map.FindKeyframe(parent->parent_id);
    }
    Require(parent != nullptr, "a culled keyframe without a parent", keyframe.id);
    return;
  }
  Require(keyframe.features != nullptr, "a keyframe without features", keyframe.id);
  Require(keyframe.features->keypoints.size() == keyframe.labels.size(), "features of a keyframe", keyframe.id);
  for (const FeatureLabel& label : keyframe.labels) {
    Require(label.role <= FeatureRole::kIgnored && IsState(label.state), "label of a feature", keyframe.id);
  }
}

void MapCodec::CheckLandmark(const SlamMap& map, const Landmark& landmark) {
  Require(landmark.position_in_anchor.allFinite() && landmark.mean_view_direction.allFinite() &&
              std::isfinite(landmark.min_distance) && std::isfinite(landmark.max_distance),
          "position of a landmark", landmark.id);
  Require(IsState(landmark.state), "state of a landmark", landmark.id);
  Require(map.FindKeyframe(landmark.anchor_id) != nullptr, "a landmark without its anchor", landmark.id);
  Require(map.FindKeyframe(landmark.first_keyframe_id) != nullptr, "a landmark without its maker", landmark.id);
  for (const auto& [keyframe_id, keypoint] : landmark.observations) {
    const Keyframe* keyframe = map.FindKeyframe(keyframe_id);
    Require(keyframe != nullptr && !keyframe->culled, "an observation without its keyframe", landmark.id);
    Require(keypoint >= 0 && keypoint < keyframe->features->size(), "an observation without its feature", landmark.id);
    Require(keyframe->landmark_ids[keypoint] == landmark.id, "a feature of two landmarks", landmark.id);
  }
}

void MapCodec::CheckFused(const SlamMap& map) {
  std::set<LandmarkId> ends;  // of which it is known that they lead somewhere
  for (const auto& [first, into] : map.fused_into_) {
    std::set<LandmarkId> way;
    LandmarkId id = first;
    for (auto next = map.fused_into_.find(id); next != map.fused_into_.end() && ends.count(id) == 0;
         next = map.fused_into_.find(id)) {
      Require(way.insert(id).second, "landmarks fused in a circle", id);
      id = next->second;
    }
    ends.merge(way);
  }
}

void MapCodec::Check(const SlamMap& map) {
  Require(map.map_id() >= 0 && map.map_id() < INT32_MAX, "number of a map", map.map_id());
  const Keyframe* first = map.FindKeyframe(map.first_keyframe_id());
  Require(first != nullptr && !first->culled, "a map without its first keyframe", map.map_id());
  Require(map.id_block_ >= 0 && map.id_block_ < INT32_MAX, "number of the next ids", map.id_block_);
  Require(map.FindKeyframe(map.last_keyframe_id()) != nullptr, "a map without its last keyframe", map.map_id());
  map.keyframes_.ForEach([&](const Keyframe& keyframe) { CheckKeyframe(map, keyframe); });
  map.landmarks_.ForEach([&](const Landmark& landmark) { CheckLandmark(map, landmark); });
  for (const KeyframeId id : map.changed_keyframes_) Require(map.FindKeyframe(id) != nullptr, "a changed keyframe", id);
  CheckFused(map);
  for (const LandmarkId id : map.changed_landmarks_) Require(map.FindLandmark(id) != nullptr, "a changed landmark", id);
}

}  // namespace kinemap
