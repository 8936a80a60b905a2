// SPDX-License-Identifier: Apache-2.0
#include "tracking/camera_tracker.h"

#include <chrono>

#include "tracking/frame_matcher.h"

namespace kinemap {
namespace {

constexpr double kReferenceMatchRatio = 0.7;
constexpr int kLeastReferenceMatches = 15;
constexpr double kRelocalizedRadiusFactor = 5;

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

CameraTracker::CameraTracker(const CameraTrackerOptions& options, const CameraModel& camera, const PlaceIndex* places)
    : options_(options),
      camera_(camera),
      solver_(camera),
      local_map_tracker_(camera),
      relocalizer_(options.relocalizer, camera, places) {}

void CameraTracker::Start(const SlamMap& map, const Frame& frame, const std::optional<RigidTransform>& previous) {
  motion_model_.Reset();
  if (previous) motion_model_.Update(*previous, frame.camera_from_map);
  lost_frames_ = 0;
  frames_since_relocalization_ = TrackerState().frames_since_relocalization;
  Remember(map, frame);
}

void CameraTracker::Restore(const TrackerState& state) {
  last_ = state.last;
  last_from_reference_ = state.last_from_reference;
  last_scale_ = state.last_scale;
  motion_model_.Restore(state.velocity);
  lost_frames_ = state.lost_frames;
  frames_since_relocalization_ = state.frames_since_relocalization;
}

void CameraTracker::FollowKeyframe(const SlamMap& map, KeyframeId keyframe_id) {
  last_.reference_keyframe_id = keyframe_id;
  last_.landmark_ids = map.keyframe(keyframe_id).landmark_ids;
  last_from_reference_ = map.CameraFromReference(last_.camera_from_map, keyframe_id);
  last_scale_ = map.MapFromAnchor(keyframe_id).scale;
}

void CameraTracker::Remember(const SlamMap& map, const Frame& frame) {
  last_ = frame;
  last_from_reference_ = map.CameraFromReference(frame.camera_from_map, frame.reference_keyframe_id);
  last_scale_ = map.MapFromAnchor(frame.reference_keyframe_id).scale;
}

bool CameraTracker::TrackLastFrame(const SlamMap& map, Frame* frame) const {
  if (!motion_model_.IsKnown()) return false;
  const RigidTransform predicted = motion_model_.Predict(last_.camera_from_map);
  for (const double factor : {1.0, 2.0}) {
    frame->camera_from_map = predicted;
    if (MatchLastFrame(map, camera_, last_, factor * options_.motion_radius_px, frame) >= options_.min_motion_matches) {
      return solver_.Solve(map, frame).inliers >= options_.min_pose_inliers;
    }
  }
  return false;
}

bool CameraTracker::TrackReferenceKeyframe(const SlamMap& map, Frame* frame) const {
  const KeyframeId reference = map.LiveKeyframe(last_.reference_keyframe_id);
  frame->camera_from_map = last_.camera_from_map;
  if (MatchKeyframe(map, reference, kReferenceMatchRatio, frame) < kLeastReferenceMatches) return false;
  return solver_.Solve(map, frame).inliers >= options_.min_pose_inliers;
}

TrackedPose CameraTracker::Recover(SlamMap* map, int lost_frames, Frame* frame) {
  TrackedPose result;
  const auto start = std::chrono::steady_clock::now();
  const Eigen::Vector3d newest = map->MapFromKeyframe(map->last_keyframe_id()).translation;
  result.relocalized = relocalizer_.Relocalize(*map, newest, lost_frames, frame);
  result.match_ms = MillisecondsSince(start);
  if (!result.relocalized) return result;
  result.estimate = local_map_tracker_.Track(map, kRelocalizedRadiusFactor, frame);
  result.tracked = result.estimate.inliers >= options_.min_relocalized_inliers;
  result.local_map_ms = MillisecondsSince(start) - result.match_ms;
  if (!result.tracked) return result;
  Start(*map, *frame, std::nullopt);
  frames_since_relocalization_ = 0;
  return result;
}

TrackedPose CameraTracker::Track(SlamMap* map, Frame* frame) {
  TrackedPose result;
  const auto start = std::chrono::steady_clock::now();
  ++frames_since_relocalization_;
  // The mapper may have moved the keyframes since, a closed loop changed their scale: the last frame goes along.
  motion_model_.Rescale(map->MapFromAnchor(last_.reference_keyframe_id).scale / last_scale_);
  last_.camera_from_map = map->CameraFromMap(last_from_reference_, last_.reference_keyframe_id);
  frame->reference_keyframe_id = map->LiveKeyframe(last_.reference_keyframe_id);

  bool found = false;
  if (lost_frames_ == 0) found = TrackLastFrame(*map, frame) || TrackReferenceKeyframe(*map, frame);
  if (!found) {
    const Eigen::Vector3d last_center = last_.camera_from_map.Inverse().translation;
    found = relocalizer_.Relocalize(*map, last_center, lost_frames_, frame);
    result.relocalized = found;
  }
  result.match_ms = MillisecondsSince(start);
  const auto local_start = std::chrono::steady_clock::now();
  if (found) {
    const bool recent = result.relocalized || frames_since_relocalization_ < options_.recent_frames;
    result.estimate = local_map_tracker_.Track(map, result.relocalized ? kRelocalizedRadiusFactor : 1.0, frame);
    const int needed = recent ? options_.min_relocalized_inliers : options_.min_local_inliers;
    result.tracked = result.estimate.inliers >= needed;
    if (!result.tracked) {
      result.reason = "lost: " + std::to_string(result.estimate.inliers) + " landmarks of the local map found, " +
                      std::to_string(needed) + " needed";
    }
  } else {
    result.reason = "lost: no keyframe recognised";
  }
  result.local_map_ms = MillisecondsSince(local_start);
  if (result.tracked) {
    if (result.relocalized) frames_since_relocalization_ = 0;
    if (lost_frames_ == 0) {
      motion_model_.Update(last_.camera_from_map, frame->camera_from_map);
    } else {
      motion_model_.Reset();
    }
    lost_frames_ = 0;
    Remember(*map, *frame);
  } else {
    ++lost_frames_;
    motion_model_.Reset();
    result.relocalized = false;
  }
  return result;
}

}  // namespace kinemap
