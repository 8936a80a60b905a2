// SPDX-License-Identifier: Apache-2.0
#include "features/steered_brief.h"

#include <array>
#include <cmath>
#include <numbers>

#include "features/brief_tests.h"

namespace kinemap {
namespace {
constexpr int kAngles = 120;
constexpr int kPlaces = 2 * 256;
}  // namespace

SteeredBrief::SteeredBrief() {
  places_.reserve(kAngles * kPlaces);
  for (int angle = 0; angle < kAngles; ++angle) {
    const double radians = 2 * std::numbers::pi * angle / kAngles;
    const double cosine = std::cos(radians), sine = std::sin(radians);
    const auto turned = [&](int column, int row) {
      return Place{static_cast<int8_t>(std::lround(column * cosine - row * sine)),
                   static_cast<int8_t>(std::lround(column * sine + row * cosine))};
    };
    for (const BriefTest& test : LearnedBriefTests()) {
      places_.push_back(turned(test.a_column, test.a_row));
      places_.push_back(turned(test.b_column, test.b_row));
    }
  }
}

Descriptor SteeredBrief::Compute(const cv::Mat& smoothed, int column, int row, float angle_deg) const {
  const int angle = static_cast<int>(angle_deg * (kAngles / 360.0f) + 0.5f) % kAngles;
  const Place* places = places_.data() + static_cast<size_t>(angle) * kPlaces;
  const int stride = static_cast<int>(smoothed.step);
  std::array<int, kPlaces> offsets;
  for (int i = 0; i < kPlaces; ++i) offsets[i] = places[i].row * stride + places[i].column;
  const uint8_t* center = smoothed.ptr<uint8_t>(row) + column;
  Descriptor descriptor{};
  for (size_t word = 0; word < descriptor.size(); ++word) {
    const int* pair = offsets.data() + 128 * word;
    for (int bit = 0; bit < 64; ++bit, pair += 2) {
      descriptor[word] |= static_cast<uint64_t>(center[pair[0]] < center[pair[1]] ? 1 : 0) << bit;
    }
  }
  return descriptor;
}

}  // namespace kinemap
