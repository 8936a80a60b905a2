// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_mapper.h"

namespace kinemap {

LocalMapper::LocalMapper(const LocalMapperOptions& options, const CameraModel& camera)
    : options_(options),
      camera_(camera),
      measured_maker_(camera),
      triangulator_(options.triangulator, camera),
      fuser_(options.fuser, camera),
      bundle_adjuster_(options.bundle),
      final_adjuster_(options.final_adjustment, camera),
      moving_placer_(camera),
      slot_(camera, options.bundle.solver) {}

KeyframeId LocalMapper::Insert(SlamMap* map, const Frame& frame, int64_t frame_index, int* unplaced) {
  FinishMapping();
  if (!slot_.IsFree()) Merge(map);
  newest_ = map->InsertKeyframe(frame).id;
  *unplaced = moving_placer_.Place(map, newest_, frame);
  waiting_ = Waiting{map, newest_, frame_index + options_.merge_delay_frames};
  return newest_;
}

void LocalMapper::MapAround(SlamMap* map, KeyframeId keyframe_id, int64_t due_frame) {
  landmark_culler_.Cull(map);
  landmark_culler_.Add(measured_maker_.Make(map, keyframe_id));
  landmark_culler_.Add(triangulator_.Triangulate(map, keyframe_id));
  fuser_.Fuse(map, keyframe_id);
  slot_.Start(bundle_adjuster_.CopyProblem(*map, keyframe_id), due_frame);
}

void LocalMapper::StartMapping() {
  if (!waiting_) return;
  const Waiting work = *waiting_;
  waiting_.reset();
  running_ = std::async(std::launch::async, [this, work] { MapAround(work.map, work.keyframe_id, work.due_frame); });
}

void LocalMapper::WaitForMapping() {
  if (running_.valid()) running_.get();
}

void LocalMapper::FinishMapping() {
  StartMapping();
  WaitForMapping();
}

void LocalMapper::MergeIfDue(SlamMap* map, int64_t frame_index) {
  FinishMapping();
  if (slot_.IsDue(frame_index)) Merge(map);
}

void LocalMapper::Merge(SlamMap* map) {
  WriteBackBundle(slot_.Take(), map);
  map->UpdateCovisibility(newest_);
  keyframe_culler_.Cull(map, newest_);
}

void LocalMapper::Settle(SlamMap* map) {
  if (!slot_.IsFree()) Merge(map);
}

void LocalMapper::Leave(SlamMap* map) {
  FinishMapping();
  Settle(map);
  landmark_culler_.Replace({});
  newest_ = kNoId;
}

double LocalMapper::Finish(SlamMap* map, double known_radial) {
  FinishMapping();
  if (!slot_.IsFree()) Merge(map);
  return final_adjuster_.Adjust(map, known_radial);
}

}  // namespace kinemap
