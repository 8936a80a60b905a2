// SPDX-License-Identifier: Apache-2.0
#include "tracking/single_frame_map_builder.h"

#include "map/measured_landmarks.h"

namespace kinemap {
namespace {
constexpr int kLeastClose = 100;
}

bool SingleFrameMapBuilder::CanBuild(const Frame& frame) const {
  int close = 0;
  for (int i = 0; i < frame.size(); ++i) {
    if (frame.labels[i].role == FeatureRole::kTracked && IsClose(camera_, frame.features->keypoints[i])) ++close;
  }
  return close >= kLeastClose;
}

std::unique_ptr<SlamMap> SingleFrameMapBuilder::Build(int64_t map_id, const RigidTransform& map_from_first_camera,
                                                      Frame* frame) const {
  auto map = std::make_unique<SlamMap>(map_id, scales_);
  map->set_metric_scale(true);
  frame->ForgetMatches();
  frame->tracked_since_ns = frame->timestamp_ns;
  frame->camera_from_map = map_from_first_camera.Inverse();
  const KeyframeId id = map->InsertKeyframe(*frame).id;
  std::vector<int> measured;
  for (int i = 0; i < frame->size(); ++i) {
    const bool is_known = frame->features->keypoints[i].HasDepth();
    if (is_known && frame->labels[i].role == FeatureRole::kTracked) measured.push_back(i);
  }
  CreateMeasuredLandmarks(camera_, id, measured, map.get());
  map->UpdateCovisibility(id);
  frame->reference_keyframe_id = id;
  frame->landmark_ids = map->keyframe(id).landmark_ids;
  return map;
}

}  // namespace kinemap
