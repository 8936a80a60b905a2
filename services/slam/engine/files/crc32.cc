// SPDX-License-Identifier: Apache-2.0
#include "files/crc32.h"

#include <array>

namespace kinemap {
namespace {

constexpr uint32_t kReversedPolynomial = 0xEDB88320u;

constexpr std::array<uint32_t, 256> MakeTable() {
  std::array<uint32_t, 256> table{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder >> 1) ^ ((remainder & 1) != 0 ? kReversedPolynomial : 0);
    }
    table[byte] = remainder;
  }
  return table;
}

constexpr std::array<uint32_t, 256> kTable = MakeTable();

}  // namespace

uint32_t Crc32(const void* bytes, size_t count) {
  const auto* byte = static_cast<const uint8_t*>(bytes);
  uint32_t remainder = 0xFFFFFFFFu;
  for (size_t i = 0; i < count; ++i) remainder = (remainder >> 8) ^ kTable[(remainder ^ byte[i]) & 0xFF];
  return ~remainder;
}

}  // namespace kinemap
