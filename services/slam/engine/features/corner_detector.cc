// SPDX-License-Identifier: Apache-2.0
#include "features/corner_detector.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "features/fast_score.h"
#include "features/simd_dispatch.h"

namespace kinemap {
namespace {

constexpr int kCellPx = 35;

inline uint8_t Larger(uint8_t a, uint8_t b) { return a > b ? a : b; }

/// Of equal neighbours the last one is the maximum.
KINEMAP_INLINE_INTO_DISPATCH void MarkMaxima(const uint8_t* above, const uint8_t* scores, const uint8_t* below,
                                             int first, int last, uint8_t threshold, uint8_t* __restrict is_maximum) {
  for (int x = first; x < last; ++x) {
    const uint8_t before = Larger(Larger(above[x - 1], above[x]), Larger(above[x + 1], scores[x - 1]));
    const uint8_t after = Larger(Larger(below[x - 1], below[x]), Larger(below[x + 1], scores[x + 1]));
    const uint8_t least = Larger(before, threshold);
    is_maximum[x] = static_cast<uint8_t>((scores[x] >= least ? 1 : 0) & (scores[x] > after ? 1 : 0) &
                                         (scores[x] > threshold ? 1 : 0));
  }
}

KINEMAP_DISPATCH(MarkMaxima,
                 (const uint8_t* above, const uint8_t* scores, const uint8_t* below, int first, int last,
                  uint8_t threshold, uint8_t* is_maximum),
                 (above, scores, below, first, last, threshold, is_maximum))

}  // namespace

const std::vector<Corner>& CornerDetector::Detect(const cv::Mat& image, int border_px) {
  corners_.clear();
  if (image.cols <= 2 * border_px || image.rows <= 2 * border_px) return corners_;
  FindMaxima(image, border_px);
  KeepStrongOrAlone(image.size(), border_px);
  return corners_;
}

void CornerDetector::FindMaxima(const cv::Mat& image, int border_px) {
  const size_t stride = image.cols;
  scores_.resize(3 * stride);
  is_maximum_.assign(stride + sizeof(uint64_t), 0);
  const auto scores_of = [&](int row) { return scores_.data() + row % 3 * stride; };
  for (int row = border_px - 1; row <= border_px; ++row) FastScoresOfRow(image, row, scores_of(row));
  for (int row = border_px; row < image.rows - border_px; ++row) {
    FastScoresOfRow(image, row + 1, scores_of(row + 1));
    const uint8_t *above = scores_of(row - 1), *scores = scores_of(row), *below = scores_of(row + 1);
    const int last = image.cols - border_px;
    MarkMaximaDispatched(above, scores, below, border_px, last, static_cast<uint8_t>(thresholds_.faint),
                         is_maximum_.data());
    for (int x = border_px; x < last; x += static_cast<int>(sizeof(uint64_t))) {
      uint64_t eight;
      std::memcpy(&eight, is_maximum_.data() + x, sizeof(eight));
      static_assert(std::endian::native == std::endian::little);
      for (; eight != 0; eight &= eight - 1) {
        const int column = x + std::countr_zero(eight) / 8;
        corners_.push_back({static_cast<int16_t>(column), static_cast<int16_t>(row), scores[column], scores[column - 1],
                            scores[column + 1], above[column], below[column]});
      }
    }
  }
}

void CornerDetector::KeepStrongOrAlone(const cv::Size& size, int border_px) {
  const int columns = (size.width - 2 * border_px + kCellPx - 1) / kCellPx;
  const int rows = (size.height - 2 * border_px + kCellPx - 1) / kCellPx;
  cell_has_strong_.assign(columns * rows, 0);
  const auto cell_of = [&](const Corner& corner) {
    return (corner.row - border_px) / kCellPx * columns + (corner.column - border_px) / kCellPx;
  };
  for (const Corner& corner : corners_) {
    if (corner.score > thresholds_.strong) cell_has_strong_[cell_of(corner)] = 1;
  }
  std::erase_if(corners_, [&](const Corner& corner) {
    return corner.score <= thresholds_.strong && cell_has_strong_[cell_of(corner)];
  });
}

}  // namespace kinemap
