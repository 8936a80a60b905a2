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

  /// Whether the last keyframe may be a part of the round's way off its place beside `candidate_id`.
  bool MayBeOff(double part, bool fixed_scale, KeyframeId candidate_id) const {
    RigidTransform recognised = map_->keyframe(ids_.back()).map_from_keyframe;
    recognised.translation.x() += part * way_;
    const RigidTransform candidate_from_last = map_->keyframe(candidate_id).map_from_keyframe.Inverse() * recognised;
    return IsWithinDrift({}, *map_, ids_.back(), candidate_id, SimilarityTransform(candidate_from_last), fixed_scale);
  }
  bool MayBeOff(double part, bool fixed_scale) const { return MayBeOff(part, fixed_scale, ids_.front()); }

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

TEST_F(ARound, HasLostLittleOnceALoopHoldsIt) {
  const KeyframeId third_of_the_way = ids_[CircularDrive::kStepsARound / 3];
  EXPECT_TRUE(MayBeOff(0.15, false, third_of_the_way));
  map_->AddLoopEdge(ids_.front(), ids_.back());
  EXPECT_FALSE(MayBeOff(0.15, false, third_of_the_way)) << "of 0.05 times a third of the round, past the loop";
  EXPECT_FALSE(MayBeOff(0.02, false, third_of_the_way));
  EXPECT_TRUE(MayBeOff(0.015, false, third_of_the_way));
}

TEST_F(ARound, DriftsAnewBehindAClosedLoop) {
  map_->AddLoopEdge(ids_.front(), ids_[CircularDrive::kStepsARound / 2]);
  EXPECT_TRUE(MayBeOff(0.12, false));
  EXPECT_FALSE(MayBeOff(0.2, false));
}

}  // namespace
}  // namespace kinemap
