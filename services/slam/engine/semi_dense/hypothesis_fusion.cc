// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/hypothesis_fusion.h"

#include <cmath>

namespace kinemap {

InverseDepth FuseHypotheses(const std::vector<InverseDepth>& hypotheses, int least_agreeing) {
  int most = least_agreeing - 1;
  const InverseDepth* center = nullptr;
  for (const InverseDepth& candidate : hypotheses) {
    int agreeing = 0;
    for (const InverseDepth& other : hypotheses) agreeing += AreCompatible(candidate, other) ? 1 : 0;
    if (agreeing <= most) continue;
    most = agreeing;
    center = &candidate;
  }
  if (center == nullptr) return {};
  InverseDepthMean mean;
  for (const InverseDepth& other : hypotheses) {
    if (AreCompatible(*center, other)) mean.Add(other);
  }
  return {mean.value(), 1 / std::sqrt(mean.weight())};
}

}  // namespace kinemap
