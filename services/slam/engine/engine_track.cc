// SPDX-License-Identifier: Apache-2.0
// How the engine follows the camera in a map: its pose, what is said of it, and whether it becomes a keyframe.
#include <Eigen/LU>

#include "engine.h"
#include "map/measured_landmarks.h"
#include "stopwatch.h"

namespace kinemap {

void Engine::Track(Frame* frame, TrackingResult* result) {
  const TrackedPose pose = tracker_.Track(map(), frame);
  result->stage_ms.match_ms = pose.match_ms;
  result->stage_ms.local_map_ms = pose.local_map_ms;
  result->state = pose.tracked ? TrackingState::kTracking : TrackingState::kLost;
  result->reason = pose.reason;
  result->tracked_landmarks = pose.estimate.inliers;
  if (!pose.tracked) {
    lost_policy_.Lost();
    if (lost_policy_.lost_frames() == 1) SettleMaps();  // so that maps stay as they are while the camera is looked for
    RecoverInOtherMaps(frame, result);
    return;
  }
  lost_policy_.Found();
  if (NeedsKeyframe(*frame, pose.estimate.inliers)) {
    const Stopwatch stopwatch;
    const RigidTransform camera_from_map = frame->camera_from_map;
    frame->reference_keyframe_id = mapper_.Insert(map(), *frame, frame_index_, &result->moving_unplaced);
    frame->camera_from_map = camera_from_map;
    if (!map()->metric_scale()) late_scale_.Look(*map(), frame->reference_keyframe_id);
    last_keyframe_index_ = frame_index_;
    new_keyframe_ = frame->reference_keyframe_id;
    result->keyframe_inserted = true;
    result->stage_ms.mapping_ms = stopwatch.ElapsedMs();
  }
  ReportPose(*frame, pose.estimate.information, result);
}

bool Engine::NeedsKeyframe(const Frame& frame, int tracked) const {
  if (options_.localize_only) return false;
  TrackingQuality quality;
  quality.frames_since_relocalization = tracker_.frames_since_relocalization();
  quality.frames_since_keyframe = static_cast<int>(frame_index_ - last_keyframe_index_);
  quality.mapper_is_free = mapper_.IsFree();
  quality.tracked = tracked;
  // In a map of two keyframes no landmark has three views yet.
  const int min_views = map()->live_keyframe_count() <= 2 ? 2 : 3;
  quality.reference_tracked = map()->CountTracked(frame.reference_keyframe_id, min_views);
  quality.newest_tracked = map()->CountTracked(map()->last_keyframe_id(), 2);
  if (map()->metric_scale()) CountClose(frame, &quality);
  return keyframe_policy_.NeedsKeyframe(quality);
}

void Engine::CountClose(const Frame& frame, TrackingQuality* quality) const {
  for (int i = 0; i < frame.size(); ++i) {
    const bool tracked = frame.labels[i].role == FeatureRole::kTracked;
    if (!tracked || !IsClose(camera_, frame.features->keypoints[i])) continue;
    ++(frame.landmark_ids[i] == kNoId ? quality->close_new : quality->close_tracked);
  }
}

void Engine::ReportRoad(const Frame& frame, const cv::Mat& track_image, TrackingResult* result) {
  const std::optional<GroundPlane>& plane = ground_scale_->plane();
  if (!plane) return;
  result->road_normal = plane->normal;
  result->road_distance = plane->height;
  if (track_image.empty()) return;
  const ObjectContacts contacts(track_image, camera_, *plane);
  result->object_contacts = contacts.All();
  if (result->keyframe_inserted) {
    result->moving_unplaced -= contact_placer_.Place(map(), frame.reference_keyframe_id, frame, contacts);
  }
}

void Engine::ReportPose(const Frame& frame, const Matrix6d& information, TrackingResult* result) const {
  result->map_from_camera = frame.camera_from_map.Inverse().Matrix();
  result->reference_keyframe_id = frame.reference_keyframe_id;
  result->camera_from_reference =
      map()->CameraFromReference(frame.camera_from_map, frame.reference_keyframe_id).Matrix();
  const Matrix6d covariance = information.inverse();
  if (covariance.allFinite()) result->covariance = covariance;
}

}  // namespace kinemap
