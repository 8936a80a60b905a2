// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "geometry/camera_model.h"
#include "ground/ground_plane.h"

namespace kinemap {

/// Where an object touches the road, in the camera frame, in the units of the plane.
struct ObjectContact {
  uint32_t object_id;
  Eigen::Vector3d left, nearest, right;  ///< ends of its lower outline, and the point of it nearest to the camera
};

/// The lower outlines of a frame's objects, put on the road. An object's outline is the lower convex hull of its mask,
/// so that what lies between two wheels does not count; where the image or another object cuts it off, nothing is
/// known.
class ObjectContacts {
 public:
  /// `track_image`: CV_32S, pixel = object id, 0 background.
  ObjectContacts(const cv::Mat& track_image, const CameraModel& camera, const GroundPlane& plane);

  /// By object id.
  std::vector<ObjectContact> All() const;

  /// Depth along the optical axis of what stands upright over the outline in this column of the image as it came.
  std::optional<double> Depth(uint32_t object_id, double column) const;

 private:
  struct Outline {
    int left = 0, right = -1;     ///< columns
    std::vector<int> lowest_row;  ///< one a column from `left`; -1 where nothing is known
    std::vector<cv::Point> hull;  ///< by column
  };

  void ReadOutlines(const cv::Mat& track_image);
  static void FindHull(Outline* outline);
  std::optional<Eigen::Vector3d> OnRoad(double column, double row) const;

  CameraModel camera_;
  GroundPlane plane_;
  std::map<uint32_t, Outline> outlines_;
};

}  // namespace kinemap
