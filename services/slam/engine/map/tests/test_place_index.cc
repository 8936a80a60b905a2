// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "features/vocabulary_trainer.h"
#include "map/place_index.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

/// Five places, each a scene of its own, seen twice each by keyframes 0..9 of one map.
class Places : public ::testing::Test {
 protected:
  Places() : map_(0, TestScales()), index_(nullptr) {
    for (uint32_t place = 0; place < 5; ++place) scenes_.emplace_back(300, 4, 6, 16, place + 1);
    std::vector<Descriptor> descriptors;
    std::vector<int> image_of_descriptor;
    for (int place = 0; place < 5; ++place) {
      const Frame frame = View(place, 0);
      for (const Descriptor& descriptor : frame.features->descriptors) {
        descriptors.push_back(descriptor);
        image_of_descriptor.push_back(place);
      }
    }
    VocabularyTrainerOptions options;
    options.branching = 6;
    options.depth = 4;
    options.least_of_node = 2;
    index_ =
        PlaceIndex(std::make_shared<Vocabulary>(VocabularyTrainer(options).Train(descriptors, image_of_descriptor)));
    for (int i = 0; i < 10; ++i) map_.InsertKeyframe(View(i / 2, 0.5 * (i % 2)));
    index_.Follow(&map_);
  }

  Frame View(int place, double shift, const std::function<FeatureLabel(int)>& label = nullptr) const {
    return scenes_[place].Observe(TestCamera(), TestScales(), CameraAt({shift, 0, 0}), 1, 0, label);
  }

  BagOfWords Bag(const Frame& frame) const { return index_.Describe(*frame.features, frame.labels); }

  static bool Any(KeyframeId) { return true; }

  std::vector<Scene> scenes_;
  SlamMap map_;
  PlaceIndex index_;
};

TEST_F(Places, FindsTheKeyframesOfThePlaceFirst) {
  EXPECT_EQ(index_.size(), 10);
  for (int place = 0; place < 5; ++place) {
    const auto found = index_.Query(Bag(View(place, 0.25)), Any);
    ASSERT_GE(found.size(), 2u);
    EXPECT_EQ(found[0].keyframe_id / 2, place);
    EXPECT_EQ(found[1].keyframe_id / 2, place);
    EXPECT_GE(found[0].similarity, found[1].similarity);
    EXPECT_NEAR(found[0].similarity, Similarity(Bag(View(place, 0.25)), *index_.bag(found[0].keyframe_id)), 1e-6);
  }
}

TEST_F(Places, LeavesOutWhatIsNotAccepted) {
  const auto found = index_.Query(Bag(View(1, 0)), [](KeyframeId id) { return id != 2; });
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].keyframe_id, 3);
  for (const PlaceCandidate& candidate : found) EXPECT_NE(candidate.keyframe_id, 2);
}

TEST_F(Places, ForgetsACulledKeyframeAndUsesItsSlotAgain) {
  map_.CullKeyframe(4);
  index_.Follow(&map_);
  EXPECT_EQ(index_.size(), 9);
  EXPECT_EQ(index_.bag(4), nullptr);
  EXPECT_EQ(index_.Query(Bag(View(2, 0)), Any)[0].keyframe_id, 5);
  map_.InsertKeyframe(View(2, 0));
  index_.Follow(&map_);
  EXPECT_EQ(index_.Query(Bag(View(2, 0)), Any)[0].keyframe_id, 10);
  index_.Add(map_.keyframe(10));
  index_.Remove(4);
  EXPECT_EQ(index_.size(), 10);
}

TEST_F(Places, GroupsOfNeighboursStandTogether) {
  // 2k and 2k + 1 are neighbours: the pair that shows place 1 outweighs any other, and its nearer one stands for it.
  const auto neighbors = [](KeyframeId id) { return std::vector<KeyframeId>{id ^ 1}; };
  const auto groups = index_.QueryGroups(Bag(View(1, 0)), 3, Any, neighbors);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].keyframe_id, 2);
  EXPECT_NEAR(groups[0].similarity,
              Similarity(Bag(View(1, 0)), *index_.bag(2)) + Similarity(Bag(View(1, 0)), *index_.bag(3)), 1e-6);
}

TEST_F(Places, ParkedCarsAreNoPlace) {
  const Frame parked =
      View(0, 0, [](int) { return FeatureLabel{FeatureRole::kTracked, MotionState::kNonMoving, 1, 3}; });
  EXPECT_TRUE(Bag(parked).empty());
  EXPECT_TRUE(index_.Query(Bag(parked), Any).empty());
}

TEST(PlaceIndex, StaysEmptyWithoutAVocabulary) {
  PlaceIndex index(nullptr);
  SlamMap map(0, TestScales());
  map.InsertKeyframe(Scene(100, 4, 6, 16).Observe(TestCamera(), TestScales(), CameraAt({0, 0, 0}), 1));
  index.Follow(&map);
  EXPECT_FALSE(index.has_vocabulary());
  EXPECT_EQ(index.size(), 0);
  EXPECT_EQ(index.bag(0), nullptr);
}

}  // namespace
}  // namespace kinemap
