// SPDX-License-Identifier: Apache-2.0
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include "bindings/array_conversion.h"
#include "bindings/vocabulary_bindings.h"
#include "engine.h"
#include "storage/map_saver.h"

namespace py = pybind11;

namespace kinemap {
namespace {

/// The engine behind a lock, so that two Python threads cannot enter it while the GIL is released.
class LockedEngine {
 public:
  LockedEngine(const CameraModel& camera, const EngineOptions& options)
      : camera_(camera), options_(options), engine_(std::make_unique<Engine>(camera, options)) {}

  void BeginFrame(int64_t timestamp_ns, const py::array& image, const std::optional<py::array>& right,
                  const std::optional<py::array>& depth_m) {
    const cv::Mat view = ImageView<uint8_t>("image", image, CV_8U);
    cv::Mat right_view, depth_view;
    if (right) right_view = ImageView<uint8_t>("right", *right, CV_8U);
    if (depth_m) depth_view = ImageView<float>("depth_m", *depth_m, CV_32F);
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    engine_->BeginFrame(timestamp_ns, view, right_view, depth_view);
  }

  TrackingResult FinishFrame(const std::optional<py::array>& track_image, const py::array& object_ids,
                             const py::array& categories, const py::array& motion_states, bool masks_fresh) {
    FrameObjects objects;
    // CV_32S holds the same bits; OpenCV 4.6 knows no unsigned 32-bit matrix.
    if (track_image) objects.track_image = ImageView<uint32_t>("track_image", *track_image, CV_32S);
    objects.rows = ObjectRows(object_ids, categories, motion_states);
    objects.masks_fresh = masks_fresh;
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    return engine_->FinishFrame(objects);
  }

  void Flush() {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    engine_->Flush();
  }

  void Settle() {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    engine_->Settle();
  }

  void LoadMaps(const std::string& path) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    engine_->LoadMaps(path);
  }

  void ResumeMaps(const std::string& path, int64_t first_free_map_id) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    engine_->ResumeMaps(path, first_free_map_id);
  }

  void SaveMaps(const std::string& path, bool in_background) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    saver_.Start(engine_->Snapshot(), path);
    if (!in_background) saver_.Wait();
  }

  void Checkpoint(const std::string& path) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::vector<uint8_t> bytes = engine_->Checkpoint().Bytes();
    WriteFileAtomically(path, bytes);
    Restore(bytes);
  }

  void Restore(const std::string& path) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    Restore(ReadWholeFile(path));
  }

  template <typename Value>
  Value Ask(Value (Engine::*question)() const) {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    return ((*engine_).*question)();
  }

  py::dict TakeMapUpdate() {
    MapUpdate update;
    {
      const py::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      update = engine_->TakeUpdate();
    }
    return ToDict(update);
  }

 private:
  /// Nothing goes on in the restored engine but what the snapshot tells.
  void Restore(const std::vector<uint8_t>& bytes) {
    auto restored = std::make_unique<Engine>(camera_, options_);
    restored->RestoreState(bytes);
    engine_ = std::move(restored);
  }

  CameraModel camera_;
  EngineOptions options_;
  std::mutex mutex_;
  std::unique_ptr<Engine> engine_;
  MapSaver saver_;
};

void BindOptions(py::module_& module) {
  py::enum_<Stage>(module, "Stage")
      .value("base", Stage::kBase)
      .value("dynamic", Stage::kDynamic)
      .value("moving", Stage::kMoving);
  py::enum_<Lens>(module, "Lens").value("plumb_bob", Lens::kPlumbBob).value("kannala_brandt", Lens::kKannalaBrandt);
  py::class_<CameraModel>(module, "CameraModel")
      .def(py::init([](int width, int height, double fx, double fy, double cx, double cy,
                       const std::vector<double>& distortion, double baseline_m, Lens lens) {
             return CameraModel(width, height, fx, fy, cx, cy, distortion, lens).WithBaseline(baseline_m);
           }),
           py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"),
           py::arg("distortion") = std::vector<double>{}, py::arg("baseline_m") = 0.0,
           py::arg("lens") = Lens::kPlumbBob)
      .def_property_readonly("width", &CameraModel::width_px)
      .def_property_readonly("height", &CameraModel::height_px);
  py::class_<EngineOptions>(module, "EngineOptions")
      .def(py::init<>())
      .def_readwrite("stage", &EngineOptions::stage)
      .def_readwrite("features", &EngineOptions::features)
      .def_readwrite("pyramid_levels", &EngineOptions::pyramid_levels)
      .def_readwrite("pyramid_factor", &EngineOptions::pyramid_factor)
      .def_readwrite("fast_threshold", &EngineOptions::fast_threshold)
      .def_readwrite("fast_threshold_low", &EngineOptions::fast_threshold_low)
      .def_readwrite("mask_border_px", &EngineOptions::mask_border_px)
      .def_readwrite("seed", &EngineOptions::seed)
      .def_readwrite("merge_delay_frames", &EngineOptions::merge_delay_frames)
      .def_readwrite("local_bundle_keyframes", &EngineOptions::local_bundle_keyframes)
      .def_readwrite("velocity_change", &EngineOptions::velocity_change)
      .def_readwrite("radial_sigma", &EngineOptions::radial_sigma)
      .def_readwrite("threads", &EngineOptions::threads)
      .def_readwrite("loop_closing", &EngineOptions::loop_closing)
      .def_readwrite("right_shift_sigma_px", &EngineOptions::right_shift_sigma_px)
      .def_readwrite("depth_baseline_m", &EngineOptions::depth_baseline_m)
      .def_readwrite("wait_for_loops", &EngineOptions::wait_for_loops)
      .def_readwrite("camera_height_m", &EngineOptions::camera_height_m)
      .def_readwrite("new_map_after_lost", &EngineOptions::new_map_after_lost)
      .def_readwrite("localize_only", &EngineOptions::localize_only)
      .def_readwrite("opencv_threads", &EngineOptions::opencv_threads)
      .def_readwrite("semi_dense", &EngineOptions::semi_dense)
      .def_readwrite("map_id", &EngineOptions::map_id)
      .def_readwrite("vocabulary_path", &EngineOptions::vocabulary_path)
      .def_readwrite("map_from_first_camera", &EngineOptions::map_from_first_camera);
}

void BindResult(py::module_& module) {
  py::class_<TrackingResult>(module, "TrackingResult")
      .def_readonly("timestamp_ns", &TrackingResult::timestamp_ns)
      .def_property_readonly("state", [](const TrackingResult& result) { return static_cast<int>(result.state); })
      .def_readonly("reason", &TrackingResult::reason)
      .def_readonly("map_id", &TrackingResult::map_id)
      .def_readonly("map_from_camera", &TrackingResult::map_from_camera)
      .def_readonly("covariance", &TrackingResult::covariance)
      .def_readonly("reference_keyframe_id", &TrackingResult::reference_keyframe_id)
      .def_readonly("camera_from_reference", &TrackingResult::camera_from_reference)
      .def_readonly("tracked_landmarks", &TrackingResult::tracked_landmarks)
      .def_readonly("features", &TrackingResult::features)
      .def_readonly("keyframe_inserted", &TrackingResult::keyframe_inserted)
      .def_readonly("moving_unplaced", &TrackingResult::moving_unplaced)
      .def_readonly("road_normal", &TrackingResult::road_normal)
      .def_readonly("road_distance", &TrackingResult::road_distance)
      .def_property_readonly("object_contacts",
                             [](const TrackingResult& result) {
                               py::dict contacts;
                               for (const ObjectContact& contact : result.object_contacts) {
                                 Eigen::Matrix<double, 3, 3, Eigen::RowMajor> points;
                                 points << contact.left.transpose(), contact.nearest.transpose(),
                                     contact.right.transpose();
                                 contacts[py::int_(contact.object_id)] = points;
                               }
                               return contacts;
                             })
      .def_readonly("metric_scale", &TrackingResult::metric_scale)
      .def_readonly("loop_closed", &TrackingResult::loop_closed)
      .def_readonly("maps_merged", &TrackingResult::maps_merged)
      .def_readonly("background_ms", &TrackingResult::background_ms)
      .def_property_readonly("stage_ms", [](const TrackingResult& result) {
        const StageTimes& times = result.stage_ms;
        py::dict stages;
        stages["extract"] = times.extract_ms;
        stages["merge"] = times.merge_ms;
        stages["match"] = times.match_ms;
        stages["local_map"] = times.local_map_ms;
        stages["mapping"] = times.mapping_ms;
        stages["loop"] = times.loop_ms;
        return stages;
      });
}

}  // namespace
}  // namespace kinemap

PYBIND11_MODULE(_engine, module) {
  using namespace kinemap;
  module.doc() = "SLAM: images and object masks in, poses and map arrays out.";
  BindOptions(module);
  BindResult(module);
  BindVocabulary(module);
  py::class_<LockedEngine>(module, "Engine")
      .def(py::init<const CameraModel&, const EngineOptions&>(), py::arg("camera"), py::arg("options"))
      .def("begin_frame", &LockedEngine::BeginFrame, py::arg("timestamp_ns"), py::arg("image"),
           py::arg("right") = py::none(), py::arg("depth_m") = py::none())
      .def("finish_frame", &LockedEngine::FinishFrame, py::arg("track_image").none(true), py::arg("object_ids"),
           py::arg("categories"), py::arg("motion_states"), py::arg("masks_fresh"))
      .def("flush", &LockedEngine::Flush)
      .def("settle", &LockedEngine::Settle)
      .def("load_maps", &LockedEngine::LoadMaps, py::arg("path"))
      .def("resume_maps", &LockedEngine::ResumeMaps, py::arg("path"), py::arg("first_free_map_id"))
      .def("save_maps", &LockedEngine::SaveMaps, py::arg("path"), py::arg("in_background"))
      .def("checkpoint", &LockedEngine::Checkpoint, py::arg("path"))
      .def("restore", py::overload_cast<const std::string&>(&LockedEngine::Restore), py::arg("path"))
      .def("take_map_update", &LockedEngine::TakeMapUpdate)
      .def_property_readonly("active_map_id", [](LockedEngine& engine) { return engine.Ask(&Engine::active_map_id); })
      .def_property_readonly("next_map_id", [](LockedEngine& engine) { return engine.Ask(&Engine::next_map_id); })
      .def_property_readonly("metric_scale", [](LockedEngine& engine) { return engine.Ask(&Engine::metric_scale); })
      .def_property_readonly("remaining_radial",
                             [](LockedEngine& engine) { return engine.Ask(&Engine::remaining_radial); });
}
