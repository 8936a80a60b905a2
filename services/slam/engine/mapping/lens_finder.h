// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapping/final_adjuster.h"
#include "optimization/background_slot.h"

namespace kinemap {

struct LensFinderOptions {
  FinalAdjusterOptions adjustment;
  int first_keyframes = 20;    ///< of a map that is looked at first
  double growth = 1.3;         ///< by which it must have grown before it is looked at again
  double growth_believed = 2;  ///< the same after a look that found something
  int most_keyframes = 80;     ///< a larger map takes too long
  int shortest_delay_frames = 10;
  int observations_per_frame = 1500;
  bool wait = true;  ///< false: a solution is due only once it is there
};

/// Finds the radial distortion that calibration left in the images of one camera while the map is young, as the
/// adjustment at the end does it, but in the background and in time for the live poses: a hundredth is enough to bend
/// them (see SolveBundle).
class LensFinder {
 public:
  LensFinder(const LensFinderOptions& options, const CameraModel& camera);

  /// Copies the map when it has keyframes enough for another look, and no depths are measured, which keep it from
  /// bending. Its solution is due a fixed number of frames later. `known_radial` was taken out of the features before.
  void Look(const SlamMap& map, int64_t frame_index, double known_radial = 0);

  bool IsFree() const { return slot_.IsFree(); }
  bool IsDue(int64_t frame_index) const { return slot_.IsDue(frame_index, options_.wait); }

  /// The adjusted map; its `radial` is 0 where nothing is believed. The slot must not be free.
  BundleProblem Take();

  /// Gives up what is under way: the map it was copied from is no longer the same. The next Look begins it again.
  void Cancel() { slot_.Cancel(); }

  /// Keyframes of the next map that is looked at: all that a finder with a free slot carries over.
  int next_keyframes() const { return next_keyframes_; }
  void Restore(int next_keyframes) { next_keyframes_ = next_keyframes; }

 private:
  LensFinderOptions options_;
  FinalAdjuster adjuster_;
  BackgroundSlot<BundleProblem> slot_;
  int next_keyframes_;
};

}  // namespace kinemap
