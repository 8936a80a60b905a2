// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/gradient_pixels.h"

#include <array>
#include <cmath>

namespace kinemap {

std::vector<cv::Point> FindGradientPixels(const KeyframeView& view, float least_gradient, int most, int margin_px) {
  constexpr int kBins = 512;  // grey levels a pixel
  std::array<int, kBins> histogram{};
  const float least = least_gradient * KeyframeView::kGradientUnit;
  const auto least_squared = static_cast<int>(std::ceil(least * least));
  std::vector<cv::Point> pixels;
  std::vector<int> moduli;
  for (int row = margin_px; row < view.grey.rows - margin_px; ++row) {
    const auto* gradient = view.gradient.ptr<cv::Vec2s>(row);
    for (int column = margin_px; column < view.grey.cols - margin_px; ++column) {
      const int x = gradient[column][0], y = gradient[column][1];
      if (x * x + y * y < least_squared) continue;
      const FeatureRole role = view.labels.LabelAt(column, row).role;
      if (role == FeatureRole::kSighted || role == FeatureRole::kIgnored) continue;
      const double modulus = std::sqrt(static_cast<double>(x * x + y * y)) / KeyframeView::kGradientUnit;
      pixels.emplace_back(column, row);
      moduli.push_back(static_cast<int>(modulus));
      ++histogram[moduli.back()];
    }
  }
  if (static_cast<int>(pixels.size()) <= most) return pixels;
  int kept = 0, lowest = kBins;
  while (lowest > 0 && kept + histogram[lowest - 1] <= most) kept += histogram[--lowest];
  size_t count = 0;
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (moduli[i] >= lowest) pixels[count++] = pixels[i];
  }
  pixels.resize(count);
  return pixels;
}

}  // namespace kinemap
