// SPDX-License-Identifier: Apache-2.0
// Tables of sums that are results by themselves: a detector whose row states them needs no writer of its own.
#include "io/table_file.hpp"
#include "io/writer.hpp"

namespace clray::io {

void write_sums(Writer& writer) {
  for (const auto& group : groups(writer.result.table)) {
    const std::string kind = writer.kind_of(group.front()->key);
    auto table =
        writer.table(writer.add(writer.stem(kind, group.front()->key), "csv"), writer.title(kind, group.front()->key),
                     "value and its standard error in the unit of the row; low, high: 95 % interval");
    table.columns({"orientation", "band", "sum", "number", "unit", "value", "standard_error", "low", "high"});
    for (const TableResult* record : group) {
      for (std::size_t k = 0; k < record->values.size(); ++k) {
        const Estimate& e = record->values[k];
        table.cell(static_cast<std::uint64_t>(record->key.orientation)).cell(record->key.band).cell(record->name);
        table.cell(static_cast<std::uint64_t>(k)).cell(record->unit).cell(e.value).cell(e.standard_error);
        table.cell(e.low).cell(e.high);
        table.end_row();
      }
    }
    table.close();
  }
}

}  // namespace clray::io
