// SPDX-License-Identifier: Apache-2.0
// What the engine does with a lost camera: look for it in every map, and in the end begin another one.
#include <string>

#include "engine.h"

namespace kinemap {

bool Engine::RecoverInOtherMaps(Frame* frame, TrackingResult* result) {
  for (const auto& other : atlas_.maps()) {
    if (other.get() == map()) continue;
    const TrackedPose pose = tracker_.Recover(other.get(), static_cast<int>(frame_index_), frame);
    result->stage_ms.match_ms += pose.match_ms;
    result->stage_ms.local_map_ms += pose.local_map_ms;
    if (!pose.tracked) continue;
    if (map() != nullptr) mapper_.Leave(map());
    atlas_.Activate(other->map_id());
    waiting_.clear();
    initializer_.StartAgain();
    lost_policy_.Found();
    must_be_recognised_ = false;
    last_keyframe_index_ = frame_index_;
    result->state = TrackingState::kTracking;
    result->reason.clear();
    result->tracked_landmarks = pose.estimate.inliers;
    ReportPose(*frame, pose.estimate.information, result);
    return true;
  }
  frame->ForgetMatches();
  return false;
}

bool Engine::WaitToBeRecognised(TrackingResult* result) {
  if (!must_be_recognised_ && !options_.localize_only) return false;
  lost_policy_.Lost();
  result->state = TrackingState::kLost;
  result->reason = "lost: not recognised in " + std::to_string(atlas_.maps().size()) + " loaded map(s)";
  if (options_.localize_only) return true;
  result->reason += "; frame " + std::to_string(lost_policy_.lost_frames()) + " of " +
                    std::to_string(options_.new_map_after_lost) + " before a new map";
  if (lost_policy_.lost_frames() < options_.new_map_after_lost) return true;
  must_be_recognised_ = false;
  lost_policy_.Found();
  return true;
}

void Engine::LeaveMapIfHopeless(TrackingResult* result) {
  if (options_.localize_only) return;
  const int keyframes = map()->live_keyframe_count();
  result->reason += "; frame " + std::to_string(lost_policy_.lost_frames()) + " of " +
                    std::to_string(lost_policy_.Patience(keyframes)) + " before a new map";
  if (!lost_policy_.GivesUp(keyframes)) return;
  mapper_.Leave(map());
  atlas_.Deactivate();
  lost_policy_.Found();
}

}  // namespace kinemap
