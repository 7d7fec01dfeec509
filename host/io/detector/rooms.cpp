// SPDX-License-Identifier: Apache-2.0
// The kinds of records, and what is asked of all of them; see room.hpp.
#include "clray/write.hpp"
#include "io/detector/room.hpp"

namespace clray::io {

const std::vector<const RecordRoom*>& record_rooms() {
  static const std::vector<const RecordRoom*> rooms{&kDelayRecords, &kSpectrometerRecords, &kPressureRecords,
                                                    &kPictureRecords, &kSumRecords};
  return rooms;
}

std::vector<Total> totals(const Result& result) {
  std::vector<Total> all;
  for (const RecordRoom* room : record_rooms()) {
    if (room->totals != nullptr) room->totals(result, &all);
  }
  return all;
}

}  // namespace clray::io

namespace clray {

ResultText describe_result(const Result& result) {
  ResultText text;
  for (const io::RecordRoom* room : io::record_rooms()) {
    if (room->show != nullptr) room->show(result, &text);
  }
  return text;
}

}  // namespace clray
