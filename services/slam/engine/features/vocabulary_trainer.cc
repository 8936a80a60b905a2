// SPDX-License-Identifier: Apache-2.0
#include "features/vocabulary_trainer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "features/k_majority.h"

namespace kinemap {
namespace {

void Require(bool holds, const char* name, const char* expected, int value) {
  if (holds) return;
  throw std::invalid_argument(std::string(name) + ": expected " + expected + ", got " + std::to_string(value));
}

}  // namespace

VocabularyTrainer::VocabularyTrainer(const VocabularyTrainerOptions& options) : options_(options) {
  Require(options.branching >= 2 && options.branching <= 255, "branching", "2 to 255", options.branching);
  Require(options.depth >= 1 && options.depth <= 10, "depth", "1 to 10", options.depth);
  Require(options.iterations >= 1, "iterations", "at least 1", options.iterations);
  Require(options.least_of_node >= 1, "least_of_node", "at least 1", options.least_of_node);
}

Vocabulary VocabularyTrainer::Train(const std::vector<Descriptor>& descriptors,
                                    const std::vector<int>& image_of_descriptor) const {
  if (descriptors.size() < static_cast<size_t>(options_.branching) ||
      image_of_descriptor.size() != descriptors.size()) {
    throw std::invalid_argument("descriptors: expected at least " + std::to_string(options_.branching) +
                                ", each with its image, got " + std::to_string(descriptors.size()));
  }
  Vocabulary::Tree tree;
  tree.centers.emplace_back();
  std::vector<std::vector<int>> members(1);
  members[0].resize(descriptors.size());
  std::iota(members[0].begin(), members[0].end(), 0);
  size_t level_end = 1;
  for (size_t node = 0, level = 0; node < tree.centers.size(); ++node) {
    if (node == level_end) ++level, level_end = tree.centers.size();
    tree.child_counts.push_back(0);
    const bool is_word = level == static_cast<size_t>(options_.depth) ||
                         (node > 0 && members[node].size() < static_cast<size_t>(options_.least_of_node));
    DescriptorClusters children;
    if (!is_word) {
      RandomEngine random(options_.seed, static_cast<int64_t>(node));
      children = ClusterByMajority(descriptors, members[node], options_.branching, options_.iterations, &random);
    }
    if (children.centers.size() < 2) {
      double images = 0;
      for (size_t i = 0; i < members[node].size(); ++i) {
        images += i == 0 || image_of_descriptor[members[node][i]] != image_of_descriptor[members[node][i - 1]];
      }
      tree.word_weights.push_back(static_cast<float>(images));
      continue;
    }
    tree.child_counts.back() = static_cast<uint8_t>(children.centers.size());
    for (size_t child = 0; child < children.centers.size(); ++child) {
      tree.centers.push_back(children.centers[child]);
      members.push_back(std::move(children.members[child]));
    }
    std::vector<int>().swap(members[node]);
  }
  const int all_images = 1 + *std::max_element(image_of_descriptor.begin(), image_of_descriptor.end());
  for (float& weight : tree.word_weights) weight = static_cast<float>(std::log(all_images / weight));
  return Vocabulary(std::move(tree));
}

}  // namespace kinemap
