// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "features/keypoint.h"
#include "features/object_labels.h"
#include "geometry/similarity_transform.h"
#include "map/frame.h"
#include "map/keyframe.h"
#include "map/landmark.h"
#include "storage/byte_reader.h"
#include "storage/byte_writer.h"
#include "storage/feature_codec.h"

namespace kinemap {

// The fields of each struct, in the order of the file. They are taken apart by structured bindings, so that a struct
// that gains a field does not compile here before it is written too.

/// Whatever is computed with a transform that is none ends as an index somewhere.
inline void RequireTransform(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation, double scale) {
  constexpr double kTolerance = 1e-3;
  if (std::abs(rotation.norm() - 1) < kTolerance && translation.allFinite() && std::isfinite(scale) && scale > 0)
    return;
  throw MapFileError("damaged: a pose");
}

template <typename Archive>
void Serialize(Archive& archive, RigidTransform& transform) {
  auto& [rotation, translation] = transform;
  archive(rotation, translation);
  if constexpr (Archive::kReads) RequireTransform(rotation, translation, 1);
}

template <typename Archive>
void Serialize(Archive& archive, SimilarityTransform& transform) {
  auto& [rotation, translation, scale] = transform;
  archive(rotation, translation, scale);
  if constexpr (Archive::kReads) RequireTransform(rotation, translation, scale);
}

template <typename Archive>
void Serialize(Archive& archive, FeatureLabel& label) {
  auto& [role, state, object_id, category] = label;
  archive(role, state, object_id, category);
}

inline bool IsSame(const FeatureLabel& a, const FeatureLabel& b) {
  return a.role == b.role && a.state == b.state && a.object_id == b.object_id && a.category == b.category;
}
inline bool IsSame(LandmarkId a, LandmarkId b) { return a == b; }

/// A vector most of whose elements are `usual`: only the others are written.
template <typename Archive, typename T>
void SerializeSparse(Archive& archive, std::vector<T>& values, const T& usual, size_t size) {
  std::vector<std::pair<uint32_t, T>> others;
  if constexpr (!Archive::kReads) {
    for (uint32_t i = 0; i < values.size(); ++i) {
      if (!IsSame(values[i], usual)) others.emplace_back(i, values[i]);
    }
  }
  archive(others);
  if constexpr (Archive::kReads) {
    values.assign(size, usual);
    for (const auto& [index, value] : others) {
      if (index >= size)
        throw MapFileError("damaged: feature " + std::to_string(index) + " of " + std::to_string(size));
      values[index] = value;
    }
  }
}

/// Features are in a section of their own; `feature_count` is 0 for a culled keyframe.
template <typename Archive>
void Serialize(Archive& archive, Keyframe& keyframe) {
  auto& [id, timestamp_ns, tracked_since_ns, features, labels, landmark_ids, map_from_keyframe, scale, loop_edges,
         anchored, culled_children, culled, parent_id, parent_from_keyframe] = keyframe;
  auto feature_count = static_cast<uint32_t>(labels.size());
  archive(id, timestamp_ns, tracked_since_ns, map_from_keyframe, scale, loop_edges, anchored, culled_children, culled,
          parent_id, parent_from_keyframe, feature_count);
  if (feature_count > kMostFeatures)
    throw MapFileError("damaged: a keyframe of " + std::to_string(feature_count) + " features");
  SerializeSparse(archive, labels, FeatureLabel{}, feature_count);
  SerializeSparse(archive, landmark_ids, kNoId, feature_count);
}

template <typename Archive>
void Serialize(Archive& archive, Landmark& landmark) {
  auto& [id, anchor_id, position_in_anchor, observations, first_keyframe_id, descriptor, mean_view_direction,
         min_distance, max_distance, visible, found, state, category, object_id, first_seen_ns, last_seen_ns,
         valid_until_ns] = landmark;
  archive(id, anchor_id, position_in_anchor, observations, first_keyframe_id, descriptor, mean_view_direction,
          min_distance, max_distance, visible, found, state, category, object_id, first_seen_ns, last_seen_ns,
          valid_until_ns);
}

}  // namespace kinemap
