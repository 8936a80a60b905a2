// SPDX-License-Identifier: Apache-2.0
#include "mapping/merge_slot.h"

#include <stdexcept>
#include <utility>

namespace kinemap {

MergeSlot::~MergeSlot() {
  if (running_.valid()) running_.wait();
}

void MergeSlot::Start(BundleProblem problem, int64_t due_frame) {
  if (!IsFree()) throw std::logic_error("merge slot: started while a bundle adjustment is running");
  due_frame_ = due_frame;
  running_ =
      std::async(std::launch::async, [camera = camera_, options = options_, problem = std::move(problem)]() mutable {
        SolveBundle(camera, options, &problem);
        return std::move(problem);
      });
}

}  // namespace kinemap
