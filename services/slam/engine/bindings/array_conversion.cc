// SPDX-License-Identifier: Apache-2.0
#include "bindings/array_conversion.h"

#include <cstring>

namespace py = pybind11;

namespace kinemap {
namespace {

template <typename Scalar>
const Scalar* Column(const char* name, const py::array& array) {
  if (!py::isinstance<py::array_t<Scalar>>(array) || array.ndim() != 1 || !(array.flags() & py::array::c_style)) {
    const std::string type = py::str(py::dtype::of<Scalar>());
    throw std::invalid_argument(Mismatch(name, "a contiguous " + type + " array of shape (objects,)", array));
  }
  return static_cast<const Scalar*>(array.data());
}

template <typename Scalar>
py::array ToArray(const std::vector<Scalar>& values) {
  return py::array_t<Scalar>(static_cast<py::ssize_t>(values.size()), values.data());
}

template <typename Scalar, size_t kWidth>
py::array_t<Scalar> ToArray(const std::vector<std::array<Scalar, kWidth>>& rows) {
  py::array_t<Scalar> array({rows.size(), kWidth});
  if (!rows.empty()) std::memcpy(array.mutable_data(), rows.data(), rows.size() * sizeof(rows[0]));
  return array;
}

}  // namespace

std::string Mismatch(const char* name, const std::string& expected, const py::array& array) {
  std::string shape = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) shape += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  const std::string type = py::str(array.dtype());
  const char* layout = array.flags() & py::array::c_style ? "" : "non-contiguous ";
  return std::string(name) + ": expected " + expected + ", got a " + layout + type + " array of shape " + shape + ")";
}

std::vector<ObjectRow> ObjectRows(const py::array& object_ids, const py::array& categories,
                                  const py::array& motion_states) {
  const uint32_t* ids = Column<uint32_t>("object_ids", object_ids);
  const int32_t* category = Column<int32_t>("categories", categories);
  const uint8_t* state = Column<uint8_t>("motion_states", motion_states);
  const py::ssize_t count = object_ids.shape(0);
  if (categories.shape(0) != count || motion_states.shape(0) != count) {
    throw std::invalid_argument("objects: expected columns of one length, got " + std::to_string(count) + " ids, " +
                                std::to_string(categories.shape(0)) + " categories and " +
                                std::to_string(motion_states.shape(0)) + " motion states");
  }
  std::vector<ObjectRow> rows;
  for (py::ssize_t i = 0; i < count; ++i) {
    if (state[i] > static_cast<uint8_t>(MotionState::kPotentiallyDynamic)) {
      throw std::invalid_argument("motion_states: expected 0 to 4, got " + std::to_string(state[i]));
    }
    rows.push_back({ids[i], category[i], static_cast<MotionState>(state[i])});
  }
  return rows;
}

py::dict ToDict(const MapUpdate& update) {
  py::dict columns;
  columns["keyframe_id"] = ToArray(update.keyframe_id);
  columns["keyframe_timestamp_ns"] = ToArray(update.keyframe_timestamp_ns);
  columns["keyframe_map_id"] = ToArray(update.keyframe_map_id);
  columns["keyframe_pose"] = ToArray(update.keyframe_pose);
  columns["keyframe_culled"] = ToArray(update.keyframe_culled);
  columns["keyframe_parent_id"] = ToArray(update.keyframe_parent_id);
  columns["landmark_id"] = ToArray(update.landmark_id);
  columns["landmark_anchor_id"] = ToArray(update.landmark_anchor_id);
  columns["landmark_position"] = ToArray(update.landmark_position);
  columns["landmark_state"] = ToArray(update.landmark_state);
  columns["landmark_category"] = ToArray(update.landmark_category);
  columns["landmark_object_id"] = ToArray(update.landmark_object_id);
  columns["landmark_first_seen_ns"] = ToArray(update.landmark_first_seen_ns);
  columns["landmark_last_seen_ns"] = ToArray(update.landmark_last_seen_ns);
  columns["landmark_valid_until_ns"] = ToArray(update.landmark_valid_until_ns);
  columns["removed_landmark_id"] = ToArray(update.removed_landmark_id);
  columns["dense_keyframe_id"] = ToArray(update.dense_keyframe_id);
  columns["dense_keyframe_points"] = ToArray(update.dense_keyframe_points);
  columns["dense_point_position"] = ToArray(update.dense_point_position);
  columns["dense_point_depth_sigma"] = ToArray(update.dense_point_depth_sigma);
  columns["dense_point_grey"] = ToArray(update.dense_point_grey);
  columns["dense_point_state"] = ToArray(update.dense_point_state);
  columns["dense_point_category"] = ToArray(update.dense_point_category);
  columns["dense_point_object_id"] = ToArray(update.dense_point_object_id);
  columns["frame_timestamp_ns"] = ToArray(update.frame_timestamp_ns);
  columns["frame_reference_keyframe_id"] = ToArray(update.frame_reference_keyframe_id);
  columns["frame_camera_from_reference"] = ToArray(update.frame_camera_from_reference);
  return columns;
}

}  // namespace kinemap
