// SPDX-License-Identifier: Apache-2.0
// delay.nc: the numbers of delay.csv and delay-totals.csv.
#include <cmath>

#include "clray/constants.hpp"
#include "io/detector/delay_pictures.hpp"
#include "io/netcdf/records.hpp"

namespace clray::io {
namespace {

using Group = std::vector<const DelayResult*>;

/// Bin centres and edges.
void delay_axis(NetcdfFile& file, const DelayResult& first) {
  const std::size_t bins = first.bin_m2_per_sr.size();
  file.dimension("delay", bins);
  file.dimension("edges", 2);
  std::vector<double> centres, edges;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto edge_ns = [&](double at) { return (first.first_bin_start_s + at * first.bin_width_s) * 1e9; };
    centres.push_back(edge_ns(static_cast<double>(bin) + 0.5));
    edges.push_back(edge_ns(static_cast<double>(bin)));
    edges.push_back(edge_ns(static_cast<double>(bin + 1)));
  }
  file.variable({"delay",
                 {"delay"},
                 "ns",
                 "delay after a path by way of the reference point",
                 std::move(centres),
                 {{"bounds", "delay_edges"}}});
  file.variable({"delay_edges", {"delay", "edges"}, "ns", "edges of the bins", std::move(edges)});
}

/// What each bin of each record says.
template <class Number>
std::vector<double> of_bins(const Group& group, Number number) {
  std::vector<double> values;
  for (const DelayResult* delay : group) {
    for (std::size_t bin = 0; bin < delay->bin_m2_per_sr.size(); ++bin)
      values.push_back(static_cast<double>(number(*delay, bin)));
  }
  return values;
}

template <class Number>
std::vector<double> of_records(const Group& group, Number number) {
  std::vector<double> values;
  for (const DelayResult* delay : group) values.push_back(number(*delay));
  return values;
}

void bins(NetcdfFile& file, const Group& group, const std::vector<std::string>& along) {
  const double width_ns = group.front()->bin_width_s * 1e9;
  file.with_error(
      {"A_t",
       along,
       "m2 sr-1 ns-1",
       "radiant intensity over irradiance per unit of delay",
       of_bins(group, [&](const DelayResult& d, std::size_t i) { return d.bin_m2_per_sr[i] / width_ns; }),
       {{"ancillary_variables", "hits resolved A_t_upper_bound"}, {"cell_methods", "delay: mean"}}},
      of_bins(group, [&](const DelayResult& d, std::size_t i) { return d.bin_standard_error[i] / width_ns; }));
  file.variable(
      {"hits", along, "1", "light paths that ended in the bin", of_bins(group, [](const DelayResult& d, std::size_t i) {
         return i < d.hits.size() ? static_cast<double>(d.hits[i]) : std::nan("");  // exact: none
       })});
  file.variable({"resolved", along, "1", "1 where the standard error is to be trusted, else 0",
                 of_bins(group, [](const DelayResult& d, std::size_t i) { return d.resolved[i] ? 1 : 0; })});
  file.variable({"A_t_upper_bound", along, "m2 sr-1 ns-1", "95 % bound of A_t in bins that are not resolved",
                 of_bins(group, [&](const DelayResult& d, std::size_t i) {
                   return d.resolved[i] ? std::nan("") : d.bin_upper_bound[i] / width_ns;
                 })});
  if (group.front()->photons_per_ns.empty()) return;
  file.variable({"photons", along, "ns-1", "expected signal photons of a pulse per unit of delay",
                 of_bins(group, [](const DelayResult& d, std::size_t i) { return d.photons_per_ns[i]; })});
}

void totals(NetcdfFile& file, const Group& group, const std::vector<std::string>& along) {
  file.with_error({"A", along, "m2 sr-1", "radiant intensity over irradiance, all delays",
                   of_records(group, [](const DelayResult& d) { return d.intensity_m2_per_sr.value; })},
                  of_records(group, [](const DelayResult& d) { return d.intensity_m2_per_sr.standard_error; }));
  const double sphere = 4.0 * constants::kPi;
  file.with_error(
      {"cross_section", along, "m2", "optical cross-section",
       of_records(group, [&](const DelayResult& d) { return sphere * d.intensity_m2_per_sr.value; })},
      of_records(group, [&](const DelayResult& d) { return sphere * d.intensity_m2_per_sr.standard_error; }));
  file.with_error({"mean_delay", along, "ns", "mean delay",
                   of_records(group, [](const DelayResult& d) { return d.mean_delay_s.value * 1e9; })},
                  of_records(group, [](const DelayResult& d) { return d.mean_delay_s.standard_error * 1e9; }));
  file.with_error({"rms_width", along, "ns", "root mean square width of the pulse",
                   of_records(group, [](const DelayResult& d) { return d.rms_width_s.value * 1e9; })},
                  of_records(group, [](const DelayResult& d) { return d.rms_width_s.standard_error * 1e9; }));
}

}  // namespace

void delay_netcdf(Writer& writer, const Group& group, const std::string& stem) {
  NetcdfFile file = netcdf_file(writer, stem, "delay histogram A(t) of " + delay_title(writer, group.front()->key));
  std::vector<std::string> along, along_bins;
  if (group.size() > 1) {
    std::vector<std::size_t> orientations;
    for (const DelayResult* delay : group) orientations.push_back(delay->key.orientation);
    netcdf_time(file, writer, orientations);
    along = along_bins = {"time"};
  }
  along_bins.push_back("delay");
  delay_axis(file, *group.front());
  bins(file, group, along_bins);
  totals(file, group, along);
  file.close();
}

}  // namespace clray::io
