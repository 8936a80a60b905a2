// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "features/bag_of_words.h"
#include "features/descriptor.h"

namespace kinemap {

/// A tree of descriptors (Nister and Stewenius 2006): going down from the root to the nearest child each time ends at a
/// leaf, the descriptor's word. Never changed once made, so that threads may share it.
class Vocabulary {
 public:
  /// Nodes are in breadth-first order, node 0 is the root and has no centre of its own.
  struct Tree {
    std::vector<uint8_t> child_counts;  ///< one a node; 0: a leaf
    std::vector<Descriptor> centers;    ///< one a node
    std::vector<float> word_weights;    ///< inverse document frequency, one a leaf
  };

  /// Throws std::invalid_argument when the sizes do not make one tree or a weight is negative or not finite.
  explicit Vocabulary(Tree tree);

  /// Reads what Save wrote. Throws std::invalid_argument that names the file: not there, cut off, damaged, of another
  /// version.
  static std::shared_ptr<const Vocabulary> Load(const std::string& path);
  /// Throws std::runtime_error when the file cannot be written.
  void Save(const std::string& path) const;

  int word_count() const { return static_cast<int>(tree_.word_weights.size()); }
  int node_count() const { return static_cast<int>(tree_.centers.size()); }
  float weight(uint32_t word) const { return tree_.word_weights[word]; }

  uint32_t WordOf(const Descriptor& descriptor) const;

  /// The bag of those descriptors for which `used` (one a descriptor) is not 0.
  BagOfWords Describe(const std::vector<Descriptor>& descriptors, const std::vector<uint8_t>& used) const;

 private:
  struct Place {
    uint32_t word;
    uint32_t node;  // at the level of BagOfWords::node_of_keypoint
  };
  Place PlaceOf(const Descriptor& descriptor) const;

  Tree tree_;
  std::vector<uint32_t> first_child_;  // one a node
  std::vector<uint32_t> word_;         // one a node; of leaves only
};

}  // namespace kinemap
