// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/bag_of_words.h"
#include "geometry/camera_model.h"
#include "map/landmark_search.h"
#include "map/slam_map.h"

namespace kinemap {

/// A keypoint of one keyframe and the landmark it shows.
struct LandmarkMatch {
  int keypoint;
  LandmarkId landmark_id;
  int distance;  ///< between the descriptors, in bits
};

/// Whether a landmark will still be where it was another time: parked cars drive off.
inline bool IsLasting(const Landmark& landmark) {
  return landmark.valid_until_ns == kStillValid && landmark.state == MotionState::kStatic;
}
inline bool IsLasting(const FeatureLabel& label) {
  return label.role == FeatureRole::kTracked && label.state == MotionState::kStatic;
}

/// Lasting landmarks of these keyframes, ascending.
std::vector<LandmarkId> LastingLandmarks(const SlamMap& map, const std::vector<KeyframeId>& keyframes);

/// Matches the keypoints of a keyframe that observe lasting landmarks of `map` with those of another keyframe, which
/// may lie in another map: nearest of the same vocabulary node within 50 bits and clearly nearer than the second,
/// all turning alike. The matches hold keypoints of `keyframe` and landmarks of `other_map`.
std::vector<LandmarkMatch> MatchByWords(const SlamMap& map, const Keyframe& keyframe, const BagOfWords& bag,
                                        const SlamMap& other_map, const Keyframe& other, const BagOfWords& other_bag);

/// Matches landmarks with a keyframe's keypoints near where a camera at `camera_from_map` (the landmarks' map) would
/// see them. Landmarks that the keyframe observes already are left out; every keypoint is matched once.
/// `radius_px` is that of the finest octave.
std::vector<LandmarkMatch> MatchByProjection(const SlamMap& map, const std::vector<LandmarkId>& landmarks,
                                             const CameraModel& camera, const RigidTransform& camera_from_map,
                                             const Keyframe& keyframe, double radius_px, int max_distance);

}  // namespace kinemap
