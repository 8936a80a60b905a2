// SPDX-License-Identifier: Apache-2.0
#include "features/feature_budget.h"

#include <algorithm>

namespace kinemap {
namespace {
// A few objects at the side are no reason to spend more time.
constexpr double kEnoughTracked = 0.8;
constexpr double kMost = 2;
}  // namespace

void FeatureBudget::Observe(const std::vector<FeatureLabel>& labels) {
  const auto tracked = std::count_if(labels.begin(), labels.end(),
                                     [](const FeatureLabel& label) { return label.role == FeatureRole::kTracked; });
  const double share = labels.empty() ? 1.0 : static_cast<double>(tracked) / static_cast<double>(labels.size());
  next_ = share >= kEnoughTracked ? wanted_ : static_cast<int>(wanted_ * std::min(kMost, 1 / std::max(share, 1e-9)));
}

}  // namespace kinemap
