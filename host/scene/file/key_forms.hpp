// SPDX-License-Identifier: Apache-2.0
// Keys of a form of their own, which rows FORM(section, form, …) of keys.def name as section_form: lists of bands,
// files, a direction that may be a word.
#pragma once

#include "scene/file/keys.hpp"

namespace clray::forms {

extern const KeyForm<Source> source_direction, source_directions, source_frame, source_bands, source_spectrum;
extern const KeyForm<Observer> observer_direction, observer_site, observer_station, observer_ecef, observer_directions,
    observer_frame, observer_extinction;
extern const KeyForm<Pass> pass_start, pass_start_mjd, pass_times, pass_stop, pass_stop_mjd, pass_ephemeris, pass_eop;
extern const KeyForm<PassAttitude> attitude_file, attitude_attitudes, attitude_spin, attitude_offset;
extern const KeyForm<Motion> motion_attitudes, motion_table_start, motion_table_stop;
extern const KeyForm<Station> station_file, station_ranges, station_cpf, station_site, station_pulse;

}  // namespace clray::forms
