// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_bundle_adjuster.h"

#include <set>

namespace kinemap {

BundleProblem LocalBundleAdjuster::CopyProblem(const SlamMap& map, KeyframeId keyframe_id) const {
  std::set<KeyframeId> moving{keyframe_id};
  for (const KeyframeId id : map.covisibility().Neighbors(keyframe_id, options_.keyframes - 1, options_.min_shared)) {
    moving.insert(id);
  }
  return CopyBundleProblem(map, moving);
}

}  // namespace kinemap
