// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kinemap {

/// CRC-32 of ISO-HDLC (the one of zlib, PNG and Ethernet): tells a damaged file from a whole one.
uint32_t Crc32(const void* bytes, size_t count);

}  // namespace kinemap
