// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "features/node_matcher.h"

namespace kinemap {
namespace {

/// Keypoints that all look alike but for the bits set in the descriptor's first word.
FrameFeatures Features(const std::vector<uint64_t>& bits) {
  FrameFeatures features;
  for (const uint64_t first : bits) {
    features.keypoints.emplace_back();
    features.descriptors.push_back({first, 0, 0, 0});
  }
  return features;
}

BagOfWords Nodes(const std::vector<uint32_t>& nodes) { return {{}, nodes}; }

constexpr NodeMatchLimits kLimits{60, 0.8};

TEST(NodeMatcher, LooksUnderTheSameNodeOnly) {
  const FrameFeatures query = Features({0x0, 0xFFFFFF}), train = Features({0xFFFFFF, 0x0, 0x1});
  const auto matches = MatchByNode(query, {0, 1}, Nodes({2, 1}), train, {0, 1, 2}, Nodes({2, 1, 2}), kLimits);
  // The first finds its likeness with one bit changed, as the equal one lies under another node; the second is left
  // with one that is 24 bits away.
  ASSERT_EQ(matches.size(), 2u);
  EXPECT_EQ(matches[0].query, 1);
  EXPECT_EQ(matches[0].train, 1);
  EXPECT_EQ(matches[1].query, 0);
  EXPECT_EQ(matches[1].train, 2);
}

TEST(NodeMatcher, LeavesOutWhatIsAmbiguousTooFarOrWithoutANode) {
  const FrameFeatures query = Features({0x0});
  EXPECT_TRUE(MatchByNode(query, {0}, Nodes({1}), Features({0x1, 0x2}), {0, 1}, Nodes({1, 1}), kLimits).empty());
  EXPECT_TRUE(MatchByNode(query, {0}, Nodes({1}), Features({~uint64_t{0}}), {0}, Nodes({1}), kLimits).empty());
  EXPECT_TRUE(MatchByNode(query, {0}, Nodes({0}), Features({0x0}), {0}, Nodes({0}), kLimits).empty());
  EXPECT_TRUE(MatchByNode(query, {}, Nodes({1}), Features({0x0}), {0}, Nodes({1}), kLimits).empty());
}

TEST(NodeMatcher, GivesATrainKeypointToTheNearestQuery) {
  const FrameFeatures query = Features({0x3, 0x1}), train = Features({0x0});
  const auto matches = MatchByNode(query, {0, 1}, Nodes({1, 1}), train, {0}, Nodes({1}), kLimits);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].query, 1);
}

TEST(NodeMatcher, LeavesOutWhatTurnsOtherwise) {
  FrameFeatures query, train;
  std::vector<int> all;
  std::vector<uint32_t> nodes;
  for (int i = 0; i < 40; ++i) {
    query.keypoints.emplace_back();
    train.keypoints.emplace_back();
    query.keypoints[i].angle_deg = 10;
    train.keypoints[i].angle_deg = i == 17 ? 200 : 40;
    query.descriptors.push_back({uint64_t{1} << i, 0, 0, 0});
    train.descriptors.push_back({uint64_t{1} << i, 0, 0, 0});
    all.push_back(i);
    nodes.push_back(1 + i);
  }
  const auto matches = MatchByNode(query, all, Nodes(nodes), train, all, Nodes(nodes), kLimits);
  EXPECT_EQ(matches.size(), 39u);
  for (const FeatureMatch& match : matches) EXPECT_NE(match.train, 17);
}

}  // namespace
}  // namespace kinemap
