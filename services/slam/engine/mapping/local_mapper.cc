// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_mapper.h"

#include <algorithm>
#include <set>

namespace kinemap {

LocalMapper::LocalMapper(const LocalMapperOptions& options, const CameraModel& camera)
    : options_(options),
      camera_(camera),
      triangulator_(options.triangulator, camera),
      fuser_(options.fuser, camera),
      bundle_adjuster_(options.bundle),
      moving_placer_(camera),
      slot_(camera, options.bundle.solver) {}

KeyframeId LocalMapper::Insert(SlamMap* map, const Frame& frame, int64_t frame_index, int* unplaced) {
  if (!slot_.IsFree()) Merge(map);
  newest_ = map->InsertKeyframe(frame).id;
  landmark_culler_.Cull(map, newest_);
  landmark_culler_.Add(triangulator_.Triangulate(map, newest_));
  fuser_.Fuse(map, newest_);
  *unplaced = moving_placer_.Place(map, newest_, frame);
  slot_.Start(bundle_adjuster_.CopyProblem(*map, newest_), frame_index + options_.merge_delay_frames);
  return newest_;
}

void LocalMapper::MergeIfDue(SlamMap* map, int64_t frame_index) {
  if (slot_.IsDue(frame_index)) Merge(map);
}

void LocalMapper::Settle(SlamMap* map) {
  if (!slot_.IsFree()) Merge(map);
}

void LocalMapper::Merge(SlamMap* map) {
  WriteBackBundle(slot_.Take(), map);
  map->UpdateCovisibility(newest_);
  keyframe_culler_.Cull(map, newest_);
}

void LocalMapper::Finish(SlamMap* map) {
  if (!slot_.IsFree()) Merge(map);
  if (newest_ == kNoId) return;
  const std::vector<KeyframeId> live = map->LiveKeyframes();
  const size_t left_out = live.size() - std::min(live.size(), static_cast<size_t>(options_.final_keyframes));
  BundleProblem problem = CopyBundleProblem(*map, std::set<KeyframeId>(live.begin() + left_out, live.end()));
  SolveBundle(camera_, options_.final_bundle, &problem);
  remaining_radial_ = problem.radial;
  WriteBackBundle(problem, map);
}

}  // namespace kinemap
