// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/map_merger.h"

#include <algorithm>

namespace kinemap {
namespace {

/// About the first keyframe, which stays where it is.
void Rescale(double factor, SlamMap* map) {
  const Eigen::Vector3d origin = map->MapFromKeyframe(map->first_keyframe_id()).translation;
  const SimilarityTransform rescaled(Eigen::Quaterniond::Identity(), (1 - factor) * origin, factor);
  for (const KeyframeId id : map->LiveKeyframes()) map->SetKeyframePose(id, rescaled * map->MapFromAnchor(id));
  for (const LandmarkId id : map->LiveLandmarks()) map->UpdateViewRange(map->FindLandmark(id));
}

}  // namespace

SlamMap& MapMerger::Merge(Atlas* atlas, const VerifiedLoop& loop) {
  SlamMap* one = atlas->MapOf(loop.keyframe_id);
  SlamMap* other = atlas->MapOf(loop.matched_id);
  if (one == other) return *one;
  SimilarityTransform other_from_one = other->MapFromAnchor(loop.matched_id) * loop.matched_from_keyframe *
                                       one->MapFromAnchor(loop.keyframe_id).Inverse();
  if (one->map_id() < other->map_id()) {
    std::swap(one, other);
    other_from_one = other_from_one.Inverse();
  }
  SlamMap& elder = *other;
  if (one->metric_scale() && !elder.metric_scale()) {
    const double factor = 1 / other_from_one.scale;
    Rescale(factor, &elder);
    const Eigen::Vector3d origin = elder.MapFromKeyframe(elder.first_keyframe_id()).translation;
    other_from_one =
        SimilarityTransform(Eigen::Quaterniond::Identity(), (1 - factor) * origin, factor) * other_from_one;
    elder.set_metric_scale(true);
  }
  atlas->Merge(one->map_id(), elder.map_id(), other_from_one);
  return elder;
}

}  // namespace kinemap
