// SPDX-License-Identifier: Apache-2.0
// NetCDF files of records, beside the tables and cubes of the same stem; units and errors as the CF conventions 1.11
// have them. Directions are unit vectors of the body frame, away from the body.
#pragma once

#include <string>
#include <vector>

#include "io/detector/lightcurve.hpp"
#include "io/netcdf_file.hpp"
#include "io/writer.hpp"

namespace clray::io {

/// Opens stem.nc with what all of them say of their run.
NetcdfFile netcdf_file(Writer& writer, const std::string& stem, const std::string& title);

/// The dimension "time" with its coordinate, seconds of a motion or, of a pass, UTC since its first instant, and
/// "orientation", the number that other files use.
void netcdf_time(NetcdfFile& file, const Writer& writer, const std::vector<std::size_t>& orientations);

/// The dimension "time" with the dates of instants.
void netcdf_dates(NetcdfFile& file, const Writer& writer, const std::vector<const PassInstant*>& instants);

/// The dimension "xyz" of vectors.
void netcdf_vectors(NetcdfFile& file);

/// The dimension "band": names, ends in nm, and the centre as a coordinate beside them.
void netcdf_bands(NetcdfFile& file, const std::vector<std::string>& names, const std::vector<Band>& bands);

/// delay.nc: A(t) by time (if there are several) and delay. The bins are the same for all.
void delay_netcdf(Writer& writer, const std::vector<const DelayResult*>& group, const std::string& stem);

/// spectrum.nc: by time (if there are several) and band.
void spectrum_netcdf(Writer& writer, const std::vector<const SpectrometerResult*>& group, const std::string& stem);

/// lightcurve.nc: by time and band.
void light_curve_netcdf(Writer& writer, const LightCurve& curve, const std::string& stem);

/// pressure.nc: by elevation and azimuth of the source for a grid (a pole stands at every azimuth), else by time (if
/// there are several).
void pressure_netcdf(Writer& writer, const std::vector<const PressureResult*>& group, const std::string& stem,
                     const std::vector<double>& azimuths_deg, const std::vector<double>& elevations_deg);

/// hyperspectral.nc: radiance by band, y and x.
void cube_netcdf(Writer& writer, const ImageResult& image, const std::string& stem);

/// pass.nc: every instant of a pass, by time, observer and site.
void pass_netcdf(Writer& writer);

}  // namespace clray::io
