// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <utility>

namespace kinemap {

/// Room for one problem that is solved in a thread of its own. The solution is taken at a frame fixed when it starts,
/// so that a map does not depend on how fast the machine is; or it is given up, which leaves no trace.
template <typename Problem>
class BackgroundSlot {
 public:
  using Cancelled = std::shared_ptr<std::atomic<bool>>;
  /// Solves in place; may end early once `cancelled` is true.
  using Solve = std::function<void(const std::atomic<bool>& cancelled, Problem*)>;

  BackgroundSlot() = default;
  ~BackgroundSlot() { Cancel(); }
  BackgroundSlot(const BackgroundSlot&) = delete;
  BackgroundSlot& operator=(const BackgroundSlot&) = delete;

  bool IsFree() const { return !running_.valid(); }
  /// From its frame on; unless `wait`, only once Take would not have to wait.
  bool IsDue(int64_t frame, bool wait) const {
    if (IsFree() || frame < due_frame_) return false;
    return wait || running_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }

  /// The slot must be free.
  void Start(Problem problem, Solve solve, int64_t due_frame) {
    if (!IsFree()) throw std::logic_error("background slot: started while a problem is being solved");
    // What was given up must have let go of its processor before the next one wants it.
    abandoned_ = {};
    due_frame_ = due_frame;
    cancelled_ = std::make_shared<std::atomic<bool>>(false);
    running_ = std::async(
        std::launch::async, [problem = std::move(problem), solve = std::move(solve), cancelled = cancelled_]() mutable {
          solve(*cancelled, &problem);
          // The thread is new, so that its processor time is the solving's.
          timespec time{};
          clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
          return Solved{std::move(problem),
                        1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec)};
        });
  }

  /// Waits for the solution and frees the slot, which must not be free.
  Problem Take() {
    Solved solved = running_.get();
    solve_ms_ = solved.solve_ms;
    return std::move(solved.problem);
  }

  /// Frees the slot without a solution and without waiting.
  void Cancel() {
    if (IsFree()) return;
    *cancelled_ = true;
    abandoned_ = std::move(running_);
  }

  /// Processor time of the last problem taken; for reports only.
  double solve_ms() const { return solve_ms_; }

 private:
  struct Solved {
    Problem problem;
    double solve_ms;
  };

  Cancelled cancelled_;
  std::future<Solved> running_, abandoned_;
  int64_t due_frame_ = 0;
  double solve_ms_ = 0;
};

}  // namespace kinemap
