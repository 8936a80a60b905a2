// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace kinemap {

struct LostPolicyOptions {
  int patience_frames = 50;  ///< lost frames after which a map is left
  int young_frames = 5;      ///< the same of a young map, which has little to come back to
  int young_keyframes = 5;   ///< live keyframes up to which a map is young
};

/// When a lost camera leaves its map and begins another: no input may leave tracking lost for good.
class LostPolicy {
 public:
  explicit LostPolicy(const LostPolicyOptions& options) : options_(options) {}

  void Found() { lost_frames_ = 0; }
  void Lost() { ++lost_frames_; }
  void Restore(int lost_frames) { lost_frames_ = lost_frames; }
  int lost_frames() const { return lost_frames_; }

  /// Lost frames that a map of so many live keyframes may last.
  int Patience(int keyframes) const {
    const bool young = keyframes <= options_.young_keyframes;
    return young ? std::min(options_.young_frames, options_.patience_frames) : options_.patience_frames;
  }
  bool GivesUp(int keyframes) const { return lost_frames_ >= Patience(keyframes); }

 private:
  LostPolicyOptions options_;
  int lost_frames_ = 0;
};

}  // namespace kinemap
