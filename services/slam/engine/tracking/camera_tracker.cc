// SPDX-License-Identifier: Apache-2.0
#include "tracking/camera_tracker.h"

#include <algorithm>
#include <chrono>

#include "tracking/frame_matcher.h"

namespace kinemap {
namespace {

constexpr double kReferenceMatchRatio = 0.7;
constexpr int kLeastReferenceMatches = 15;
constexpr int kBlindNeighbors = 10;
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
  if (previous) {
    motion_model_.Start(*previous, frame.camera_from_map, map.MedianDepth(frame.reference_keyframe_id));
  }
  lost_frames_ = 0;
  frames_since_relocalization_ = TrackerState().frames_since_relocalization;
  Remember(map, frame);
}

void CameraTracker::Restore(const TrackerState& state) {
  last_ = state.last;
  last_from_reference_ = state.last_from_reference;
  last_scale_ = state.last_scale;
  motion_model_.Restore(state.motion);
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

double CameraTracker::LikelyRadiusPx(const PredictedPose& predicted) const {
  const double radius_px = options_.least_radius_px + predicted.RadiusPx(camera_.fx_px(), motion_model_.state().depth);
  return std::min(options_.motion_radius_px, radius_px);
}

bool CameraTracker::TrackLastFrame(const SlamMap& map, const PredictedPose& predicted, Frame* frame) const {
  const double likely_px = LikelyRadiusPx(predicted);
  for (const double radius_px : {likely_px, 2 * options_.motion_radius_px}) {
    frame->camera_from_map = predicted.camera_from_map;
    if (MatchLastFrame(map, camera_, last_, radius_px, frame) < options_.min_motion_matches) {
      continue;
    }
    if (solver_.Solve(map, frame, predicted.Prior()).inliers >= options_.min_pose_inliers) return true;
  }
  return false;
}

bool CameraTracker::TrackByPrediction(const SlamMap& map, const PredictedPose& predicted, Frame* frame) const {
  frame->camera_from_map = predicted.camera_from_map;
  frame->ForgetMatches();
  const KeyframeId reference = map.LiveKeyframe(last_.reference_keyframe_id);
  const double radius_px = LikelyRadiusPx(predicted);
  ProjectKeyframe(map, camera_, reference, radius_px, kMaxHammingDistance, frame);
  for (const KeyframeId neighbor : map.covisibility().Neighbors(reference, kBlindNeighbors)) {
    ProjectKeyframe(map, camera_, neighbor, radius_px, kMaxHammingDistance, frame);
  }
  return solver_.Solve(map, frame, predicted.Prior()).inliers >= options_.min_pose_inliers;
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
  frame->tracked_since_ns = frame->timestamp_ns;
  Start(*map, *frame, std::nullopt);
  frames_since_relocalization_ = 0;
  return result;
}

void CameraTracker::FollowLocalMap(SlamMap* map, const PredictedPose* expected, Frame* frame,
                                   TrackedPose* result) const {
  const auto start = std::chrono::steady_clock::now();
  const bool recent = result->relocalized || frames_since_relocalization_ < options_.recent_frames;
  const std::optional<PosePrior> prior = expected ? std::optional(expected->Prior()) : std::nullopt;
  const PoseEstimate estimate =
      local_map_tracker_.Track(map, result->relocalized ? kRelocalizedRadiusFactor : 1.0, frame, prior);
  int needed = recent ? options_.min_relocalized_inliers : options_.min_local_inliers;
  const double share =
      static_cast<double>(estimate.inliers) / static_cast<double>(std::max<size_t>(1, estimate.inlier.size()));
  if (prior && prior->Contains(frame->camera_from_map) && share >= options_.min_expected_share) {
    needed = options_.min_expected_inliers;
  }
  result->estimate = estimate;
  result->tracked = estimate.inliers >= needed;
  result->reason.clear();
  if (!result->tracked) {
    result->reason = "lost: " + std::to_string(estimate.inliers) + " landmarks of the local map found, " +
                     std::to_string(needed) + " needed";
  }
  result->local_map_ms += MillisecondsSince(start);
}

void CameraTracker::LearnMotion(const SlamMap& map, const std::optional<PredictedPose>& expected, const Frame& frame,
                                const TrackedPose& pose) {
  if (expected) {
    motion_model_.Correct(*expected, frame.camera_from_map, pose.estimate.information);
  } else if (lost_frames_ > 0 || pose.relocalized) {
    motion_model_.Reset();
  } else {
    const double depth = map.MedianDepth(frame.reference_keyframe_id);
    motion_model_.Start(last_.camera_from_map, frame.camera_from_map, depth);
  }
}

TrackedPose CameraTracker::Track(SlamMap* map, Frame* frame) {
  TrackedPose result;
  const auto start = std::chrono::steady_clock::now();
  ++frames_since_relocalization_;
  // The mapper may have moved the keyframes since, a closed loop changed their scale: the last frame goes along.
  const double scale = map->MapFromAnchor(last_.reference_keyframe_id).scale;
  motion_model_.Rescale(scale / last_scale_);
  last_scale_ = scale;
  last_.camera_from_map = map->CameraFromMap(last_from_reference_, last_.reference_keyframe_id);
  frame->reference_keyframe_id = map->LiveKeyframe(last_.reference_keyframe_id);

  // What was lost a moment ago is likely to be seen again from where it was seen last.
  const bool lost_recently = lost_frames_ <= options_.recent_frames;
  std::optional<PredictedPose> expected;
  if (motion_model_.IsKnown() && lost_recently) {
    expected = motion_model_.Predict(last_.camera_from_map, lost_frames_ + 1);
    if (lost_frames_ == 0 && TrackLastFrame(*map, *expected, frame)) FollowLocalMap(map, &*expected, frame, &result);
    if (!result.tracked && TrackByPrediction(*map, *expected, frame)) FollowLocalMap(map, &*expected, frame, &result);
  }
  if (!result.tracked) expected.reset();
  const auto from_reference = [&] {
    if (result.tracked || !lost_recently || !TrackReferenceKeyframe(*map, frame)) return;
    result.relocalized = false;
    FollowLocalMap(map, nullptr, frame, &result);
  };
  const auto by_places = [&] {
    if (result.tracked) return;
    const Eigen::Vector3d last_center = last_.camera_from_map.Inverse().translation;
    result.relocalized = relocalizer_.Relocalize(*map, last_center, lost_frames_, frame);
    if (result.relocalized) FollowLocalMap(map, nullptr, frame, &result);
  };
  // A camera that was lost may have been carried some way: three points know where it is now, while steps from where it
  // was may end beside it.
  if (lost_frames_ == 0) from_reference();
  by_places();
  if (lost_frames_ > 0) from_reference();
  if (!result.tracked && result.reason.empty()) result.reason = "lost: no keyframe recognised";
  result.match_ms = MillisecondsSince(start) - result.local_map_ms;
  if (result.tracked) {
    if (result.relocalized) frames_since_relocalization_ = 0;
    const bool followed = !result.relocalized && (lost_frames_ == 0 || expected);
    frame->tracked_since_ns = followed ? last_.tracked_since_ns : frame->timestamp_ns;
    LearnMotion(*map, expected, *frame, result);
    lost_frames_ = 0;
    Remember(*map, *frame);
  } else {
    ++lost_frames_;
    if (lost_frames_ > options_.recent_frames) motion_model_.Reset();
    result.relocalized = false;
  }
  return result;
}

}  // namespace kinemap
