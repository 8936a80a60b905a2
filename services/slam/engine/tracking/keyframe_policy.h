// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

struct KeyframePolicyOptions {
  int frames_after_relocalization = 20;
  int urgent_tracked =
      250;  ///< with fewer no keyframe waits for that: at the edge of the map the camera would be lost again
  int longest_gap_frames = 20;  ///< after so many frames a busy mapper no longer holds a keyframe back
  int min_tracked = 50;
  int starving_tracked = 100;        ///< with fewer, new landmarks can wait for nothing: the camera is about to be lost
  int least_starving_tracked = 12;   ///< with fewer the pose is not known well enough to make landmarks
  double max_reference_ratio = 0.9;  ///< of the points the reference keyframe tracks
  int min_close = 100;               ///< close points that hold the translation; fewer want a keyframe,
  int min_new_close = 70;            ///< if so many others could be mapped
};

struct TrackingQuality {
  int frames_since_relocalization;  ///< large when there was none
  int frames_since_keyframe;
  bool mapper_is_free;
  int tracked;             ///< landmarks matched in the frame
  int reference_tracked;   ///< landmarks of its reference keyframe
  int newest_tracked = 0;  ///< landmarks of the newest keyframe, seen but twice too
  int close_tracked = 0;   ///< keypoints with a measured, close depth that match a landmark
  int close_new = 0;       ///< and that match none
};

/// When a frame becomes a keyframe (thesis 3.2.1; Mur-Artal, Montiel and Tardos 2015, section V-E; Mur-Artal and Tardos
/// 2017, section III-E, for the close points).
class KeyframePolicy {
 public:
  explicit KeyframePolicy(const KeyframePolicyOptions& options) : options_(options) {}

  bool NeedsKeyframe(const TrackingQuality& quality) const {
    const bool wants_close = quality.close_tracked < options_.min_close && quality.close_new > options_.min_new_close;
    const bool starves = quality.tracked < options_.starving_tracked &&
                         quality.tracked >= options_.least_starving_tracked &&
                         quality.tracked < options_.max_reference_ratio * quality.newest_tracked;
    if (starves) return true;
    const bool urgent = quality.tracked < options_.urgent_tracked;
    return (urgent || quality.frames_since_relocalization >= options_.frames_after_relocalization) &&
           (quality.mapper_is_free || quality.frames_since_keyframe >= options_.longest_gap_frames) &&
           quality.tracked >= options_.min_tracked &&
           (wants_close || quality.tracked < options_.max_reference_ratio * quality.reference_tracked);
  }

 private:
  KeyframePolicyOptions options_;
};

}  // namespace kinemap
