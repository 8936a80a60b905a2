// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

#include "map/id_set.h"

namespace kinemap {
namespace {

TEST(IdSet, DoesWhatASetDoesOverSeveralBlocks) {
  std::mt19937 random(3);
  std::set<int64_t> expected;
  IdSet ids;
  for (int i = 0; i < 20000; ++i) {
    const int64_t id = (static_cast<int64_t>(random() % 3) << 32) + static_cast<int64_t>(random() % 3000);
    if (random() % 3 == 0) {
      ids.Erase(id);
      expected.erase(id);
    } else {
      EXPECT_EQ(ids.Insert(id), expected.insert(id).second);
    }
    EXPECT_EQ(ids.Contains(id), expected.contains(id));
  }
  EXPECT_EQ(ids.size(), expected.size());
  std::set<int64_t> visited;
  ids.ForEach([&](int64_t id) { EXPECT_TRUE(visited.insert(id).second); });
  EXPECT_EQ(visited, expected);
}

TEST(IdSet, GoesThroughABlockById) {
  IdSet ids;
  for (const int64_t id : {200, 3, 64, 63, 65}) ids.Insert(id);
  std::vector<int64_t> order;
  ids.ForEach([&](int64_t id) { order.push_back(id); });
  EXPECT_EQ(order, (std::vector<int64_t>{3, 63, 64, 65, 200}));
}

TEST(IdSet, HoldsNothingThatWasNeverPutIn) {
  IdSet ids;
  EXPECT_FALSE(ids.Contains(7));
  ids.Insert(7);
  EXPECT_FALSE(ids.Contains(100000));
  EXPECT_FALSE(ids.Contains((int64_t{1} << 32) + 7));
  ids.Erase(100000);
  EXPECT_EQ(ids.size(), 1u);
}

}  // namespace
}  // namespace kinemap
