// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "loop_closing/drift_bound.h"
#include "loop_closing/tests/circular_drive.h"

namespace kinemap {
namespace {

using synthetic::CircularDrive;

/// A round, and the place of its first keyframe as far from where the last one is as a part of the way since.
class ARound : public ::testing::Test {
 protected:
  ARound() : map_(CircularDrive().Map(0, 0, CircularDrive::kStepsARound)), ids_(map_->LiveKeyframes()) {
    for (size_t i = 1; i < ids_.size(); ++i) way_ += (Centre(ids_[i]) - Centre(ids_[i - 1])).norm();
  }

  Eigen::Vector3d Centre(KeyframeId id) const { return map_->keyframe(id).map_from_keyframe.translation; }

  bool MayBeOff(double part, bool fixed_scale) const {
    RigidTransform recognised = map_->keyframe(ids_.back()).map_from_keyframe;
    recognised.translation.x() += part * way_;
    const RigidTransform first_from_last = map_->keyframe(ids_.front()).map_from_keyframe.Inverse() * recognised;
    return IsWithinDrift({}, *map_, ids_.back(), ids_.front(), SimilarityTransform(first_from_last), fixed_scale);
  }

  std::unique_ptr<SlamMap> map_;
  std::vector<KeyframeId> ids_;
  double way_ = 0;
};

TEST_F(ARound, MayHaveLostSomeOfItsWay) {
  EXPECT_TRUE(MayBeOff(0.0, true));
  EXPECT_TRUE(MayBeOff(0.09, true));
  EXPECT_TRUE(MayBeOff(0.29, false));
}

TEST_F(ARound, CannotHaveLostMost) {
  EXPECT_FALSE(MayBeOff(0.11, true));
  EXPECT_FALSE(MayBeOff(0.31, false));
  EXPECT_FALSE(MayBeOff(1.0, false));
}

}  // namespace
}  // namespace kinemap
