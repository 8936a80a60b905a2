// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <optional>

#include "geometry/camera_model.h"
#include "optimization/bundle_adjustment.h"

namespace kinemap {

/// Room for one bundle adjustment in a background thread. Its solution is taken at a frame fixed when it starts, never
/// earlier and never later, so that a map does not depend on how fast the machine is.
class MergeSlot {
 public:
  MergeSlot(const CameraModel& camera, const BundleOptions& options) : camera_(camera), options_(options) {}
  ~MergeSlot();
  MergeSlot(const MergeSlot&) = delete;
  MergeSlot& operator=(const MergeSlot&) = delete;

  bool IsFree() const { return !running_.valid(); }
  bool IsDue(int64_t frame) const { return running_.valid() && frame >= due_frame_; }

  /// The slot must be free.
  void Start(BundleProblem problem, int64_t due_frame);

  /// Waits for the solution and frees the slot, which must not be free.
  BundleProblem Take() { return running_.get(); }

 private:
  CameraModel camera_;
  BundleOptions options_;
  std::future<BundleProblem> running_;
  int64_t due_frame_ = 0;
};

}  // namespace kinemap
