// SPDX-License-Identifier: Apache-2.0
#include "ground/scale_field.h"

#include <cmath>
#include <set>

namespace kinemap {

void ApplyScaleField(const std::vector<ScaleChange>& changes, SlamMap* map) {
  std::set<LandmarkId> seen;
  Eigen::Vector3d last_center, last_moved;
  for (size_t i = 0; i < changes.size(); ++i) {
    const KeyframeId id = changes[i].keyframe_id;
    SimilarityTransform map_from_anchor = map->MapFromAnchor(id);
    const Eigen::Vector3d center = map_from_anchor.translation;
    if (i > 0) {
      const double factor = std::exp((changes[i - 1].log_factor + changes[i].log_factor) / 2);
      map_from_anchor.translation = last_moved + factor * (center - last_center);
    }
    last_center = center;
    last_moved = map_from_anchor.translation;
    map_from_anchor.scale *= std::exp(changes[i].log_factor);
    map->SetKeyframePose(id, map_from_anchor);
    for (const LandmarkId landmark_id : map->keyframe(id).landmark_ids) {
      const Landmark* landmark = map->FindLandmark(landmark_id);
      if (landmark != nullptr) seen.insert(landmark->id);
    }
  }
  for (const LandmarkId id : seen) map->UpdateViewRange(map->FindLandmark(id));
}

}  // namespace kinemap
