// SPDX-License-Identifier: Apache-2.0
#include "features/vocabulary.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kinemap {
namespace {

// Below the root, where a branching of 10 leaves about 100 nodes: 20 of an image's 2000 features each.
constexpr int kNodeLevel = 2;

}  // namespace

Vocabulary::Vocabulary(Tree tree) : tree_(std::move(tree)) {
  const size_t nodes = tree_.child_counts.size();
  if (nodes == 0 || tree_.centers.size() != nodes) {
    throw std::invalid_argument("expected a centre a node, got " + std::to_string(tree_.centers.size()) + " for " +
                                std::to_string(nodes) + " nodes");
  }
  size_t next_child = 1, words = 0;
  for (size_t node = 0; node < nodes; ++node) {
    // A child comes after its parent, so that going down ends.
    if (next_child <= node) throw std::invalid_argument("node " + std::to_string(node) + " has no parent");
    first_child_.push_back(static_cast<uint32_t>(next_child));
    word_.push_back(static_cast<uint32_t>(words));
    next_child += tree_.child_counts[node];
    if (tree_.child_counts[node] == 0) ++words;
  }
  if (next_child != nodes || words != tree_.word_weights.size()) {
    throw std::invalid_argument("expected " + std::to_string(nodes) + " nodes and " +
                                std::to_string(tree_.word_weights.size()) + " words, the tree has " +
                                std::to_string(next_child) + " and " + std::to_string(words));
  }
  for (const float weight : tree_.word_weights) {
    if (!std::isfinite(weight) || weight < 0) {
      throw std::invalid_argument("weight of a word: expected 0 or more, got " + std::to_string(weight));
    }
  }
}

Vocabulary::Place Vocabulary::PlaceOf(const Descriptor& descriptor) const {
  uint32_t node = 0, node_at_level = 0;
  for (int level = 1; tree_.child_counts[node] > 0; ++level) {
    const uint32_t first = first_child_[node], end = first + tree_.child_counts[node];
    int best_distance = 257;
    for (uint32_t child = first; child < end; ++child) {
      const int distance = HammingDistance(descriptor, tree_.centers[child]);
      if (distance >= best_distance) continue;
      best_distance = distance;
      node = child;
    }
    if (level <= kNodeLevel) node_at_level = node;
  }
  return {word_[node], node_at_level};
}

uint32_t Vocabulary::WordOf(const Descriptor& descriptor) const { return PlaceOf(descriptor).word; }

BagOfWords Vocabulary::Describe(const std::vector<Descriptor>& descriptors, const std::vector<uint8_t>& used) const {
  BagOfWords bag;
  bag.node_of_keypoint.assign(descriptors.size(), BagOfWords::kNoNode);
  std::vector<uint32_t> words;
  for (size_t i = 0; i < descriptors.size(); ++i) {
    if (used[i] == 0) continue;
    const Place place = PlaceOf(descriptors[i]);
    bag.node_of_keypoint[i] = place.node;
    // Words of every image say nothing of this one.
    if (tree_.word_weights[place.word] > 0) words.push_back(place.word);
  }
  std::sort(words.begin(), words.end());
  double total = 0;
  for (const uint32_t word : words) {
    const float weight = tree_.word_weights[word];
    total += weight;
    if (!bag.words.empty() && bag.words.back().first == word) {
      bag.words.back().second += weight;
    } else {
      bag.words.emplace_back(word, weight);
    }
  }
  for (auto& [word, weight] : bag.words) weight = static_cast<float>(weight / total);
  return bag;
}

}  // namespace kinemap
