// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <stdexcept>

#include "map/atlas.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

/// Two keyframes, each map in units and a frame of its own.
class TwoMaps : public ::testing::Test {
 protected:
  TwoMaps() : atlas_(0, TestScales()) {
    for (int64_t id = 0; id < 2; ++id) atlas_.Add(Build(id));
  }

  std::unique_ptr<SlamMap> Build(int64_t map_id) const {
    auto map = std::make_unique<SlamMap>(map_id, TestScales());
    std::vector<Frame> frames;
    for (int k = 0; k < 2; ++k) {
      frames.push_back(scene_.Observe(TestCamera(), TestScales(), CameraAt({0.3 * k, 0, 0}), 100 * map_id + k + 1));
    }
    const KeyframeId first = map->InsertKeyframe(frames[0]).id;
    for (int i = 0; i < frames[0].size(); ++i) {
      const Landmark& created = map->CreateLandmark(scene_.points()[scene_.observed_points()[i]], first, {});
      frames[1].landmark_ids[i] = created.id;
      map->Observe(map->FindLandmark(created.id), first, i);
    }
    map->InsertKeyframe(frames[1]);
    return map;
  }

  Scene scene_{50, 1, 8, 14};
  Atlas atlas_;
  const SimilarityTransform into_from_from_{RotationFromVector({0, 0.5, 0}), {3, 1, 2}, 2.5};
};

TEST_F(TwoMaps, OneTakesOverTheOtherWithItsIdsMovedByTheSimilarity) {
  SlamMap& from = *atlas_.Find(1);
  const KeyframeId moved_keyframe = from.last_keyframe_id();
  const Landmark& landmark = *from.FindLandmark(from.LiveLandmarks().front());
  const LandmarkId moved_landmark = landmark.id;
  const Eigen::Vector3d position = from.PositionInMap(landmark);
  const SimilarityTransform pose = from.MapFromAnchor(moved_keyframe);
  const double max_distance = landmark.max_distance;
  const int keyframes = atlas_.Find(0)->keyframe_count(), landmarks = atlas_.Find(0)->landmark_count();
  atlas_.Merge(1, 0, into_from_from_);

  EXPECT_EQ(atlas_.Find(1), nullptr);
  SlamMap& map = *atlas_.Find(0);
  EXPECT_EQ(atlas_.active(), &map);
  EXPECT_EQ(map.keyframe_count(), 2 * keyframes);
  EXPECT_EQ(map.live_keyframe_count(), 2 * keyframes);
  EXPECT_EQ(map.landmark_count(), 2 * landmarks);
  const SimilarityTransform moved = map.MapFromAnchor(moved_keyframe);
  EXPECT_LT((moved.translation - into_from_from_ * pose.translation).norm(), 1e-9);
  EXPECT_NEAR(moved.scale, 2.5 * pose.scale, 1e-12);
  const Landmark& after = *map.FindLandmark(moved_landmark);
  EXPECT_LT((map.PositionInMap(after) - into_from_from_ * position).norm(), 1e-9);
  EXPECT_NEAR(after.max_distance, 2.5 * max_distance, 1e-6);
  EXPECT_EQ(map.covisibility().Neighbors(moved_keyframe, 10), std::vector<KeyframeId>{int64_t{1} << 32});
}

TEST_F(TwoMaps, AMergedMapsKeyframesAreReportedAndTheNextIdsAreNew) {
  for (const auto& map : atlas_.maps()) map->TakeChanges();
  const KeyframeId absorbed = int64_t{1} << 32;
  atlas_.Merge(1, 0, into_from_from_);
  SlamMap& map = *atlas_.Find(0);
  EXPECT_EQ(map.TakeChanges().keyframes, (std::vector<KeyframeId>{absorbed, absorbed + 1}));
  const Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt({1, 0, 0}), 1000);
  EXPECT_EQ(map.InsertKeyframe(frame).id, 2);
  EXPECT_EQ(map.last_keyframe_id(), 2);
  EXPECT_EQ(atlas_.MapOf(absorbed), &map);
  EXPECT_EQ(atlas_.next_map_id(), 2);
}

TEST_F(TwoMaps, TheYoungerMapMayTakeOverTheOlder) {
  atlas_.Activate(0);
  atlas_.Merge(0, 1, into_from_from_);
  EXPECT_EQ(atlas_.active(), atlas_.Find(1));
  EXPECT_EQ(atlas_.active()->LiveKeyframes(),
            (std::vector<KeyframeId>{0, 1, int64_t{1} << 32, (int64_t{1} << 32) + 1}));
  // What is culled later finds its parent among the keyframes of both.
  atlas_.active()->CullKeyframe(1);
  EXPECT_EQ(atlas_.active()->LiveKeyframe(1), 0);
}

TEST_F(TwoMaps, LandmarksOfBothMapsCanBecomeOne) {
  atlas_.Merge(1, 0, SimilarityTransform());
  SlamMap& map = *atlas_.Find(0);
  const LandmarkId into = 0, from = int64_t{1} << 32;
  map.FuseLandmarks(from, into);
  EXPECT_EQ(map.FindLandmark(from)->id, into);
  EXPECT_EQ(map.FindLandmark(into)->observations.size(), 4u);
}

TEST_F(TwoMaps, WhatIsNotThereCannotBeMerged) {
  EXPECT_THROW(atlas_.Merge(1, 1, SimilarityTransform()), std::logic_error);
  EXPECT_THROW(atlas_.Merge(7, 0, SimilarityTransform()), std::logic_error);
  EXPECT_THROW(atlas_.Merge(0, 7, SimilarityTransform()), std::logic_error);
  EXPECT_THROW(atlas_.Add(Build(1)), std::logic_error);
  EXPECT_EQ(atlas_.maps().size(), 2u);
}

}  // namespace
}  // namespace kinemap
