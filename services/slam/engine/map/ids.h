// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kinemap {

/// Both count up from map_id << 32, each on its own, and are never used twice.
using KeyframeId = int64_t;
using LandmarkId = int64_t;

constexpr int64_t kNoId = -1;
/// End of validity of a landmark that is still where it was seen.
constexpr int64_t kStillValid = -1;

}  // namespace kinemap
