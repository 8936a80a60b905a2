// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <vector>

#include "features/frame_features.h"
#include "features/object_labels.h"
#include "geometry/similarity_transform.h"
#include "map/ids.h"

namespace kinemap {

/// A frame that stays in the map. Once culled it keeps nothing but its pose, relative to its parent.
struct Keyframe {
  KeyframeId id = kNoId;
  int64_t timestamp_ns = 0;
  int64_t tracked_since_ns = 0;             ///< time of the first frame since which the camera was never lost
  FrameFeaturesPtr features;                ///< null once culled
  std::vector<FeatureLabel> labels;         ///< one a keypoint
  std::vector<LandmarkId> landmark_ids;     ///< one a keypoint, kNoId where it observes none
  RigidTransform map_from_keyframe;         ///< of a culled keyframe: ask SlamMap::MapFromKeyframe
  double scale = 1;                         ///< map units in one unit of the landmarks anchored here
  std::set<KeyframeId> loop_edges;          ///< keyframes that a recognised place ties to this one
  std::vector<LandmarkId> anchored;         ///< landmarks that are, or once were, anchored here
  std::vector<KeyframeId> culled_children;  ///< culled keyframes whose parent this is
  bool culled = false;
  KeyframeId parent_id = kNoId;              ///< of a culled keyframe
  SimilarityTransform parent_from_keyframe;  ///< of a culled keyframe, between what is anchored in the two
};

}  // namespace kinemap
