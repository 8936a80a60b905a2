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
  for (const LandmarkId id : landmarks) on_trial_.emplace(id, 0);
}

void LandmarkCuller::Cull(SlamMap* map) {
  OnTrial still_on_trial;
  for (const auto& [id, keyframes_before] : on_trial_) {
    const Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr || landmark->id != id || landmark->valid_until_ns != kStillValid) continue;
    const int age = keyframes_before + 1;
    // What stays out of tracking is never looked for in a frame, so only its observations judge it.
    const bool rarely_found = landmark->IsTrackable() && landmark->found < kLeastFoundRatio * landmark->visible;
    const bool rarely_seen = age >= kKeyframesToGather && map->CountViews(*landmark) < kLeastViews;
    if (rarely_found || rarely_seen) {
      map->RemoveLandmark(id);
    } else if (age < kTrialKeyframes) {
      still_on_trial.emplace(id, age);
    }
  }
  on_trial_ = std::move(still_on_trial);
}

}  // namespace kinemap
