// SPDX-License-Identifier: Apache-2.0
#include "ground/object_contacts.h"

#include <algorithm>

namespace kinemap {
namespace {

constexpr int kOcclusionPx = 4;  // another object so close below hides the contact
constexpr double kLeastKnownColumns = 0.3;
constexpr int kLeastColumns = 4;
constexpr double kLeastSlope = 0.02;  // nearer to the horizon a pixel is worth too many metres

int64_t Turn(const cv::Point& a, const cv::Point& b, const cv::Point& c) {
  return static_cast<int64_t>(b.x - a.x) * (c.y - a.y) - static_cast<int64_t>(b.y - a.y) * (c.x - a.x);
}

}  // namespace

ObjectContacts::ObjectContacts(const cv::Mat& track_image, const CameraModel& camera, const GroundPlane& plane)
    : camera_(camera), plane_(plane) {
  ReadOutlines(track_image);
  for (auto& [id, outline] : outlines_) FindHull(&outline);
}

void ObjectContacts::ReadOutlines(const cv::Mat& track_image) {
  std::map<uint32_t, cv::Range> columns;
  const auto run_through = [&](const auto& visit) {
    for (int row = 0; row < track_image.rows; ++row) {
      const int* ids = track_image.ptr<int>(row);
      for (int column = 0; column < track_image.cols;) {
        const int first = column, id = ids[column];
        while (column < track_image.cols && ids[column] == id) ++column;
        if (id != 0) visit(static_cast<uint32_t>(id), row, first, column - 1);
      }
    }
  };
  run_through([&](uint32_t id, int, int first, int last) {
    const auto [entry, is_new] = outlines_.try_emplace(id);
    Outline& outline = entry->second;
    outline.left = is_new ? first : std::min(outline.left, first);
    outline.right = std::max(outline.right, last);
  });
  for (auto& [id, outline] : outlines_) outline.lowest_row.assign(outline.right - outline.left + 1, -1);
  run_through([&](uint32_t id, int row, int first, int last) {
    Outline& outline = outlines_[id];
    std::fill(outline.lowest_row.begin() + (first - outline.left),
              outline.lowest_row.begin() + (last + 1 - outline.left), row);
  });
  for (auto& [id, outline] : outlines_) {
    for (size_t i = 0; i < outline.lowest_row.size(); ++i) {
      int& lowest = outline.lowest_row[i];
      const int column = outline.left + static_cast<int>(i);
      bool hidden = lowest + kOcclusionPx >= track_image.rows;
      for (int below = 1; !hidden && below <= kOcclusionPx; ++below) {
        hidden = track_image.at<int>(lowest + below, column) != 0;
      }
      if (hidden) lowest = -1;
    }
  }
}

void ObjectContacts::FindHull(Outline* outline) {
  // Andrew's monotone chain; rows grow downwards, so the lower hull is the one of largest rows.
  size_t known = 0;
  for (size_t i = 0; i < outline->lowest_row.size(); ++i) {
    if (outline->lowest_row[i] < 0) continue;
    ++known;
    const cv::Point point(outline->left + static_cast<int>(i), outline->lowest_row[i]);
    std::vector<cv::Point>& hull = outline->hull;
    while (hull.size() >= 2 && Turn(hull[hull.size() - 2], hull.back(), point) >= 0) hull.pop_back();
    hull.push_back(point);
  }
  const bool is_enough = static_cast<double>(known) >= kLeastKnownColumns * outline->lowest_row.size();
  if (known < kLeastColumns || !is_enough) outline->hull.clear();
}

std::optional<Eigen::Vector3d> ObjectContacts::OnRoad(double column, double row) const {
  // The last row of a mask ends half a pixel below its centre.
  const Eigen::Vector3d ray = camera_.Ray(camera_.Undistort({column, row + 0.5}));
  const double slope = plane_.normal.dot(ray);
  if (slope < kLeastSlope) return std::nullopt;
  return plane_.height / slope * ray;
}

std::vector<ObjectContact> ObjectContacts::All() const {
  std::vector<ObjectContact> contacts;
  for (const auto& [id, outline] : outlines_) {
    if (outline.hull.empty()) continue;
    // A mask narrows towards its ends, where its lowest pixel is no contact: the hull a little further in is.
    const int inset = static_cast<int>(outline.lowest_row.size()) / 12;
    const auto row_at = [&](int column) {
      const auto after = std::find_if(outline.hull.begin(), outline.hull.end(),
                                      [&](const cv::Point& point) { return point.x >= column; });
      if (after == outline.hull.end()) return static_cast<double>(outline.hull.back().y);
      if (after == outline.hull.begin()) return static_cast<double>(after->y);
      const cv::Point &a = *(after - 1), &b = *after;
      return a.y + static_cast<double>(b.y - a.y) * (column - a.x) / (b.x - a.x);
    };
    const int left = outline.left + inset, right = outline.right - inset;
    const cv::Point lowest = *std::max_element(outline.hull.begin(), outline.hull.end(),
                                               [](const cv::Point& a, const cv::Point& b) { return a.y < b.y; });
    const auto on_left = OnRoad(left, row_at(left)), on_right = OnRoad(right, row_at(right)),
               nearest = OnRoad(lowest.x, lowest.y);
    if (on_left && on_right && nearest) contacts.push_back({id, *on_left, *nearest, *on_right});
  }
  return contacts;
}

std::optional<double> ObjectContacts::Depth(uint32_t object_id, double column) const {
  const auto found = outlines_.find(object_id);
  if (found == outlines_.end() || found->second.hull.empty()) return std::nullopt;
  const std::vector<cv::Point>& hull = found->second.hull;
  const double inside = std::clamp(column, static_cast<double>(hull.front().x), static_cast<double>(hull.back().x));
  size_t i = 1;
  while (i + 1 < hull.size() && hull[i].x < inside) ++i;
  double row = hull.back().y;
  if (hull.size() > 1) {
    const cv::Point &a = hull[i - 1], &b = hull[i];
    row = a.y + (b.y - a.y) * (inside - a.x) / (b.x - a.x);
  }
  const std::optional<Eigen::Vector3d> contact = OnRoad(inside, row);
  if (!contact) return std::nullopt;
  return contact->z();
}

}  // namespace kinemap
