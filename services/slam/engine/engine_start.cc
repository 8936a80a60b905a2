// SPDX-License-Identifier: Apache-2.0
// How the engine begins a map: from one frame with measured depths, or from two with parallax between them.
#include <Eigen/Geometry>

#include "engine.h"
#include "stopwatch.h"
#include "tracking/frame_matcher.h"

namespace kinemap {
namespace {
constexpr size_t kMostWaitingFrames = 60;
constexpr int kLeastFilledInliers = 30;
}  // namespace

void Engine::Initialize(Frame* frame, TrackingResult* result) {
  const Stopwatch stopwatch;
  result->state = TrackingState::kInitializing;
  if (single_frame_builder_.CanBuild(*frame)) {
    StartFromOneFrame(frame);
  } else {
    StartFromTwoFrames(frame, result);
  }
  if (map() == nullptr) {
    waiting_.push_back(*frame);
    if (waiting_.size() > kMostWaitingFrames) waiting_.pop_front();
  } else {
    waiting_.clear();
    last_keyframe_index_ = frame_index_;
    result->keyframe_inserted = true;
    result->state = TrackingState::kTracking;
    const PoseEstimate estimate = FramePoseSolver(camera_).Solve(*map(), frame);
    result->tracked_landmarks = estimate.inliers;
    ReportPose(*frame, estimate.information, result);
  }
  result->stage_ms.match_ms = stopwatch.ElapsedMs();
}

void Engine::StartFromOneFrame(Frame* frame) {
  const RigidTransform start = RigidTransform::FromMatrix(options_.map_from_first_camera);
  atlas_.Add(single_frame_builder_.Build(atlas_.next_map_id(), start, frame));
  tracker_.Start(*map(), *frame, std::nullopt);
}

void Engine::StartFromTwoFrames(Frame* frame, TrackingResult* result) {
  RandomEngine random(options_.seed, frame->timestamp_ns);
  const std::optional<InitialMap> initial = initializer_.Try(*frame, random);
  result->reason = initializer_.reason();
  if (!initial) return;
  const RigidTransform start = RigidTransform::FromMatrix(options_.map_from_first_camera);
  BuiltMap built = map_builder_.Build(atlas_.next_map_id(), start, *initial, *frame);
  result->reason = built.reason;
  if (built.map == nullptr) return;
  atlas_.Add(std::move(built.map)).set_metric_scale(built.metric_scale);
  *frame = std::move(built.current);
  FillWaitingFrames(initial->reference, *frame);
  std::optional<RigidTransform> previous;
  if (!late_frames_.empty() && !waiting_.empty() && late_frames_.back().timestamp_ns == waiting_.back().timestamp_ns) {
    const LateFramePose& late = late_frames_.back();
    previous = map()->CameraFromMap(late.camera_from_reference, late.reference_keyframe_id);
  }
  tracker_.Start(*map(), *frame, previous);
}

void Engine::FillWaitingFrames(const Frame& first, const Frame& current) {
  const LocalMapTracker local_map_tracker(camera_);
  const double span_ns = static_cast<double>(current.timestamp_ns - first.timestamp_ns);
  const RigidTransform first_from_map = map()->MapFromKeyframe(map()->first_keyframe_id()).Inverse();
  const RigidTransform current_from_first = current.camera_from_map * first_from_map.Inverse();
  const Eigen::AngleAxisd turn(current_from_first.rotation);
  for (Frame& frame : waiting_) {
    // The first guess lies on the screw between the two keyframes, or goes on before the first at the same speed.
    const double part = static_cast<double>(frame.timestamp_ns - first.timestamp_ns) / span_ns;
    const Eigen::AngleAxisd part_turn(part * turn.angle(), turn.axis());
    frame.camera_from_map =
        RigidTransform(Eigen::Quaterniond(part_turn), part * current_from_first.translation) * first_from_map;
    frame.reference_keyframe_id = map()->first_keyframe_id();
    frame.ForgetMatches();
    if (ProjectKeyframe(*map(), camera_, map()->last_keyframe_id(), 15.0, kMaxHammingDistance, &frame) == 0) continue;
    if (FramePoseSolver(camera_).Solve(*map(), &frame).inliers < kLeastFilledInliers) continue;
    if (local_map_tracker.Track(map(), 1.0, &frame).inliers < kLeastFilledInliers) continue;
    late_frames_.push_back({frame.timestamp_ns, frame.reference_keyframe_id,
                            map()->CameraFromReference(frame.camera_from_map, frame.reference_keyframe_id)});
  }
}

}  // namespace kinemap
