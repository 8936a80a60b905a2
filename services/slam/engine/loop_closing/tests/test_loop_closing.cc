// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>

#include "loop_closing/loop_closer.h"
#include "loop_closing/map_correction.h"
#include "loop_closing/map_merger.h"
#include "loop_closing/tests/circular_drive.h"

namespace kinemap {
namespace {

using synthetic::CircularDrive;
using synthetic::TestCamera;
using synthetic::TestScales;

constexpr int kRound = CircularDrive::kStepsARound;
constexpr int kSecondRound = 9;
/// Three in a row until the detector names a place, which three then agree on.
constexpr int kWitnesses = 5;
const SimilarityTransform kDrift(RotationFromVector({0, 0.002, 0.001}), {0, 0, 0}, 0.996);

/// Lets a closer look at the keyframes as if they had just been inserted, and at the end.
LoopEvents LookAndSettle(Atlas* atlas, const PlaceIndex& places, const std::vector<KeyframeId>& keyframes,
                         LoopCloser* closer) {
  int64_t frame = 0;
  for (const KeyframeId id : keyframes) closer->Look(atlas, places, id, frame++);
  return closer->Settle(atlas);
}

std::vector<KeyframeId> Last(const SlamMap& map, int count) {
  std::vector<KeyframeId> ids = map.LiveKeyframes();
  return {ids.end() - count, ids.end()};
}

class ADriftedRound : public ::testing::Test {
 protected:
  ADriftedRound() : atlas_(0, TestScales()), places_(drive_.EmptyIndex()), closer_({}, TestCamera()) {
    map_ = &atlas_.Add(drive_.Map(0, 0, kRound + kSecondRound, {}, kDrift));
    places_.Follow(map_);
  }

  CircularDrive drive_;
  Atlas atlas_;
  PlaceIndex places_;
  LoopCloser closer_;
  SlamMap* map_;
};

TEST_F(ADriftedRound, ClosesAndTakesItsScaleDriftBack) {
  const double before = drive_.Error(*map_, 0);
  ASSERT_GT(before, 1);
  const LoopEvents events = LookAndSettle(&atlas_, places_, Last(*map_, kWitnesses), &closer_);
  EXPECT_EQ(events.loops_closed, 1);
  EXPECT_EQ(events.maps_merged, 0);
  EXPECT_TRUE(events.map_adjusted);
  EXPECT_LT(drive_.Error(*map_, 0), 0.1 * before);
  // By then the camera had shrunk the world to three quarters.
  EXPECT_NEAR(map_->MapFromAnchor(map_->last_keyframe_id()).scale,
              1 / std::pow(kDrift.scale, kRound + kSecondRound - 1), 0.05);
  EXPECT_FALSE(map_->keyframe(map_->last_keyframe_id()).loop_edges.empty());
  EXPECT_GT(map_->covisibility().Shared(map_->last_keyframe_id(), kSecondRound - 1), 30);
  EXPECT_EQ(map_->TakeChanges().keyframes.size(), static_cast<size_t>(map_->keyframe_count()));
}

TEST_F(ADriftedRound, IsRecognisedOnlyByTheThirdKeyframeInARow) {
  const std::vector<KeyframeId> last = Last(*map_, 3);
  LoopDetector detector({});
  EXPECT_TRUE(detector.Detect(&atlas_, places_, last[0]).empty());
  EXPECT_TRUE(detector.Detect(&atlas_, places_, last[1]).empty());
  EXPECT_FALSE(detector.Detect(&atlas_, places_, last[2]).empty());
  detector.Forget();
  EXPECT_TRUE(detector.Detect(&atlas_, places_, last[2]).empty());
}

TEST_F(ADriftedRound, IsNotClosedBeforeKeyframesAgree) {
  const std::vector<KeyframeId> last = Last(*map_, kWitnesses);
  EXPECT_EQ(LookAndSettle(&atlas_, places_, {last.begin(), last.end() - 1}, &closer_).loops_closed, 0);
}

TEST_F(ADriftedRound, IsMergedAtAFixedFrameAndNoOther) {
  const std::vector<KeyframeId> last = Last(*map_, kWitnesses);
  for (int64_t frame = 0; frame < kWitnesses; ++frame) closer_.Look(&atlas_, places_, last[frame], frame);
  const int64_t due = kWitnesses + 2;
  EXPECT_FALSE(closer_.IsDue(due - 1));
  EXPECT_EQ(closer_.Merge(&atlas_, due - 1).loops_closed, 0);
  EXPECT_TRUE(closer_.IsDue(due));
  EXPECT_EQ(closer_.Merge(&atlas_, due).loops_closed, 1);
  EXPECT_FALSE(closer_.IsDue(due + 1));
}

TEST_F(ADriftedRound, GivesTheSameMapTwice) {
  Atlas other(0, TestScales());
  SlamMap& again = other.Add(drive_.Map(0, 0, kRound + kSecondRound, {}, kDrift));
  LoopCloser closer({}, TestCamera());
  EXPECT_EQ(LookAndSettle(&atlas_, places_, Last(*map_, kWitnesses), &closer_).loops_closed, 1);
  LookAndSettle(&other, places_, Last(again, kWitnesses), &closer);
  for (const KeyframeId id : map_->LiveKeyframes()) {
    EXPECT_EQ(map_->MapFromKeyframe(id).Matrix(), again.MapFromKeyframe(id).Matrix());
  }
  ASSERT_EQ(map_->LiveLandmarks(), again.LiveLandmarks());
  for (const LandmarkId id : map_->LiveLandmarks()) {
    EXPECT_EQ(map_->PositionInMap(*map_->FindLandmark(id)), again.PositionInMap(*again.FindLandmark(id)));
  }
}

TEST_F(ADriftedRound, AKeyframeMadeMeanwhileFollowsTheOneItSharesMostWith) {
  const KeyframeId newest = map_->last_keyframe_id();
  const SimilarityTransform shift(RotationFromVector({0, 0.3, 0}), {1, 2, 3}, 1.5);
  Corrections corrections;
  for (const KeyframeId id : map_->LiveKeyframes()) {
    if (id != newest) corrections[id] = shift;
  }
  const SimilarityTransform before = map_->MapFromAnchor(newest);
  ApplyCorrections(corrections, map_);
  const SimilarityTransform after = map_->MapFromAnchor(newest);
  EXPECT_LT((after.translation - shift * before.translation).norm(), 1e-9);
  EXPECT_NEAR(after.scale, 1.5, 1e-12);
}

TEST(LoopCloser, RefusesAPlaceThatOnlyLooksAlike) {
  const CircularDrive drive;
  Atlas atlas(0, TestScales());
  PlaceIndex places = drive.EmptyIndex();
  places.Follow(&atlas.Add(drive.Map(0, 0, 20)));
  SlamMap& alike = atlas.Add(drive.Shuffled().Map(1, 0, 20));
  places.Follow(&alike);
  LoopDetector detector({});
  std::vector<KeyframeId> candidates;
  for (const KeyframeId id : Last(alike, 6)) candidates = detector.Detect(&atlas, places, id);
  ASSERT_FALSE(candidates.empty());
  LoopCloser closer({}, TestCamera());
  const LoopEvents events = LookAndSettle(&atlas, places, alike.LiveKeyframes(), &closer);
  EXPECT_EQ(events.loops_closed + events.maps_merged, 0);
  EXPECT_EQ(atlas.maps().size(), 2u);
}

TEST(LoopCloser, FindsNothingOnAWayThatNeverComesBack) {
  const CircularDrive drive;
  Atlas atlas(0, TestScales());
  PlaceIndex places = drive.EmptyIndex();
  SlamMap& map = atlas.Add(drive.Map(0, 0, kRound - 8));
  places.Follow(&map);
  LoopCloser closer({}, TestCamera());
  const LoopEvents events = LookAndSettle(&atlas, places, map.LiveKeyframes(), &closer);
  EXPECT_EQ(events.loops_closed + events.maps_merged, 0);
}

/// Two drives through one stretch, the second in other units.
class TwoDrives : public ::testing::Test {
 protected:
  TwoDrives() : atlas_(0, TestScales()), places_(drive_.EmptyIndex()), closer_({}, TestCamera()) {
    places_.Follow(&atlas_.Add(drive_.Map(0, 0, 20)));
    const SimilarityTransform elsewhere(RotationFromVector({0.1, 2, 0}), {5, 1, -3}, 0.4);
    places_.Follow(&atlas_.Add(drive_.Map(1, 10, 25, elsewhere)));
  }

  /// The second drive's keyframe at the 12th step stands where the first's does.
  double Gap(const SlamMap& map) const {
    return (map.MapFromKeyframe(12).translation - map.MapFromKeyframe((int64_t{1} << 32) + 2).translation).norm();
  }

  CircularDrive drive_;
  Atlas atlas_;
  PlaceIndex places_;
  LoopCloser closer_;
};

TEST_F(TwoDrives, BecomeOneMapInTheEldersFrame) {
  const LoopEvents events = LookAndSettle(&atlas_, places_, atlas_.active()->LiveKeyframes(), &closer_);
  EXPECT_EQ(events.maps_merged, 1);
  EXPECT_EQ(events.loops_closed, 0);
  ASSERT_EQ(atlas_.maps().size(), 1u);
  const SlamMap& map = *atlas_.Find(0);
  EXPECT_EQ(atlas_.active(), &map);
  EXPECT_EQ(map.keyframe_count(), 35);
  EXPECT_LT((map.MapFromKeyframe(0).Matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-9);
  EXPECT_LT(Gap(map), 0.05);
  EXPECT_GT(map.covisibility().Shared(12, (int64_t{1} << 32) + 2), 30);
}

TEST_F(TwoDrives, BecomeMetricWhereOneOfThemIs) {
  atlas_.Find(1)->set_metric_scale(true);
  LookAndSettle(&atlas_, places_, atlas_.active()->LiveKeyframes(), &closer_);
  ASSERT_EQ(atlas_.maps().size(), 1u);
  const SlamMap& map = *atlas_.Find(0);
  EXPECT_TRUE(map.metric_scale());
  EXPECT_LT(map.MapFromKeyframe(0).translation.norm(), 1e-9);
  // The elder one had true lengths, the younger, metric one counts 0.4 for each of them.
  const double step = (drive_.WorldFromCamera(1).translation - drive_.WorldFromCamera(0).translation).norm();
  EXPECT_NEAR(map.MapFromKeyframe(1).translation.norm(), 0.4 * step, 0.01);
  EXPECT_LT(Gap(map), 0.05);
}

TEST(BackgroundSlot, TakesAtItsFrameOrGivesUpWithoutATrace) {
  BackgroundSlot<int> slot;
  std::atomic<bool> started{false};
  slot.Start(
      1,
      [&](const std::atomic<bool>& cancelled, int* number) {
        started = true;
        while (!cancelled) std::this_thread::yield();
        *number = 2;
      },
      7);
  EXPECT_FALSE(slot.IsDue(6, true));
  EXPECT_TRUE(slot.IsDue(7, true));
  EXPECT_FALSE(slot.IsDue(7, false));
  EXPECT_THROW(slot.Start(1, nullptr, 8), std::logic_error);
  slot.Cancel();
  EXPECT_TRUE(slot.IsFree());
  slot.Start(3, [](const std::atomic<bool>&, int* number) { *number += 1; }, 9);
  EXPECT_EQ(slot.Take(), 4);
  EXPECT_TRUE(started);
}

}  // namespace
}  // namespace kinemap
