// SPDX-License-Identifier: Apache-2.0
#include "features/thread_team.h"

namespace kinemap {

ThreadTeam::ThreadTeam(int size) {
  for (int i = 1; i < size; ++i) threads_.emplace_back([this] { Work(); });
}

ThreadTeam::~ThreadTeam() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  work_came_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadTeam::Run(int count, const std::function<void(int)>& task) {
  std::unique_lock lock(mutex_);
  task_ = &task;
  next_ = 0;
  count_ = unfinished_ = count;
  failure_ = nullptr;
  work_came_.notify_all();
  DoTasks(lock);
  work_done_.wait(lock, [this] { return unfinished_ == 0; });
  if (failure_) std::rethrow_exception(failure_);
}

void ThreadTeam::DoTasks(std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const int index = next_++;
    lock.unlock();
    std::exception_ptr failure;
    try {
      (*task_)(index);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !failure_) failure_ = failure;
    if (--unfinished_ == 0) work_done_.notify_all();
  }
}

void ThreadTeam::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_came_.wait(lock, [this] { return ends_ || next_ < count_; });
    if (ends_) return;
    DoTasks(lock);
  }
}

}  // namespace kinemap
