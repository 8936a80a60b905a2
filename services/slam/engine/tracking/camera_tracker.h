// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"
#include "tracking/local_map_tracker.h"
#include "tracking/motion_model.h"
#include "tracking/relocalizer.h"

namespace kinemap {

struct CameraTrackerOptions {
  double motion_radius_px = 15;      ///< widest search around the predicted place, finest octave
  double least_radius_px = 4;        ///< the same where the prediction is exact
  int min_motion_matches = 20;       ///< fewer, and the search is repeated twice as wide
  int min_pose_inliers = 10;         ///< of the first pose, before the local map
  int min_local_inliers = 30;        ///< of the final pose
  int min_expected_inliers = 12;     ///< the same of a pose that is where the camera was expected
  double min_expected_share = 0.5;   ///< of the matches that must be inliers then
  int min_relocalized_inliers = 50;  ///< the same while the last relocalisation is recent
  int recent_frames = 10;
  RelocalizerOptions relocalizer;
};

struct TrackedPose {
  bool tracked = false;
  bool relocalized = false;
  std::string reason;  ///< why it is lost
  PoseEstimate estimate;
  double match_ms = 0, local_map_ms = 0;
};

/// What the tracker carries from one frame to the next.
struct TrackerState {
  Frame last;
  RigidTransform last_from_reference;
  double last_scale = 1;
  CameraMotion motion;
  int lost_frames = 0;
  int frames_since_relocalization = 1 << 20;
};

/// Follows the camera from frame to frame: from the last frame, else from what is mapped where it is expected, else by
/// the reference keyframe's looks, else by relocalisation; then in the local map. Where few landmarks are left, behind
/// a bus say, what is known of the camera's motion holds the pose, and fewer landmarks do while they agree with it.
class CameraTracker {
 public:
  /// `places` helps a lost camera; it may be null, and must outlive this.
  CameraTracker(const CameraTrackerOptions& options, const CameraModel& camera, const PlaceIndex* places = nullptr);

  /// Fills in the frame's pose, matches and reference keyframe.
  TrackedPose Track(SlamMap* map, Frame* frame);

  /// Looks for a camera, lost `lost_frames` frames ago, in a map it need not have been in before. When it is found
  /// there, it is followed from this frame on.
  TrackedPose Recover(SlamMap* map, int lost_frames, Frame* frame);

  /// Starts following from a frame whose pose is known; `previous` (camera_from_map of the frame before) gives a speed.
  void Start(const SlamMap& map, const Frame& frame, const std::optional<RigidTransform>& previous);

  /// The last frame became this keyframe: it moves with it and has its landmarks.
  void FollowKeyframe(const SlamMap& map, KeyframeId keyframe_id);

  /// The map's unit changed: what was one of its units is now `factor` of them.
  void ChangeUnits(double factor) { motion_model_.Rescale(factor); }

  TrackerState state() const {
    return {last_,        last_from_reference_,        last_scale_, motion_model_.state(),
            lost_frames_, frames_since_relocalization_};
  }
  void Restore(const TrackerState& state);

  int frames_since_relocalization() const { return frames_since_relocalization_; }

 private:
  double LikelyRadiusPx(const PredictedPose& predicted) const;
  bool TrackLastFrame(const SlamMap& map, const PredictedPose& predicted, Frame* frame) const;
  bool TrackReferenceKeyframe(const SlamMap& map, Frame* frame) const;
  /// Finds the landmarks around the last place where the camera is expected since it was lost.
  bool TrackByPrediction(const SlamMap& map, const PredictedPose& predicted, Frame* frame) const;
  /// Says in the result whether enough of the local map is found from the frame's pose. `expected`: how it came there.
  void FollowLocalMap(SlamMap* map, const PredictedPose* expected, Frame* frame, TrackedPose* result) const;
  void LearnMotion(const SlamMap& map, const std::optional<PredictedPose>& expected, const Frame& frame,
                   const TrackedPose& pose);
  void Remember(const SlamMap& map, const Frame& frame);

  CameraTrackerOptions options_;
  CameraModel camera_;
  FramePoseSolver solver_;
  LocalMapTracker local_map_tracker_;
  Relocalizer relocalizer_;
  MotionModel motion_model_;
  Frame last_;
  RigidTransform last_from_reference_;
  double last_scale_ = 1;  // map units in one unit of the reference keyframe's
  int lost_frames_ = 0;
  int frames_since_relocalization_ = 1 << 20;
};

}  // namespace kinemap
