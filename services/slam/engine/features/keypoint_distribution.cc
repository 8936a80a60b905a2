// SPDX-License-Identifier: Apache-2.0
#include "features/keypoint_distribution.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

namespace kinemap {
namespace {

/// A rectangle of the image and the corners inside it: a run of the order below.
struct Part {
  float x, y, width, height;
  int begin, end;
  int size() const { return end - begin; }
};

/// Fullest first; equally full ones by age.
struct Urgency {
  int corners;
  int part;
  bool operator<(const Urgency& other) const {
    return corners != other.corners ? corners < other.corners : part > other.part;
  }
};

class Quadtree {
 public:
  explicit Quadtree(const std::vector<Corner>& corners) : corners_(corners), order_(corners.size()) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  void AddRoots(const cv::Rect& area) {
    // Starting from squares keeps the parts square in a wide image.
    const int count = std::max(1, static_cast<int>(std::lround(static_cast<double>(area.width) / area.height)));
    const float width = static_cast<float>(area.width) / static_cast<float>(count);
    int begin = 0;
    for (int i = 0; i < count; ++i) {
      const float right = static_cast<float>(area.x) + static_cast<float>(i + 1) * width;
      const auto in_column = [&](int index) { return static_cast<float>(corners_[index].column) < right; };
      const auto middle =
          i + 1 == count ? order_.end() : std::partition(order_.begin() + begin, order_.end(), in_column);
      const int end = static_cast<int>(middle - order_.begin());
      Add({right - width, static_cast<float>(area.y), width, static_cast<float>(area.height), begin, end});
      begin = end;
    }
  }

  void SplitUntil(int count) {
    while (!urgent_.empty() && occupied_ < count) {
      const Part part = parts_[urgent_.top().part];
      parts_[urgent_.top().part].end = part.begin;
      urgent_.pop();
      --occupied_;
      const float width = part.width / 2, height = part.height / 2;
      const float middle_x = part.x + width, middle_y = part.y + height;
      const auto is_above = [&](int index) { return static_cast<float>(corners_[index].row) < middle_y; };
      const auto is_left = [&](int index) { return static_cast<float>(corners_[index].column) < middle_x; };
      const int row = Partition(part.begin, part.end, is_above);
      const int upper = Partition(part.begin, row, is_left), lower = Partition(row, part.end, is_left);
      Add({part.x, part.y, width, height, part.begin, upper});
      Add({middle_x, part.y, width, height, upper, row});
      Add({part.x, middle_y, width, height, row, lower});
      Add({middle_x, middle_y, width, height, lower, part.end});
    }
  }

  std::vector<Corner> StrongestOfEach() const {
    std::vector<Corner> chosen;
    chosen.reserve(occupied_);
    for (const Part& part : parts_) {
      if (part.size() == 0) continue;
      const int best = *std::max_element(order_.begin() + part.begin, order_.begin() + part.end, [&](int a, int b) {
        return corners_[a].score != corners_[b].score ? corners_[a].score < corners_[b].score : a > b;
      });
      chosen.push_back(corners_[best]);
    }
    return chosen;
  }

 private:
  void Add(const Part& part) {
    if (part.size() == 0) return;
    ++occupied_;
    // A part of less than a pixel cannot be split further: its corners share one place.
    if (part.size() > 1 && part.width > 1) urgent_.push({part.size(), static_cast<int>(parts_.size())});
    parts_.push_back(part);
  }

  /// Where the second half begins. The order within a half does not matter: ties are broken by index.
  template <typename IsFirst>
  int Partition(int begin, int end, IsFirst is_first) {
    return static_cast<int>(std::partition(order_.begin() + begin, order_.begin() + end, is_first) - order_.begin());
  }

  const std::vector<Corner>& corners_;
  std::vector<int> order_;
  std::vector<Part> parts_;
  std::priority_queue<Urgency> urgent_;
  int occupied_ = 0;
};

}  // namespace

std::vector<Corner> DistributeEvenly(const std::vector<Corner>& corners, const cv::Rect& area_px, int count) {
  if (static_cast<int>(corners.size()) <= count) return corners;
  Quadtree tree(corners);
  tree.AddRoots(area_px);
  tree.SplitUntil(count);
  return tree.StrongestOfEach();
}

}  // namespace kinemap
