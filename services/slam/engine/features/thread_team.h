// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace kinemap {

/// Threads that wait for work and share it with the caller. Which thread does what is left to chance, so tasks must not
/// depend on one another.
class ThreadTeam {
 public:
  /// `size` counts the caller: 1 means no thread of its own.
  explicit ThreadTeam(int size);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// Calls task(0) to task(count - 1), some of them at the same time, and returns when all are done. Throws what the
  /// first failing task threw. Not for two callers at once.
  void Run(int count, const std::function<void(int)>& task);

 private:
  void Work();
  void DoTasks(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable work_came_, work_done_;
  const std::function<void(int)>* task_ = nullptr;
  int next_ = 0, count_ = 0, unfinished_ = 0;
  std::exception_ptr failure_;
  bool ends_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace kinemap
