// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/bag_of_words.h"
#include "geometry/camera_model.h"
#include "map/landmark_search.h"
#include "map/lasting.h"
#include "map/slam_map.h"

namespace kinemap {

/// A keypoint of one keyframe and the landmark it shows.
struct LandmarkMatch {
  int keypoint;
  LandmarkId landmark_id;
  int distance;  ///< between the descriptors, in bits
};

/// A keyframe's keypoints that observe lasting landmarks, by the vocabulary node they fall under.
class KeypointsByNode {
 public:
  KeypointsByNode(const SlamMap& map, const Keyframe& keyframe, const BagOfWords& bag);

  struct Entry {
    uint32_t node;
    int keypoint;
    LandmarkId landmark_id;
    const Descriptor* descriptor;
  };
  /// By node, then by keypoint.
  const std::vector<Entry>& entries() const { return entries_; }
  float angle_deg(int keypoint) const { return features_->keypoints[keypoint].angle_deg; }

 private:
  FrameFeaturesPtr features_;
  std::vector<Entry> entries_;
};

/// Matches each keypoint of one keyframe with those of another, which may lie in another map: nearest of the same node
/// within 50 bits and clearly nearer than the second, each landmark once, all turning alike. The matches hold keypoints
/// of the one and landmarks of the other.
std::vector<LandmarkMatch> MatchByWords(const KeypointsByNode& one, const KeypointsByNode& other);

/// Matches landmarks with a keyframe's keypoints near where a camera at `camera_from_map` (the landmarks' map) would
/// see them. Landmarks that the keyframe observes already are left out; every keypoint is matched once.
/// `radius_px` is that of the finest octave.
std::vector<LandmarkMatch> MatchByProjection(const SlamMap& map, const std::vector<LandmarkId>& landmarks,
                                             const CameraModel& camera, const RigidTransform& camera_from_map,
                                             const Keyframe& keyframe, double radius_px, int max_distance);

}  // namespace kinemap
