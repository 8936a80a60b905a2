// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "loop_closing/place_agreement.h"
#include "loop_closing/tests/circular_drive.h"

namespace kinemap {
namespace {

using synthetic::CircularDrive;
using synthetic::TestScales;

constexpr KeyframeId kSecond = int64_t{1} << 32;

/// Two drives through one stretch; the second's keyframe n stands where the first's n + 10 does, in other units.
class TwoStretches : public ::testing::Test {
 protected:
  TwoStretches() : atlas_(0, TestScales()) {
    atlas_.Add(drive_.Map(0, 0, 20));
    atlas_.Add(drive_.Map(1, 10, 20, SimilarityTransform(Eigen::Quaterniond::Identity(), {5, 1, -3}, 0.4)));
  }

  /// What the n-th keyframe recognises: its own place, or one some steps further on.
  VerifiedLoop Recognised(int n, int further = 0) {
    const RigidTransform matched_from_keyframe =
        drive_.WorldFromCamera(10 + n).Inverse() * drive_.WorldFromCamera(10 + n + further);
    return {kSecond + n, 10 + n, SimilarityTransform(matched_from_keyframe, 1 / 0.4), false, false, {}};
  }

  CircularDrive drive_;
  Atlas atlas_;
  PlaceAgreement agreement_{PlaceAgreementOptions()};
};

TEST_F(TwoStretches, AreJoinedWhenThreeKeyframesAgree) {
  EXPECT_FALSE(agreement_.Takes(&atlas_, Recognised(1)));
  EXPECT_FALSE(agreement_.Takes(&atlas_, Recognised(2)));
  EXPECT_TRUE(agreement_.Takes(&atlas_, Recognised(5)));
}

TEST_F(TwoStretches, AreNotJoinedByKeyframesThatContradictEachOther) {
  for (int n = 0; n < 8; ++n) EXPECT_FALSE(agreement_.Takes(&atlas_, Recognised(n, n % 2))) << n;
}

TEST_F(TwoStretches, AreNotJoinedInUnitsThatContradictEachOther) {
  for (int n = 0; n < 8; ++n) {
    VerifiedLoop loop = Recognised(n);
    if (n % 2 == 1) loop.matched_from_keyframe.scale *= 1.3;
    EXPECT_FALSE(agreement_.Takes(&atlas_, loop)) << n;
  }
}

TEST_F(TwoStretches, AreNotJoinedByOneKeyframeHoweverOften) {
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(agreement_.Takes(&atlas_, Recognised(1))) << i;
}

TEST_F(TwoStretches, AreNotJoinedByACameraThatStands) {
  SlamMap* second = atlas_.MapOf(kSecond);
  for (int n = 1; n < 8; ++n) {
    second->SetKeyframePose(kSecond + n, second->keyframe(kSecond + 1).map_from_keyframe);
    VerifiedLoop loop = Recognised(1);
    loop.keyframe_id = kSecond + n;
    EXPECT_FALSE(agreement_.Takes(&atlas_, loop)) << n;
  }
}

TEST(ALostScale, IsBelievedWhenFiveKeyframesOfOneMapAgree) {
  const CircularDrive drive;
  Atlas atlas(0, TestScales());
  constexpr int kRound = CircularDrive::kStepsARound;
  atlas.Add(drive.Map(0, 0, kRound + 10));
  const SlamMap* map = atlas.MapOf(0);
  // Where the second round would be if the map had shrunk on the first.
  const SimilarityTransform true_from_told(Eigen::Quaterniond::Identity(), {30, 0, 5}, 20.0);
  PlaceAgreement agreement({});
  for (int n = 0; n < 5; ++n) {
    const SimilarityTransform matched_from_keyframe =
        map->MapFromAnchor(n).Inverse() * true_from_told * map->MapFromAnchor(kRound + n);
    const VerifiedLoop loop{kRound + n, n, matched_from_keyframe, false, false, {}};
    EXPECT_EQ(agreement.Takes(&atlas, loop), n == 4) << n;
  }
}

TEST_F(TwoStretches, CountsAnewAfterwards) {
  agreement_.Takes(&atlas_, Recognised(1));
  agreement_.Takes(&atlas_, Recognised(2));
  agreement_.Forget();
  EXPECT_FALSE(agreement_.Takes(&atlas_, Recognised(3)));
}

}  // namespace
}  // namespace kinemap
