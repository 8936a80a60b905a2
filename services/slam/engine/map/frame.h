// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/frame_features.h"
#include "features/object_labels.h"
#include "geometry/rigid_transform.h"
#include "map/id_set.h"
#include "map/ids.h"

namespace kinemap {

/// One image on its way through the tracker.
struct Frame {
  int64_t timestamp_ns = 0;
  int64_t tracked_since_ns = 0;  ///< time of the first frame since which the camera was never lost
  FrameFeaturesPtr features;
  std::vector<FeatureLabel> labels;      ///< one a keypoint
  std::vector<LandmarkId> landmark_ids;  ///< one a keypoint, kNoId where it matches none
  RigidTransform camera_from_map;
  KeyframeId reference_keyframe_id = kNoId;

  int size() const { return features->size(); }
  bool IsFree(int keypoint) const {
    return landmark_ids[keypoint] == kNoId && labels[keypoint].role == FeatureRole::kTracked;
  }
  IdSet MatchedLandmarks() const {
    IdSet matched;
    for (const LandmarkId id : landmark_ids) {
      if (id != kNoId) matched.Insert(id);
    }
    return matched;
  }
  void ForgetMatches() { landmark_ids.assign(features->size(), kNoId); }
};

}  // namespace kinemap
