// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace kinemap {

static_assert(std::endian::native == std::endian::little, "map files are little-endian, and written as memory is");

/// Turns values into bytes. A struct is written by a free function `Serialize(archive, value)`, which ByteReader takes
/// back by the same function: one list of fields for both.
class ByteWriter {
 public:
  static constexpr bool kReads = false;

  template <typename... Values>
  void operator()(const Values&... values) {
    (Put(values), ...);
  }

  std::vector<uint8_t>& bytes() { return bytes_; }

 private:
  void Raw(const void* data, size_t size) {
    const size_t at = bytes_.size();
    bytes_.resize(at + size);
    if (size > 0) std::memcpy(bytes_.data() + at, data, size);
  }

  template <typename T>
  void Put(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      Raw(&value, sizeof(T));
    } else {
      Serialize(*this, const_cast<T&>(value));
    }
  }
  template <typename T, int kRows, int kColumns>
  void Put(const Eigen::Matrix<T, kRows, kColumns>& value) {
    static_assert(kRows > 0 && kColumns > 0);
    Raw(value.data(), sizeof(T) * kRows * kColumns);
  }
  void Put(const Eigen::Quaterniond& value) { Put(value.coeffs()); }
  void Put(const std::string& value) {
    Put(static_cast<uint64_t>(value.size()));
    Raw(value.data(), value.size());
  }
  template <typename T, size_t kSize>
  void Put(const std::array<T, kSize>& values) {
    for (const T& value : values) Put(value);
  }
  template <typename A, typename B>
  void Put(const std::pair<A, B>& value) {
    Put(value.first);
    Put(value.second);
  }
  template <typename T>
  void Put(const std::optional<T>& value) {
    Put(static_cast<uint8_t>(value.has_value()));
    if (value) Put(*value);
  }
  template <typename T>
  void PutAll(const T& values) {
    Put(static_cast<uint64_t>(values.size()));
    for (const auto& value : values) Put(value);
  }
  template <typename T>
  void Put(const std::vector<T>& values) {
    PutAll(values);
  }
  void Put(const std::vector<uint8_t>& values) {
    Put(static_cast<uint64_t>(values.size()));
    Raw(values.data(), values.size());
  }
  template <typename T>
  void Put(const std::deque<T>& values) {
    PutAll(values);
  }
  template <typename T>
  void Put(const std::set<T>& values) {
    PutAll(values);
  }
  template <typename K, typename V>
  void Put(const std::map<K, V>& values) {
    PutAll(values);
  }

  std::vector<uint8_t> bytes_;
};

}  // namespace kinemap
