// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/rigid_transform.h"

namespace kinemap {

/// The camera is expected to go on as it moved between the last two frames.
class MotionModel {
 public:
  /// Both poses are camera_from_map of consecutive frames.
  void Update(const RigidTransform& last, const RigidTransform& current) { velocity_ = current * last.Inverse(); }
  /// Lengths count `factor` times what they did.
  void Rescale(double factor) {
    if (velocity_) velocity_->translation *= factor;
  }
  void Reset() { velocity_.reset(); }
  /// The map's unit changed: what was one of its units is now `factor` of them.
  void ChangeUnits(double factor) {
    if (velocity_) velocity_->translation *= factor;
  }
  /// Current camera from last camera; as another motion model knew it.
  void Restore(const std::optional<RigidTransform>& velocity) { velocity_ = velocity; }
  const std::optional<RigidTransform>& velocity() const { return velocity_; }
  bool IsKnown() const { return velocity_.has_value(); }
  RigidTransform Predict(const RigidTransform& last) const { return *velocity_ * last; }

 private:
  std::optional<RigidTransform> velocity_;  // current camera from last camera
};

}  // namespace kinemap
