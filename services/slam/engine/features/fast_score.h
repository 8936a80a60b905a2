// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace kinemap {

/// Pixels around a FAST corner that its score looks at.
constexpr int kFastRadiusPx = 3;

/// FAST-9/16 (Rosten and Drummond 2006) as a score for every pixel of a row of an 8-bit image instead of a yes or no:
/// the largest t for which nine neighbours on the circle are all t brighter, or all t darker, than the centre. Fills
/// scores[3] to scores[columns - 4]; `row` is at least 3 from the upper and lower edge. Integers only: the same bytes
/// on every machine, whichever of its instructions are used.
void FastScoresOfRow(const cv::Mat& image, int row, uint8_t* scores);

}  // namespace kinemap
