// SPDX-License-Identifier: Apache-2.0
// Keys of a form of their own, which rows FORM(section, form, …) of keys.def name as section_form: lists of bands,
// files, a direction that may be a word.
#pragma once

#include "scene/file/keys.hpp"

namespace clray::forms {

extern const KeyForm<Source> source_bands, source_spectrum;
extern const KeyForm<Observer> observer_direction;
extern const KeyForm<Motion> motion_attitudes, motion_table_start, motion_table_stop;
extern const KeyForm<Station> station_ranges, station_cpf, station_pulse;

}  // namespace clray::forms
