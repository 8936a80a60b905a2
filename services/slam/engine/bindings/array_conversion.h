// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "features/object_labels.h"
#include "map_update.h"

namespace kinemap {

/// "name: expected ..., got float64 array of shape (3, 4)"
std::string Mismatch(const char* name, const std::string& expected, const pybind11::array& array);

/// The array's own memory as an image, without a copy or a conversion: it must live as long as the view. Throws
/// std::invalid_argument when it is not a C-contiguous matrix of this type.
template <typename Scalar>
cv::Mat ImageView(const char* name, const pybind11::array& array, int cv_type) {
  const bool fits =
      pybind11::dtype::of<Scalar>().is(array.dtype()) || pybind11::isinstance<pybind11::array_t<Scalar>>(array);
  if (!fits || array.ndim() != 2 || !(array.flags() & pybind11::array::c_style)) {
    const std::string type = pybind11::str(pybind11::dtype::of<Scalar>());
    throw std::invalid_argument(Mismatch(name, "a C-contiguous " + type + " array of shape (height, width)", array));
  }
  return {static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), cv_type, const_cast<void*>(array.data())};
}

/// Object table from its three columns (uint32, int32, uint8, equally long). Throws std::invalid_argument otherwise and
/// for a motion state above 4.
std::vector<ObjectRow> ObjectRows(const pybind11::array& object_ids, const pybind11::array& categories,
                                  const pybind11::array& motion_states);

/// One numpy array a column, named as the column.
pybind11::dict ToDict(const MapUpdate& update);

}  // namespace kinemap
