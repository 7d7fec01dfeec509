// SPDX-License-Identifier: Apache-2.0
// A result as columns: for each kind of record one dict with its keys (orientation, observer, variant, band, detector)
// and arrays of numbers with a row per record. SI units, as in clray/result.hpp.
#include "bindings.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include <clray/result.hpp>
#include <clray/write.hpp>

namespace clray_python {
namespace {

using clray::Estimate;
using clray::Result;
using clray::Vec3;
using clray::VectorEstimate;

/// An array of Python's own, filled by `fill(data)`.
template <class T, class Fill>
nb::object array_of(std::vector<std::size_t> shape, Fill&& fill) {
  std::size_t size = 1;
  for (const std::size_t n : shape) size *= n;
  auto* data = new T[std::max<std::size_t>(size, 1)];
  const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
  fill(data);
  return nb::cast(nb::ndarray<nb::numpy, T>(data, shape.size(), shape.data(), owner));
}

/// One number of each record.
template <class Record, class Get>
nb::object column(const std::vector<Record>& records, Get&& get) {
  return array_of<double>({records.size()}, [&](double* out) {
    for (const Record& r : records) *out++ = get(r);
  });
}

/// A row of numbers of each record, as long as the longest; `filler` behind shorter ones.
template <class Out, class Record, class Get>
nb::object rows(const std::vector<Record>& records, Get&& get, Out filler) {
  std::size_t width = 0;
  for (const Record& r : records) width = std::max<std::size_t>(width, get(r).size());
  return array_of<Out>({records.size(), width}, [&](Out* out) {
    for (const Record& r : records) {
      const auto& from = get(r);
      for (const auto x : from) *out++ = static_cast<Out>(x);
      out = std::fill_n(out, width - from.size(), filler);
    }
  });
}

template <class Record, class Get>
nb::object vectors(const std::vector<Record>& records, Get&& get) {
  return array_of<double>({records.size(), 3}, [&](double* out) {
    for (const Record& r : records) {
      const Vec3 v = get(r);
      for (int k = 0; k < 3; ++k) *out++ = v[k];
    }
  });
}

template <class Record>
nb::dict keys_of(const std::vector<Record>& records) {
  nb::dict d;
  nb::list detector, observer, variant, band;
  for (const Record& r : records) {
    detector.append(r.key.detector);
    observer.append(r.key.observer);
    variant.append(r.key.variant);
    band.append(r.key.band);
  }
  d["detector"] = detector;
  d["observer"] = observer;
  d["variant"] = variant;
  d["band"] = band;
  d["view"] = array_of<std::int64_t>({records.size()}, [&](std::int64_t* out) {
    for (const Record& r : records) *out++ = static_cast<std::int64_t>(r.key.orientation);
  });
  return d;
}

template <class Record, class Get>
void add_estimate(nb::dict& d, const std::string& name, const std::vector<Record>& records, Get&& get) {
  const auto put = [&](const char* suffix, auto member) {
    d[(name + suffix).c_str()] = column(records, [&](const Record& r) { return get(r).*member; });
  };
  put("", &Estimate::value);
  put("_error", &Estimate::standard_error);
  put("_rounding", &Estimate::rounding_bound);
}

nb::dict delay(const Result& result) {
  using R = clray::DelayResult;
  const auto& all = result.delay;
  nb::dict d = keys_of(all);
  add_estimate(d, "A", all, [](const R& r) -> const Estimate& { return r.intensity_m2_per_sr; });
  add_estimate(d, "mean_delay", all, [](const R& r) -> const Estimate& { return r.mean_delay_s; });
  add_estimate(d, "rms_width", all, [](const R& r) -> const Estimate& { return r.rms_width_s; });
  d["first_bin_start"] = column(all, [](const R& r) { return r.first_bin_start_s; });
  d["bin_width"] = column(all, [](const R& r) { return r.bin_width_s; });
  d["below"] = column(all, [](const R& r) { return r.below_m2_per_sr; });
  d["above"] = column(all, [](const R& r) { return r.above_m2_per_sr; });
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  d["A_t"] = rows(all, [](const R& r) -> const auto& { return r.bin_m2_per_sr; }, kNone);
  d["A_t_error"] = rows(all, [](const R& r) -> const auto& { return r.bin_standard_error; }, kNone);
  d["A_t_upper_bound"] = rows(all, [](const R& r) -> const auto& { return r.bin_upper_bound; }, kNone);
  d["hits"] = rows(all, [](const R& r) -> const auto& { return r.hits; }, kNone);
  d["resolved"] = rows(all, [](const R& r) -> const auto& { return r.resolved; }, std::uint8_t{0});
  return d;
}

nb::dict spectrometer(const Result& result) {
  using R = clray::SpectrometerResult;
  const auto& all = result.spectrometer;
  nb::dict d = keys_of(all);
  add_estimate(d, "A", all, [](const R& r) -> const Estimate& { return r.intensity_m2_per_sr; });
  const auto put = [&](const char* name, double R::* member) {
    d[name] = column(all, [&](const R& r) { return r.*member; });
  };
  put("source", &R::source_W_m2);
  put("received", &R::received_W_m2);
  put("received_error", &R::received_W_m2_standard_error);
  put("magnitude_AB", &R::magnitude_AB);
  put("magnitude_error", &R::magnitude_standard_error);
  put("magnitude_Vega", &R::magnitude_Vega);
  put("phase_angle", &R::phase_angle_rad);
  put("air_mass", &R::air_mass);
  put("extinction", &R::extinction_mag);
  return d;
}

void add_vector(nb::dict& d, const std::string& name, const std::vector<clray::PressureResult>& all,
                VectorEstimate clray::PressureResult::* member) {
  using R = clray::PressureResult;
  d[name.c_str()] = vectors(all, [&](const R& r) { return (r.*member).value; });
  d[(name + "_error").c_str()] = vectors(all, [&](const R& r) { return (r.*member).standard_error; });
  d[(name + "_rounding").c_str()] = column(all, [&](const R& r) { return (r.*member).rounding_bound; });
}

/// [record][component][axis]
nb::object shares(const std::vector<clray::PressureResult>& all,
                  std::vector<VectorEstimate> clray::PressureResult::* member, Vec3 VectorEstimate::* what) {
  const std::size_t parts = all.empty() ? 0 : (all.front().*member).size();
  return array_of<double>({all.size(), parts, 3}, [&](double* out) {
    for (const clray::PressureResult& r : all) {
      for (std::size_t c = 0; c < parts; ++c) {
        for (int k = 0; k < 3; ++k) *out++ = ((r.*member)[c].*what)[k];
      }
    }
  });
}

nb::dict pressure(const Result& result) {
  using R = clray::PressureResult;
  const auto& all = result.pressure;
  nb::dict d = keys_of(all);
  add_vector(d, "C", all, &R::coefficient_m2);
  add_vector(d, "T", all, &R::torque_coefficient_m3);
  add_estimate(d, "absorbed", all, [](const R& r) -> const Estimate& { return r.absorbed_m2; });
  d["sun"] = vectors(all, [](const R& r) { return r.sun; });
  d["source"] = column(all, [](const R& r) { return r.source_W_m2; });
  d["C_component"] = shares(all, &R::component_m2, &VectorEstimate::value);
  d["C_component_error"] = shares(all, &R::component_m2, &VectorEstimate::standard_error);
  d["T_component"] = shares(all, &R::component_m3, &VectorEstimate::value);
  d["T_component_error"] = shares(all, &R::component_m3, &VectorEstimate::standard_error);
  return d;
}

nb::list image(const Result& result) {
  nb::list all;
  for (const clray::ImageResult& i : result.image) {
    nb::dict d;
    d["detector"] = i.key.detector;
    d["observer"] = i.key.observer;
    d["variant"] = i.key.variant;
    d["view"] = i.key.orientation;
    d["bands"] = names_of(i.bands);
    d["pixel_m"] = i.pixel_m;
    const std::vector<std::size_t> shape{i.bands.size(), static_cast<std::size_t>(i.height),
                                         static_cast<std::size_t>(i.width)};
    const auto cube = [&](const std::vector<double>& from) {
      return array_of<double>(shape, [&](double* out) { std::copy(from.begin(), from.end(), out); });
    };
    d["radiance"] = cube(i.radiance_per_sr);
    if (!i.standard_error_per_sr.empty()) d["radiance_error"] = cube(i.standard_error_per_sr);
    if (!i.coverage.empty()) {
      d["coverage"] = array_of<float>({shape[1], shape[2]},
                                      [&](float* out) { std::copy(i.coverage.begin(), i.coverage.end(), out); });
    }
    all.append(d);
  }
  return all;
}

nb::dict table(const Result& result) {
  using R = clray::TableResult;
  const auto& all = result.table;
  nb::dict d = keys_of(all);
  d["name"] = names_of(all);
  nb::list units;
  for (const R& r : all) units.append(r.unit);
  d["unit"] = units;
  const auto numbers = [&](double Estimate::* member) {
    std::size_t width = 0;
    for (const R& r : all) width = std::max(width, r.values.size());
    return array_of<double>({all.size(), width}, [&](double* out) {
      for (const R& r : all) {
        for (std::size_t k = 0; k < width; ++k)
          *out++ = k < r.values.size() ? r.values[k].*member : std::numeric_limits<double>::quiet_NaN();
      }
    });
  };
  d["value"] = numbers(&Estimate::value);
  d["error"] = numbers(&Estimate::standard_error);
  return d;
}

nb::dict views(const Result& result) {
  nb::dict d;
  const auto& all = result.orientations;
  using O = clray::Orientation;
  d["time"] = column(all, [](const O& o) { return o.time_s; });
  d["source"] = vectors(all, [](const O& o) { return o.source; });
  d["body_to_space"] = array_of<double>({all.size(), 4}, [&](double* out) {
    for (const O& o : all) {
      for (const double x : {o.body_to_space.w, o.body_to_space.x, o.body_to_space.y, o.body_to_space.z}) *out++ = x;
    }
  });
  const std::size_t observers = all.empty() ? 0 : all.front().observers.size();
  d["observers"] = array_of<double>({all.size(), observers, 3}, [&](double* out) {
    for (const O& o : all) {
      for (const Vec3& v : o.observers) {
        for (int k = 0; k < 3; ++k) *out++ = v[k];
      }
    }
  });
  return d;
}

std::string digest(const Result& r) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(r.digest));
  return text;
}

}  // namespace

void bind_result(nb::module_& m) {
  nb::class_<Result>(m, "Result")
      .def_prop_ro("digest", &digest)
      .def_ro("seed", &Result::seed)
      .def_ro("rays", &Result::rays)
      .def_ro("rays_total", &Result::rays_total)
      .def_ro("partial", &Result::partial)
      .def_ro("target_reached", &Result::target_reached)
      .def_ro("reached_percent", &Result::reached_percent)
      .def_ro("stopped_by", &Result::stopped_by)
      .def_ro("warnings", &Result::warnings)
      .def_ro("kept", &Result::kept)
      .def_ro("left_out", &Result::left_out)
      .def_prop_ro("seconds",
                   [](const Result& r) {
                     nb::dict d;
                     d["bvh"] = r.seconds.bvh;
                     d["compile"] = r.seconds.compile;
                     d["trace"] = r.seconds.trace;
                     d["total"] = r.seconds.total;
                     return d;
                   })
      .def("text", [](const Result& r) { return clray::describe_result(r).totals; })
      .def("write",
           [](const Result& r, const clray::Scene& scene, const std::string& folder, bool plots, bool netcdf) {
             clray::WriteOptions options;
             options.plots = plots;
             options.netcdf = netcdf;
             const nb::gil_scoped_release free;
             return clray::write_result(r, scene, folder, options);
           },
           "scene"_a, "folder"_a, "plots"_a, "netcdf"_a)
      .def("views", &views)
      .def("delay", &delay)
      .def("spectrometer", &spectrometer)
      .def("pressure", &pressure)
      .def("image", &image)
      .def("table", &table);
}

}  // namespace clray_python
