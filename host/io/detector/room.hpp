// SPDX-License-Identifier: Apache-2.0
// What files and terminal say of the records of one kind. Each kind has a file in this folder, which holds all that is
// said of it, and its name in rooms.cpp.
#pragma once

#include "clray/write.hpp"
#include "io/writer.hpp"

namespace clray::io {

class SummaryEntries;  // io/summary_entries.hpp

struct RecordRoom {
  void (*files)(Writer&);            ///< tables and pictures
  void (*summary)(SummaryEntries&);  ///< its part of summary.json
  void (*totals)(const Result&,
                 std::vector<Total>*) = nullptr;       ///< what is compared with a reference; default: nothing
  void (*show)(const Result&, ResultText*) = nullptr;  ///< what a person sees first; default: nothing
};

extern const RecordRoom kDelayRecords, kSpectrometerRecords, kPressureRecords, kPictureRecords, kSumRecords;

/// Every room, in the order of files, totals and terminal.
const std::vector<const RecordRoom*>& record_rooms();

}  // namespace clray::io
