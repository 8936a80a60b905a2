// SPDX-License-Identifier: Apache-2.0
#include "features/fast_score.h"

#include "features/simd_dispatch.h"

namespace kinemap {
namespace {

inline uint8_t Smaller(uint8_t a, uint8_t b) { return a < b ? a : b; }
inline uint8_t Larger(uint8_t a, uint8_t b) { return a > b ? a : b; }

/// The circle's pixels lie on seven rows; `rows[3]` is the centre's.
KINEMAP_INLINE_INTO_DISPATCH void ScoreRow(const uint8_t* const* rows, int columns, uint8_t* __restrict scores) {
  const uint8_t *r0 = rows[0], *r1 = rows[1], *r2 = rows[2], *r3 = rows[3], *r4 = rows[4], *r5 = rows[5], *r6 = rows[6];
  for (int x = kFastRadiusPx; x < columns - kFastRadiusPx; ++x) {
    const uint8_t p[16] = {r0[x], r0[x + 1], r1[x + 2], r2[x + 3], r3[x + 3], r4[x + 3], r5[x + 2], r6[x + 1],
                           r6[x], r6[x - 1], r5[x - 2], r4[x - 3], r3[x - 3], r2[x - 3], r1[x - 2], r0[x - 1]};
    // The arcs that begin at i and at i + 1 share eight pixels, so one minimum over eight serves both.
    uint8_t low2[8], low4[8], high2[8], high4[8];
    for (int i = 0; i < 8; ++i) {
      low2[i] = Smaller(p[2 * i + 1], p[(2 * i + 2) & 15]);
      high2[i] = Larger(p[2 * i + 1], p[(2 * i + 2) & 15]);
    }
    for (int i = 0; i < 8; ++i) {
      low4[i] = Smaller(low2[i], low2[(i + 1) & 7]);
      high4[i] = Larger(high2[i], high2[(i + 1) & 7]);
    }
    uint8_t brightest_arc = 0, darkest_arc = 255;
    for (int i = 0; i < 8; ++i) {
      const uint8_t before = p[2 * i], after = p[(2 * i + 9) & 15];
      const uint8_t low8 = Smaller(low4[i], low4[(i + 2) & 7]), high8 = Larger(high4[i], high4[(i + 2) & 7]);
      brightest_arc = Larger(brightest_arc, Smaller(low8, Larger(before, after)));
      darkest_arc = Smaller(darkest_arc, Larger(high8, Smaller(before, after)));
    }
    const uint8_t center = r3[x];
    const uint8_t brighter = static_cast<uint8_t>(Larger(brightest_arc, center) - center);
    const uint8_t darker = static_cast<uint8_t>(center - Smaller(darkest_arc, center));
    scores[x] = Larger(brighter, darker);
  }
}

KINEMAP_DISPATCH(ScoreRow, (const uint8_t* const* rows, int columns, uint8_t* scores), (rows, columns, scores))

}  // namespace

void FastScoresOfRow(const cv::Mat& image, int row, uint8_t* scores) {
  const uint8_t* rows[2 * kFastRadiusPx + 1];
  for (int i = 0; i <= 2 * kFastRadiusPx; ++i) rows[i] = image.ptr<uint8_t>(row + i - kFastRadiusPx);
  ScoreRowDispatched(rows, image.cols, scores);
}

}  // namespace kinemap
