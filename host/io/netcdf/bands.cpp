// SPDX-License-Identifier: Apache-2.0
// spectrum.nc, lightcurve.nc and hyperspectral.nc: the numbers of spectrum.csv, lightcurve.csv and hyperspectral.fits.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "clray/constants.hpp"
#include "io/netcdf/records.hpp"

namespace clray::io {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Places of a grid of times and bands; one without a record is missing.
struct BandGrid {
  std::vector<std::size_t> orientations;
  std::vector<std::string> names;
  std::vector<Band> bands;
  std::map<std::size_t, std::size_t> row;
  std::map<std::string, std::size_t> column;

  void add(std::size_t orientation, const std::string& name, const Band& band) {
    if (row.emplace(orientation, orientations.size()).second) orientations.push_back(orientation);
    if (!column.emplace(name, names.size()).second) return;
    names.push_back(name);
    bands.push_back(band);
  }
  template <class Records, class Place, class Number>
  std::vector<double> values(const Records& records, Place place, Number number) const {
    std::vector<double> all(orientations.size() * names.size(), kNan);
    for (const auto& record : records) {
      const auto [orientation, name] = place(record);
      all[row.at(orientation) * names.size() + column.at(name)] = number(record);
    }
    return all;
  }
};

/// A row of a light curve with its band.
struct CurvePoint {
  const LightCurveRow* row;
  const BandCurve* band;
};

std::pair<std::size_t, std::string> place_of(const CurvePoint& point) {
  return {point.row->record->key.orientation, point.band->name};
}

/// Magnitudes and A, by time and band.
void curve_numbers(NetcdfFile& file, const BandGrid& grid, const std::vector<CurvePoint>& points) {
  const std::vector<std::string> along{"time", "band"};
  const auto of = [&](const std::function<double(const CurvePoint&)>& number) {
    return grid.values(points, place_of, number);
  };
  const auto magnitude = [&](const std::string& name, const std::string& what,
                             const std::function<double(const CurvePoint&)>& number) {
    file.variable({name, along, "1", what, of(number), {{"ancillary_variables", "magnitude_error"}}});
  };
  const std::string here = " magnitude at the range of the instant, behind the extinction";
  magnitude("magnitude_AB", "AB" + here, [](const CurvePoint& p) { return p.row->record->magnitude_AB; });
  magnitude("magnitude_Vega", "Vega" + here, [](const CurvePoint& p) { return p.row->record->magnitude_Vega; });
  for (const bool vega : {false, true}) {
    const std::string system = vega ? "Vega" : "AB", what = system + " magnitude above the atmosphere at 1000 km";
    const auto less = [vega](const CurvePoint& p) { return vega ? p.band->AB_minus_Vega : 0.0; };
    magnitude("magnitude_1000km_" + system, what, [&](const CurvePoint& p) { return p.row->standard_AB - less(p); });
    magnitude("magnitude_1000km_90deg_" + system, what + " and a phase angle of 90 degrees",
              [&](const CurvePoint& p) { return p.row->standard_90_AB - less(p); });
  }
  file.variable({"magnitude_error", along, "1", "standard error of the magnitudes",
                 of([](const CurvePoint& p) { return p.row->record->magnitude_standard_error; })});
  file.variable({"extinction", along, "1", "extinction on the way to the observer, magnitudes",
                 of([](const CurvePoint& p) { return p.row->record->extinction_mag; })});
  file.with_error({"A", along, "m2 sr-1", "radiant intensity over irradiance",
                   of([](const CurvePoint& p) { return p.row->record->intensity_m2_per_sr.value; })},
                  of([](const CurvePoint& p) { return p.row->record->intensity_m2_per_sr.standard_error; }));
}

/// What does not depend on the band: angles, range and directions.
void curve_geometry(NetcdfFile& file, const Writer& writer, const BandGrid& grid,
                    const std::vector<LightCurveRow>& rows) {
  const auto of = [&](const std::string& name, const std::string& units, const std::string& what,
                      const std::function<double(const LightCurveRow&)>& number) {
    std::vector<double> values(grid.orientations.size(), kNan);
    for (const LightCurveRow& row : rows) values[grid.row.at(row.record->key.orientation)] = number(row);
    file.variable({name, {"time"}, units, what, std::move(values), {}, name == "phase_angle"});
  };
  of("phase_angle", "degree", "angle source - body - observer",
     [](const LightCurveRow& r) { return r.record->phase_angle_rad * constants::kDegrees; });
  of("range", "m", "range of the observer", [](const LightCurveRow& r) { return r.range_m; });
  of("elevation", "degree", "elevation of the body over the observer's horizon",
     [](const LightCurveRow& r) { return r.sight != nullptr ? r.sight->elevation_rad * constants::kDegrees : kNan; });
  of("azimuth", "degree", "azimuth of the body from north over east",
     [](const LightCurveRow& r) { return r.sight != nullptr ? r.sight->azimuth_rad * constants::kDegrees : kNan; });
  of("air_mass", "1", "air mass on the way to the observer", [](const LightCurveRow& r) { return r.record->air_mass; });
  of("sun_share", "1", "share of the Sun's disk past the Earth",
     [](const LightCurveRow& r) { return r.instant != nullptr ? r.instant->sun_share : kNan; });
  of("lit_share", "1", "lit share of a sphere's disk at the phase angle",
     [](const LightCurveRow& r) { return 0.5 * (1.0 + std::cos(r.record->phase_angle_rad)); });
  netcdf_vectors(file);
  std::vector<double> light, observer;
  const std::size_t who = observer_of(writer.scene, rows.front().record->key);
  for (const std::size_t o : grid.orientations) {
    const bool placed = o < writer.result.orientations.size() && who < writer.result.orientations[o].observers.size();
    for (int axis = 0; axis < 3; ++axis) {
      light.push_back(placed ? writer.result.orientations[o].source[axis] : kNan);
      observer.push_back(placed ? writer.result.orientations[o].observers[who][axis] : kNan);
    }
  }
  file.variable({"light", {"time", "xyz"}, "1", "direction of the light, body frame", std::move(light)});
  file.variable({"observer", {"time", "xyz"}, "1", "direction of the observer, body frame", std::move(observer)});
}

}  // namespace

void spectrum_netcdf(Writer& writer, const std::vector<const SpectrometerResult*>& group, const std::string& stem) {
  BandGrid grid;
  for (const SpectrometerResult* s : group) grid.add(s->key.orientation, band_name(*s), s->band);
  NetcdfFile file =
      netcdf_file(writer, stem, "intensity per wavelength band of " + writer.title("spectrometer", group.front()->key));
  std::vector<std::string> along{"band"};
  if (grid.orientations.size() > 1) {
    netcdf_time(file, writer, grid.orientations);
    along.insert(along.begin(), "time");
  }
  netcdf_bands(file, grid.names, grid.bands);
  const auto of = [&](const std::function<double(const SpectrometerResult&)>& number) {
    const auto place = [](const SpectrometerResult* s) { return std::pair(s->key.orientation, band_name(*s)); };
    return grid.values(group, place, [&](const SpectrometerResult* s) { return number(*s); });
  };
  file.with_error({"A", along, "m2 sr-1", "radiant intensity over irradiance",
                   of([](const auto& s) { return s.intensity_m2_per_sr.value; })},
                  of([](const auto& s) { return s.intensity_m2_per_sr.standard_error; }));
  file.variable({"source", along, "W m-2", "irradiance of the source in the band",
                 of([](const auto& s) { return s.source_W_m2; })});
  file.with_error({"received", along, "W m-2", "irradiance at the observer in the band",
                   of([](const auto& s) { return s.received_W_m2; })},
                  of([](const auto& s) { return s.received_W_m2_standard_error; }));
  for (const bool vega : {false, true}) {
    file.variable({vega ? "magnitude_Vega" : "magnitude_AB",
                   along,
                   "1",
                   std::string(vega ? "Vega" : "AB") + " magnitude at the observer",
                   of([&](const auto& s) { return vega ? s.magnitude_Vega : s.magnitude_AB; }),
                   {{"ancillary_variables", "magnitude_error"}}});
  }
  file.variable({"magnitude_error", along, "1", "standard error of the magnitudes",
                 of([](const auto& s) { return s.magnitude_standard_error; })});
  file.close();
}

void light_curve_netcdf(Writer& writer, const LightCurve& curve, const std::string& stem) {
  BandGrid grid;
  std::vector<CurvePoint> points;
  std::vector<double> at_90, errors;
  for (const BandCurve& band : curve.bands) {
    for (const LightCurveRow& row : band.rows) {
      grid.add(row.record->key.orientation, band.name, row.record->band);
      points.push_back({&row, &band});
    }
  }
  NetcdfFile file = netcdf_file(writer, stem, "light curve of " + writer.title("spectrometer", curve.key));
  netcdf_time(file, writer, grid.orientations);
  netcdf_bands(file, grid.names, grid.bands);
  curve_numbers(file, grid, points);
  const auto longest = std::max_element(curve.bands.begin(), curve.bands.end(),
                                        [](const auto& a, const auto& b) { return a.rows.size() < b.rows.size(); });
  curve_geometry(file, writer, grid, longest->rows);
  for (const BandCurve& band : curve.bands) {
    if (band.rows.empty()) continue;
    at_90.push_back(band.at_90_AB);
    errors.push_back(band.at_90_error);
  }
  file.with_error({"body_magnitude_AB",
                   {"band"},
                   "1",
                   "AB magnitude of the body at 1000 km and a phase angle of 90 "
                   "degrees, by its own phase curve",
                   std::move(at_90)},
                  std::move(errors));
  file.close();
}

void cube_netcdf(Writer& writer, const ImageResult& image, const std::string& stem) {
  NetcdfFile file =
      netcdf_file(writer, stem,
                  "radiance per unit irradiance, mean over each pixel, of " + writer.title("hyperspectral", image.key));
  std::vector<std::string> names;
  for (const Band& band : image.bands) names.push_back(band.name);
  netcdf_bands(file, names, image.bands);
  file.dimension("y", static_cast<std::size_t>(image.height));
  file.dimension("x", static_cast<std::size_t>(image.width));
  std::vector<double> x, y;
  const auto middle = [](int i, int count) { return i - 0.5 * (count - 1); };
  for (int i = 0; i < image.width; ++i) x.push_back(image.centre_right_m + image.pixel_m * middle(i, image.width));
  for (int i = 0; i < image.height; ++i) y.push_back(image.centre_up_m - image.pixel_m * middle(i, image.height));
  file.variable({"x", {"x"}, "m", "to the right of the reference point, on the axis `right`", std::move(x)});
  file.variable({"y", {"y"}, "m", "above the reference point, on the axis `up`", std::move(y)});
  const std::vector<std::string> along{"band", "y", "x"};
  const NetcdfVariable radiance{"radiance", along, "sr-1", "radiance over irradiance", image.radiance_per_sr};
  if (image.standard_error_per_sr.empty()) {
    file.variable(radiance);
  } else {
    file.with_error(radiance, image.standard_error_per_sr);
  }
  if (!image.coverage.empty()) {
    file.variable({"coverage",
                   {"y", "x"},
                   "1",
                   "share of the pixel that the body covers",
                   {image.coverage.begin(), image.coverage.end()}});
  }
  file.variable({"source", {"band"}, "W m-2", "irradiance of the source in the band", image.band_source_W_m2});
  netcdf_vectors(file);
  const auto axis = [&](const std::string& name, const std::string& what, const Vec3& v) {
    file.variable({name, {"xyz"}, "1", what, {v.x, v.y, v.z}});
  };
  axis("right", "the picture's x axis, body frame", image.right);
  axis("up", "the picture's y axis, body frame", image.up);
  axis("toward", "direction of the observer, body frame", image.toward);
  file.close();
}

}  // namespace clray::io
