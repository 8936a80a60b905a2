// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kinemap {

/// Ids as they are counted in an IdTable, a bit for each. Unlike the nodes of a std::set, what thousands of insertions
/// a frame touch stays close together however long the engine has run.
class IdSet {
 public:
  /// Whether the id (not negative) was not there before.
  bool Insert(int64_t id) {
    uint64_t& word = WordOf(id);
    const uint64_t bit = BitOf(id);
    if ((word & bit) != 0) return false;
    word |= bit;
    ++size_;
    return true;
  }

  void Erase(int64_t id) {
    if (!Contains(id)) return;
    WordOf(id) &= ~BitOf(id);
    --size_;
  }

  bool Contains(int64_t id) const {
    for (const Block& block : blocks_) {
      if (block.number != id >> 32) continue;
      return WordIndex(id) < block.words.size() && (block.words[WordIndex(id)] & BitOf(id)) != 0;
    }
    return false;
  }

  size_t size() const { return size_; }

  /// Calls `visit(id)` for each; by id within a block, blocks in the order of their first insertions.
  template <typename Visit>
  void ForEach(Visit visit) const {
    for (const Block& block : blocks_) {
      for (size_t i = 0; i < block.words.size(); ++i) {
        for (uint64_t left = block.words[i]; left != 0; left &= left - 1) {
          visit((block.number << 32) + static_cast<int64_t>(64 * i) + std::countr_zero(left));
        }
      }
    }
  }

 private:
  struct Block {
    int64_t number;  ///< id >> 32
    std::vector<uint64_t> words;
  };

  static size_t WordIndex(int64_t id) { return static_cast<size_t>(id & 0xffffffff) / 64; }
  static uint64_t BitOf(int64_t id) { return uint64_t{1} << (id & 63); }

  uint64_t& WordOf(int64_t id) {
    std::vector<uint64_t>& words = WordsOf(id >> 32);
    if (WordIndex(id) >= words.size()) words.resize(WordIndex(id) + 1);
    return words[WordIndex(id)];
  }

  std::vector<uint64_t>& WordsOf(int64_t number) {
    for (Block& block : blocks_) {
      if (block.number == number) return block.words;
    }
    blocks_.push_back({number, {}});
    return blocks_.back().words;
  }

  std::vector<Block> blocks_;
  size_t size_ = 0;
};

}  // namespace kinemap
