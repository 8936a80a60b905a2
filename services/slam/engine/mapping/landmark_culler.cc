// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_culler.h"

namespace kinemap {
namespace {
constexpr double kLeastFoundRatio = 0.25;
constexpr int kLeastViews = 3;
constexpr int kKeyframesToGather = 2;
constexpr int kTrialKeyframes = 3;
}  // namespace

void LandmarkCuller::Add(const std::vector<LandmarkId>& landmarks) {
  on_trial_.insert(on_trial_.end(), landmarks.begin(), landmarks.end());
}

void LandmarkCuller::Cull(SlamMap* map, KeyframeId newest) {
  std::vector<LandmarkId> still_on_trial;
  for (const LandmarkId id : on_trial_) {
    const Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr || landmark->id != id || landmark->valid_until_ns != kStillValid) continue;
    const int64_t age = newest - landmark->first_keyframe_id;
    // What stays out of tracking is never looked for in a frame, so only its observations judge it.
    const bool rarely_found = landmark->IsTrackable() && landmark->found < kLeastFoundRatio * landmark->visible;
    const bool rarely_seen = age >= kKeyframesToGather && map->CountViews(*landmark) < kLeastViews;
    if (rarely_found || rarely_seen) {
      map->RemoveLandmark(id);
    } else if (age < kTrialKeyframes) {
      still_on_trial.push_back(id);
    }
  }
  on_trial_ = std::move(still_on_trial);
}

}  // namespace kinemap
