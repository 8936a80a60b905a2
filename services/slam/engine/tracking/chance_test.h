// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// What a search for landmarks around a pose came to.
struct SearchOutcome {
  int looked_for = 0;             ///< landmarks with a free keypoint near where they should be
  int found = 0;                  ///< of these, those that agree with the pose
  double mean_distance_bits = 0;  ///< between the descriptors of the found
};

/// Whether a pose rests on landmarks that only happened to look like something near by. Among hundreds of windows some
/// tens hold a keypoint just under the limit of matching, and a pose can always be bent until a part of these agrees:
/// so a camera that was carried off at once may seem tracked. Such matches are few of those looked for, and hardly
/// alike. What passes before the camera makes them few but not unlike, other light unlike but not few.
inline bool IsByChance(const SearchOutcome& outcome) {
  constexpr double kLeastShare = 0.25, kMostBits = 72;
  return outcome.found < kLeastShare * outcome.looked_for && outcome.mean_distance_bits > kMostBits;
}

}  // namespace kinemap
