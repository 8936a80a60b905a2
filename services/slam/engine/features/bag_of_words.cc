// SPDX-License-Identifier: Apache-2.0
#include "features/bag_of_words.h"

#include <algorithm>

namespace kinemap {

double Similarity(const BagOfWords& a, const BagOfWords& b) {
  // With weights above 0 that add up to 1, 1 - |a - b| / 2 is the sum of what both have of each word.
  double shared = 0;
  auto in_a = a.words.begin(), in_b = b.words.begin();
  while (in_a != a.words.end() && in_b != b.words.end()) {
    if (in_a->first < in_b->first) {
      ++in_a;
    } else if (in_b->first < in_a->first) {
      ++in_b;
    } else {
      shared += std::min(in_a->second, in_b->second);
      ++in_a, ++in_b;
    }
  }
  return std::min(shared, 1.0);
}

}  // namespace kinemap
