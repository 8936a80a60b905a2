// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "features/vocabulary.h"

namespace kinemap {

struct VocabularyTrainerOptions {
  int branching = 8;       ///< children a node
  int depth = 5;           ///< levels below the root
  int iterations = 12;     ///< of each clustering, at most
  int least_of_node = 12;  ///< descriptors; a node with fewer is a word
  uint64_t seed = 0;
};

/// Makes a vocabulary of many images' descriptors: k-majority on the Hamming distance (Grana et al. 2013), seeded by
/// k-means++ (Arthur and Vassilvitskii 2007), level by level. Equal input and options give equal bytes.
class VocabularyTrainer {
 public:
  /// Throws std::invalid_argument when an option is out of its range.
  explicit VocabularyTrainer(const VocabularyTrainerOptions& options);

  /// `image_of_descriptor` ascends; a word's weight is the logarithm of images over images that show it. Throws
  /// std::invalid_argument when there are fewer descriptors than children of one node.
  Vocabulary Train(const std::vector<Descriptor>& descriptors, const std::vector<int>& image_of_descriptor) const;

 private:
  VocabularyTrainerOptions options_;
};

}  // namespace kinemap
