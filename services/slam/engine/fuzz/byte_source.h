// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace kinemap::fuzz {

/// Values out of the fuzzer's bytes; zeros once they are used up.
class ByteSource {
 public:
  ByteSource(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  size_t remaining() const { return size_ - position_; }

  template <typename Value>
  Value Take() {
    Value value{};
    const size_t count = std::min(sizeof(Value), remaining());
    if (count > 0) std::memcpy(&value, data_ + position_, count);
    position_ += count;
    return value;
  }

  /// In [low, high].
  int TakeInt(int low, int high) { return low + static_cast<int>(Take<uint16_t>() % (high - low + 1)); }

  /// In [low, high].
  double TakeReal(double low, double high) { return low + (high - low) * Take<uint16_t>() / 65535.0; }

 private:
  const uint8_t* data_;
  size_t size_;
  size_t position_ = 0;
};

}  // namespace kinemap::fuzz
