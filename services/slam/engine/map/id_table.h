// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace kinemap {

/// Things by their ids. An id is a map's number << 32 plus a count; a map that took over others holds several blocks of
/// ids. Blocks are kept by their numbers, so that going through them goes by id.
template <typename T>
class IdTable {
 public:
  struct Block {
    int64_t number;  ///< id >> 32
    std::vector<std::unique_ptr<T>> entries;
  };

  /// Null when it was never there or was removed.
  T* Find(int64_t id) const {
    for (const Block& block : blocks_) {
      if (block.number != id >> 32) continue;
      const auto index = static_cast<size_t>(id & 0xffffffff);
      return index < block.entries.size() ? block.entries[index].get() : nullptr;
    }
    return nullptr;
  }

  /// The id that the next entry of a block will have.
  int64_t NextId(int64_t number) const {
    for (const Block& block : blocks_) {
      if (block.number == number) return (number << 32) + static_cast<int64_t>(block.entries.size());
    }
    return number << 32;
  }

  /// Appends to a block. Returns the entry, whose id is what NextId said.
  T& Append(int64_t number, std::unique_ptr<T> entry) {
    std::vector<std::unique_ptr<T>>& entries = BlockOf(number).entries;
    entries.push_back(std::move(entry));
    return *entries.back();
  }

  /// Appends the place of an entry that was removed.
  void AppendGap(int64_t number) { BlockOf(number).entries.push_back(nullptr); }

  /// Forgets an entry; its id is not used again.
  void Remove(int64_t id) {
    for (Block& block : blocks_) {
      if (block.number == id >> 32) block.entries[static_cast<size_t>(id & 0xffffffff)].reset();
    }
  }

  /// Takes over all blocks of another table, none of which may be here already.
  void Absorb(IdTable&& other) {
    for (Block& block : other.blocks_) BlockOf(block.number).entries = std::move(block.entries);
    other.blocks_.clear();
  }

  const std::vector<Block>& blocks() const { return blocks_; }

  /// Calls `visit(const T&)` for all that is there, by id.
  template <typename Visit>
  void ForEach(Visit visit) const {
    for (const Block& block : blocks_) {
      for (const auto& entry : block.entries) {
        if (entry != nullptr) visit(*entry);
      }
    }
  }

 private:
  Block& BlockOf(int64_t number) {
    auto place = blocks_.begin();
    while (place != blocks_.end() && place->number < number) ++place;
    if (place == blocks_.end() || place->number != number) place = blocks_.insert(place, Block{number, {}});
    return *place;
  }

  std::vector<Block> blocks_;
};

}  // namespace kinemap
