// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace kinemap {

/// A map file that cannot be used; the message says why, in one line.
class MapFileError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Takes back what ByteWriter wrote. Bytes that end too early, or tell of more values than there are bytes left, throw
/// MapFileError; memory taken is never more than a small multiple of the bytes there are.
class ByteReader {
 public:
  static constexpr bool kReads = true;

  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (Get(values), ...);
  }

  bool IsAtEnd() const { return bytes_.empty(); }

  std::span<const uint8_t> Take(uint64_t size) {
    if (size > bytes_.size()) throw MapFileError("cut off or damaged: ends within a value");
    const std::span<const uint8_t> taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  /// A number of values of which each takes at least one byte.
  size_t TakeCount() {
    uint64_t count = 0;
    Get(count);
    if (count > bytes_.size()) throw MapFileError("damaged: tells of " + std::to_string(count) + " values");
    return count;
  }

 private:
  void Raw(void* data, size_t size) {
    const std::span<const uint8_t> taken = Take(size);
    if (size > 0) std::memcpy(data, taken.data(), size);
  }

  template <typename T>
  void Get(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      uint8_t byte = 0;
      Raw(&byte, 1);
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      Raw(&value, sizeof(T));
    } else {
      Serialize(*this, value);
    }
  }
  template <typename T, int kRows, int kColumns>
  void Get(Eigen::Matrix<T, kRows, kColumns>& value) {
    static_assert(kRows > 0 && kColumns > 0);
    Raw(value.data(), sizeof(T) * kRows * kColumns);
  }
  void Get(Eigen::Quaterniond& value) { Get(value.coeffs()); }
  void Get(std::string& value) {
    const std::span<const uint8_t> taken = Take(TakeCount());
    value.assign(taken.begin(), taken.end());
  }
  template <typename T, size_t kSize>
  void Get(std::array<T, kSize>& values) {
    for (T& value : values) Get(value);
  }
  template <typename A, typename B>
  void Get(std::pair<A, B>& value) {
    Get(value.first);
    Get(value.second);
  }
  template <typename T>
  void Get(std::optional<T>& value) {
    uint8_t there = 0;
    Get(there);
    value.reset();
    if (there != 0) Get(value.emplace());
  }
  template <typename T>
  void Get(std::deque<T>& values) {
    const size_t count = TakeCount();
    values.clear();
    for (size_t i = 0; i < count; ++i) Get(values.emplace_back());
  }
  template <typename T>
  void Get(std::vector<T>& values) {
    const size_t count = TakeCount();
    values.clear();
    for (size_t i = 0; i < count; ++i) Get(values.emplace_back());
  }
  void Get(std::vector<uint8_t>& values) {
    const std::span<const uint8_t> taken = Take(TakeCount());
    values.assign(taken.begin(), taken.end());
  }
  template <typename T>
  void Get(std::set<T>& values) {
    const size_t count = TakeCount();
    values.clear();
    for (size_t i = 0; i < count; ++i) {
      T value{};
      Get(value);
      values.insert(values.end(), value);
    }
  }
  template <typename K, typename V>
  void Get(std::map<K, V>& values) {
    const size_t count = TakeCount();
    values.clear();
    for (size_t i = 0; i < count; ++i) {
      std::pair<K, V> value{};
      Get(value);
      values.insert(values.end(), value);
    }
  }

  std::span<const uint8_t> bytes_;
};

}  // namespace kinemap
