// SPDX-License-Identifier: Apache-2.0
#include "features/keypoint_distribution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

namespace kinemap {
namespace {

/// A rectangle of the image and the corners inside it.
struct Part {
  cv::Rect2f area;
  std::vector<int> corners;
};

/// Fullest first; equally full ones by age.
struct Urgency {
  size_t corners;
  size_t part;
  bool operator<(const Urgency& other) const {
    return corners != other.corners ? corners < other.corners : part > other.part;
  }
};

std::array<Part, 4> Split(const Part& part, const std::vector<cv::KeyPoint>& corners) {
  const float width = part.area.width / 2, height = part.area.height / 2;
  std::array<Part, 4> quarters;
  for (int i = 0; i < 4; ++i) {
    quarters[i].area = {part.area.x + (i % 2) * width, part.area.y + (i / 2) * height, width, height};
  }
  const float middle_x = part.area.x + width, middle_y = part.area.y + height;
  for (const int index : part.corners) {
    const cv::Point2f& point = corners[index].pt;
    quarters[(point.x >= middle_x ? 1 : 0) + (point.y >= middle_y ? 2 : 0)].corners.push_back(index);
  }
  return quarters;
}

}  // namespace

std::vector<cv::KeyPoint> DistributeEvenly(const std::vector<cv::KeyPoint>& corners, const cv::Size& area_px,
                                           int count) {
  if (static_cast<int>(corners.size()) <= count) return corners;
  std::vector<Part> parts;
  std::priority_queue<Urgency> urgent;
  size_t occupied = 0;
  const auto add = [&](Part part) {
    if (part.corners.empty()) return;
    ++occupied;
    // A part of less than a pixel cannot be split further: its corners share one place.
    if (part.corners.size() > 1 && part.area.width > 1) urgent.push({part.corners.size(), parts.size()});
    parts.push_back(std::move(part));
  };
  // Starting from squares keeps the parts square in a wide image.
  const int columns = std::max(1, static_cast<int>(std::lround(static_cast<double>(area_px.width) / area_px.height)));
  const float column_width = static_cast<float>(area_px.width) / columns;
  std::vector<Part> roots(columns);
  for (int i = 0; i < columns; ++i)
    roots[i].area = {i * column_width, 0, column_width, static_cast<float>(area_px.height)};
  for (size_t i = 0; i < corners.size(); ++i) {
    const int column = std::clamp(static_cast<int>(corners[i].pt.x / column_width), 0, columns - 1);
    roots[column].corners.push_back(static_cast<int>(i));
  }
  for (Part& root : roots) add(std::move(root));
  while (!urgent.empty() && static_cast<int>(occupied) < count) {
    const size_t index = urgent.top().part;
    urgent.pop();
    std::array<Part, 4> quarters = Split(parts[index], corners);
    parts[index].corners.clear();
    --occupied;
    for (Part& quarter : quarters) add(std::move(quarter));
  }
  std::vector<cv::KeyPoint> chosen;
  chosen.reserve(occupied);
  for (const Part& part : parts) {
    if (part.corners.empty()) continue;
    const int best = *std::max_element(part.corners.begin(), part.corners.end(), [&](int a, int b) {
      return corners[a].response != corners[b].response ? corners[a].response < corners[b].response : a > b;
    });
    chosen.push_back(corners[best]);
  }
  return chosen;
}

}  // namespace kinemap
