// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace kinemap {

/// What an image shows, in words of a Vocabulary.
struct BagOfWords {
  /// Word and weight (term frequency times inverse document frequency, L1 norm 1), ascending by word.
  std::vector<std::pair<uint32_t, float>> words;
  /// One a keypoint: the vocabulary's node that it falls under some levels above the words, kNoNode for keypoints left
  /// out. Views of one point mostly fall under one node, so only features of equal nodes need be compared.
  std::vector<uint32_t> node_of_keypoint;

  static constexpr uint32_t kNoNode = 0;  // the root, which no keypoint is assigned to

  bool empty() const { return words.empty(); }
};

/// 1 - |a - b|_1 / 2, in [0, 1]: the L1 score of Nister and Stewenius (2006), scaled as by Galvez-Lopez and Tardos
/// (2012, eq. 2). 0 when either is empty.
double Similarity(const BagOfWords& a, const BagOfWords& b);

}  // namespace kinemap
