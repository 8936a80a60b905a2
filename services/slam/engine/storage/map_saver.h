// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <string>
#include <utility>

#include "storage/map_snapshot.h"

namespace kinemap {

/// Writes map files in a background thread, one after the other.
class MapSaver {
 public:
  MapSaver() = default;
  ~MapSaver() {
    if (running_.valid()) running_.wait();
  }
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  /// Waits for the file before it. Throws what went wrong with that one.
  void Start(MapSnapshot snapshot, const std::string& path) {
    Wait();
    running_ = std::async(std::launch::async,
                          [snapshot = std::move(snapshot), path] { WriteFileAtomically(path, snapshot.Bytes()); });
  }

  void Wait() {
    if (running_.valid()) running_.get();
  }

 private:
  std::future<void> running_;
};

}  // namespace kinemap
