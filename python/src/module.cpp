// SPDX-License-Identifier: Apache-2.0
// The extension module clray._clray: scenes, devices, traces. Results leave it as columns of numbers (columns.cpp),
// which Python makes data sets of. Tracing holds no interpreter lock, and takes Ctrl-C between two slices.
#include "bindings.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <chrono>
#include <clray/constants.hpp>
#include <clray/device.hpp>
#include <clray/error.hpp>
#include <clray/keys.hpp>
#include <clray/prepared.hpp>
#include <clray/result.hpp>
#include <clray/scene.hpp>
#include <clray/trace.hpp>
#include <optional>

namespace clray_python {
namespace {

using clray::Orientation;
using clray::Result;
using clray::Scene;
using clray::Vec3;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Faces = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

constexpr double kAskSeconds = 0.05;  // between two looks at signals and the progress bar

const char* code_name(clray::ErrorCode code) {
  switch (code) {
    case clray::ErrorCode::usage:
      return "usage";
    case clray::ErrorCode::input:
      return "input";
    case clray::ErrorCode::device:
      return "device";
    case clray::ErrorCode::output:
      return "output";
    case clray::ErrorCode::bug:
      break;
  }
  return "bug";
}

/// clray::Error becomes clray.Error with its code, message and context.
void bind_error(nb::module_& m) {
  static PyObject* error = PyErr_NewExceptionWithDoc(
      "clray.Error", "What went wrong: `code` (usage, input, device, output, bug), `message`, `context`.", nullptr,
      nullptr);
  m.attr("Error") = nb::handle(error);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const clray::Error& e) {
      nb::object made = nb::handle(error)(e.what());
      made.attr("code") = code_name(e.code());
      made.attr("message") = e.message();
      made.attr("context") = e.context();
      PyErr_SetObject(error, made.ptr());
    }
  });
}

Vec3 unit(const Vec3& v, const char* what) {
  const double length = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  if (!(length > 0.0) || !std::isfinite(length))
    throw clray::Error(clray::ErrorCode::usage, "expected three finite numbers that are not all zero", what);
  return v / length;
}

Vec3 row3(const Rows& rows, std::size_t k, std::size_t first = 0) {
  return {rows(k, first), rows(k, first + 1), rows(k, first + 2)};
}

Vec3 to_body(const clray::Quaternion& q, const Vec3& v) {
  return glm::inverse(q) * v;
}

/// Views of a scene from rows: directions toward the source (body frame), attitudes (w, x, y, z: body to space),
/// directions toward the observers (3 numbers each), times. Of attitudes without directions, those of the scene turn.
std::vector<Orientation> make_views(const Scene& scene, const std::optional<Rows>& sources,
                                    const std::optional<Rows>& attitudes, const std::optional<Rows>& observers,
                                    const std::vector<double>& times) {
  std::size_t count = 0;
  const auto rows = [&](const std::optional<Rows>& of, std::size_t width, const char* what) {
    if (!of) return;
    if (of->shape(1) != width || of->shape(0) == 0 || (count != 0 && of->shape(0) != count))
      throw clray::Error(clray::ErrorCode::usage,
                         "expected " + std::to_string(width) + " numbers per view, and as many views everywhere", what);
    count = of->shape(0);
  };
  rows(sources, 3, "sources");
  rows(attitudes, 4, "attitudes");
  rows(observers, 3 * scene.observers.size(), "observers");
  if (count == 0 || (!times.empty() && times.size() != count))
    throw clray::Error(clray::ErrorCode::usage, "expected sources, attitudes or observers, and as many times", "views");
  std::vector<Orientation> views(count);
  for (std::size_t k = 0; k < count; ++k) {
    Orientation& view = views[k];
    if (!times.empty()) view.time_s = times[k];
    if (attitudes) {
      const Rows& a = *attitudes;
      view.body_to_space = glm::normalize(clray::Quaternion(a(k, 0), a(k, 1), a(k, 2), a(k, 3)));
    }
    const auto turned = [&](const Vec3& v) { return attitudes ? unit(to_body(view.body_to_space, v), "source") : v; };
    view.source = sources ? unit(row3(*sources, k), "sources") : turned(scene.source.direction);
    for (std::size_t o = 0; o < scene.observers.size(); ++o) {
      const clray::Observer& observer = scene.observers[o];
      if (clray::at_source(observer, scene.source)) {
        view.observers.push_back(view.source);
      } else if (observers) {
        view.observers.push_back(unit(row3(*observers, k, 3 * o), "observers"));
      } else {
        view.observers.push_back(turned(observer.direction));
      }
    }
  }
  return views;
}

/// Asks Python for signals, and an event whether it is set, and tells the progress; stops the trace where one of them
/// wants that.
class Listener {
 public:
  Listener(nb::object progress, nb::object event) : progress_(std::move(progress)), event_(std::move(event)) {
    hooks_.stop = &stop_;
    hooks_.progress = [this](const clray::Progress& p) { hear(p); };
  }

  template <class Trace>
  Result run(Trace&& trace) {
    std::optional<Result> result;
    {
      const nb::gil_scoped_release free;
      result.emplace(trace(hooks_));
    }
    if (failure_) std::rethrow_exception(failure_);
    return std::move(*result);
  }

 private:
  void hear(const clray::Progress& p) {
    const auto time = std::chrono::steady_clock::now();
    if (stop_ || std::chrono::duration<double>(time - last_).count() < kAskSeconds) return;
    last_ = time;
    const nb::gil_scoped_acquire locked;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (!event_.is_none() && nb::cast<bool>(event_.attr("is_set")())) stop_ = true;
      if (!progress_.is_none()) progress_(std::string(p.phase), p.fraction, p.rays, p.relative_error, p.seconds_left);
    } catch (...) {
      failure_ = std::current_exception();
      stop_ = true;
    }
  }

  nb::object progress_, event_;
  clray::TraceHooks hooks_;
  std::atomic<bool> stop_{false};
  std::chrono::steady_clock::time_point last_{};
  std::exception_ptr failure_;
};

std::shared_ptr<const clray::Mesh> mesh_of(const Rows& vertices, const Faces& faces) {
  if (vertices.shape(1) != 3)
    throw clray::Error(clray::ErrorCode::usage, "expected three numbers per vertex", "vertices");
  std::vector<Vec3> points(vertices.shape(0));
  for (std::size_t k = 0; k < points.size(); ++k) points[k] = row3(vertices, k);
  std::vector<std::array<std::uint32_t, 3>> triangles(faces.shape(0));
  for (std::size_t k = 0; k < triangles.size(); ++k) triangles[k] = {faces(k, 0), faces(k, 1), faces(k, 2)};
  return clray::make_mesh(std::move(points), std::move(triangles));
}

void set_direction(Scene& scene, const Vec3& v) {
  scene.source.direction = unit(v, "source");
  scene.source.toward = clray::Toward::fixed;
  for (clray::Observer& o : scene.observers) {
    if (o.monostatic) o.direction = scene.source.direction;
  }
}

clray::Observer& observer_of(Scene& scene, const std::string& name) {
  for (clray::Observer& o : scene.observers) {
    if (o.name == name) return o;
  }
  throw clray::Error(clray::ErrorCode::usage, "there is no observer of this name", name);
}

void set_material(Scene& scene, const std::string& name, const std::string& key, double value) {
  for (clray::Material& m : scene.materials) {
    if (m.name != name) continue;
    m.spectra.erase(key);
    m.parameters[key] = value;
    return;
  }
  throw clray::Error(clray::ErrorCode::usage, "there is no material of this name", name);
}

/// An option that is one of several words.
template <class Value>
struct Words {
  const char* key;
  Value clray::TraceOptions::*option;
  std::vector<std::pair<const char*, Value>> values;

  std::string get(const clray::TraceOptions& options) const {
    for (const auto& [word, value] : values) {
      if (options.*option == value) return word;
    }
    return "";
  }
  void set(clray::TraceOptions& options, const std::string& wanted) const {
    std::string all;
    for (const auto& [word, value] : values) {
      if (word == wanted) {
        options.*option = value;
        return;
      }
      all += (all.empty() ? "" : ", ") + std::string(word);
    }
    throw clray::Error(clray::ErrorCode::usage, "expected one of " + all, key);
  }
  void bind(nb::class_<clray::TraceOptions>* options) const {
    options->def_prop_rw(
        key, [words = *this](const clray::TraceOptions& o) { return words.get(o); },
        [words = *this](clray::TraceOptions& o, const std::string& wanted) { words.set(o, wanted); });
  }
};

/// An option that is a number, with a unit of astropy or without.
void bind_number(nb::class_<clray::TraceOptions>* options, const char* key, double clray::TraceOptions::*option) {
  options->def_prop_rw(
      key, [option](const clray::TraceOptions& o) { return o.*option; },
      [option, key](clray::TraceOptions& o, const nb::object& value) {
        o.*option = nb::cast<double>(nb::module_::import_("clray._units").attr("in_unit")(key, value));
      },
      nb::for_setter("value"_a));
}

const Words<clray::Method> kMethods = {"method",
                                       &clray::TraceOptions::method,
                                       {{"auto", clray::Method::automatic},
                                        {"exact", clray::Method::exact},
                                        {"tiles", clray::Method::tiles},
                                        {"points", clray::Method::points}}};
const Words<clray::SamplerKind> kSamplers = {"sampler",
                                             &clray::TraceOptions::sampler,
                                             {{"random", clray::SamplerKind::random},
                                              {"sobol", clray::SamplerKind::sobol},
                                              {"strata", clray::SamplerKind::strata}}};

void bind_scene(nb::module_& m) {
  nb::class_<clray::Mesh>(m, "Mesh", "A triangle mesh in metres.")
      .def_prop_ro("area_m2", [](const clray::Mesh& mesh) { return mesh.report.area_m2; })
      .def_prop_ro("triangles", [](const clray::Mesh& mesh) { return mesh.triangles.size(); })
      .def_prop_ro("materials", [](const clray::Mesh& mesh) { return mesh.material_slots; });
  m.def("make_mesh", &mesh_of, "vertices"_a, "faces"_a);
  m.def("load_mesh", &clray::load_mesh, "path"_a, "length_unit_m"_a = 1.0);

  using Options = clray::TraceOptions;
  nb::class_<Options> options(m, "TraceOptions", "When to stop and how to sample: the keys of [trace].");
  kMethods.bind(&options);
  kSamplers.bind(&options);
  bind_number(&options, "target_error_percent", &Options::target_error_percent);
  bind_number(&options, "time_limit_s", &Options::time_limit_s);
  options.def_rw("max_bounces", &Options::max_bounces)
      .def_rw("rays", &Options::rays)
      .def_rw("max_rays", &Options::max_rays)
      .def_rw("seed", &Options::seed)
      .def_rw("replicates", &Options::replicates)
      .def_rw("walk", &Options::walk);

  nb::class_<Scene>(m, "Scene", "What is traced: body, surfaces, light, observers, detectors, options.")
      .def_ro("name", &Scene::name)
      .def_ro("path", &Scene::path)
      .def_ro("warnings", &Scene::warnings)
      .def_rw("trace", &Scene::trace)
      .def("copy", [](const Scene& s) { return Scene(s); })
      .def("__copy__", [](const Scene& s) { return Scene(s); })
      .def("check", &clray::check_scene, "Throws Error for what cannot be traced.")
      .def("__str__", &clray::describe_scene)
      .def_prop_ro("materials",
                   [](const Scene& s) {
                     std::map<std::string, std::map<std::string, double>> all;
                     for (const clray::Material& each : s.materials) all[each.name] = each.parameters;
                     return all;
                   })
      .def_prop_ro("components",
                   [](const Scene& s) { return names_of(s.components); })
      .def_prop_ro("observers", [](const Scene& s) { return names_of(s.observers); })
      .def_prop_ro("detectors", [](const Scene& s) {
        std::vector<std::string> names;
        for (const clray::DetectorSpec& d : s.detectors) names.push_back(clray::shown_name(d));
        return names;
      })
      .def_prop_ro("views", [](const Scene& s) { return s.views.size(); })
      .def("_source", [](const Scene& s) { return std::vector<double>{s.source.direction.x, s.source.direction.y,
                                                                      s.source.direction.z}; })
      .def("_set_source", [](Scene& s, double x, double y, double z) { set_direction(s, {x, y, z}); })
      .def("_set_observer",
           [](Scene& s, const std::string& name, double x, double y, double z) {
             clray::Observer& o = observer_of(s, name);
             o.monostatic = false;
             o.toward = clray::Toward::fixed;
             o.direction = unit({x, y, z}, "observer");
           })
      .def("_set_material", &set_material)
      .def("_set_views",
           [](Scene& s, const std::optional<Rows>& sources, const std::optional<Rows>& attitudes,
              const std::optional<Rows>& observers, const std::vector<double>& times) {
             s.views = make_views(s, sources, attitudes, observers, times);
             s.motion.reset();
             s.pass.reset();
           },
           "sources"_a.none(), "attitudes"_a.none(), "observers"_a.none(), "times"_a)
      .def("_clear_views", [](Scene& s) { s.views.clear(); });
  using Files = std::map<std::string, std::string>;
  const auto options_of = [](std::map<std::string, std::shared_ptr<const clray::Mesh>> meshes, Files files, double unit,
                             std::vector<std::string> detectors) {
    clray::SceneOptions options;
    options.meshes = std::move(meshes);
    options.files = std::move(files);
    options.length_unit_m = unit;
    options.detectors = std::move(detectors);
    return options;
  };
  m.def("load_scene",
        [=](const std::string& path, double unit, const std::vector<std::string>& detectors) {
          return clray::load_scene(path, options_of({}, {}, unit, detectors));
        },
        "path"_a, "length_unit_m"_a = 0.0, "detectors"_a = std::vector<std::string>{});
  m.def("parse_scene",
        [=](const std::string& text, const std::string& path,
            const std::map<std::string, std::shared_ptr<clray::Mesh>>& meshes, const Files& files) {
          return clray::parse_scene(text, path, options_of({meshes.begin(), meshes.end()}, files, 0.0, {}));
        },
        "text"_a, "path"_a, "meshes"_a, "files"_a);
}

void bind_device(nb::module_& m) {
  using clray::DeviceInfo;
  nb::class_<DeviceInfo>(m, "DeviceInfo", "One OpenCL device.")
      .def_ro("index", &DeviceInfo::index)
      .def_ro("name", &DeviceInfo::name)
      .def_ro("platform", &DeviceInfo::platform)
      .def_ro("vendor", &DeviceInfo::vendor)
      .def_ro("driver", &DeviceInfo::driver)
      .def_ro("version", &DeviceInfo::version)
      .def_ro("type", &DeviceInfo::type)
      .def_ro("compute_units", &DeviceInfo::compute_units)
      .def_ro("memory_GiB", &DeviceInfo::memory_GiB)
      .def_ro("fp64", &DeviceInfo::fp64)
      .def("__repr__", [](const DeviceInfo& d) { return "<clray.DeviceInfo " + d.type + ": " + d.name + ">"; });
  m.def("devices", &clray::list_devices, "All OpenCL devices of this machine.");
  nb::class_<clray::Device>(m, "Device", "An opened device: \"cpu\", \"gpu\", \"all\", an index, part of a name.")
      .def(nb::init<const std::string&>(), "choice"_a = "", nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("info", &clray::Device::info);
}

void bind_trace(nb::module_& m) {
  m.def("trace",
        [](const Scene& scene, clray::Device& device, nb::object progress, nb::object stop) {
          return Listener(std::move(progress), std::move(stop)).run([&](const clray::TraceHooks& hooks) {
            return clray::trace(scene, device, hooks);
          });
        },
        "scene"_a, "device"_a, "progress"_a.none() = nb::none(), "stop"_a.none() = nb::none());
  nb::class_<clray::Prepared>(m, "Prepared")
      .def(nb::init<const Scene&, clray::Device&>(), "scene"_a, "device"_a, nb::keep_alive<1, 3>(),
           nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("scene", [](const clray::Prepared& p) { return Scene(p.scene()); })
      .def("trace",
           [](clray::Prepared& prepared, const Scene& scene, nb::object progress, nb::object stop) {
             return Listener(std::move(progress), std::move(stop)).run([&](const clray::TraceHooks& hooks) {
               return prepared.trace(scene, hooks);
             });
           },
           "scene"_a, "progress"_a.none() = nb::none(), "stop"_a.none() = nb::none());
}

}  // namespace
}  // namespace clray_python

NB_MODULE(_clray, m) {
  m.doc() = "clray's C++ library; use the package clray.";
  clray_python::bind_error(m);
  clray_python::bind_device(m);
  clray_python::bind_scene(m);
  clray_python::bind_result(m);
  clray_python::bind_trace(m);
}
