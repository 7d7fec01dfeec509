// SPDX-License-Identifier: Apache-2.0
// Sums that are results by themselves, in files and on the terminal: a detector whose row states them needs no more.
#include <algorithm>

#include "clray/write.hpp"
#include "io/detector/room.hpp"
#include "io/detector/words.hpp"
#include "io/summary_entries.hpp"
#include "io/table_file.hpp"

namespace clray::io {

namespace {

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

/// {sum: {unit, values}} of a sum that is a result by itself.
Json sum_entry(const TableResult& sum) {
  Json values = Json::array();
  for (const Estimate& e : sum.values) values.push_back(value_and_error(e));
  return {{sum.name, {{"unit", sum.unit}, {"values", values}}}};
}

/// The records of each sum, in the order in which they first occur.
std::vector<std::vector<TableResult>> by_sum(const std::vector<TableResult>& records) {
  std::vector<std::vector<TableResult>> sums;
  for (const TableResult& record : records) {
    const auto same = [&](const auto& sum) { return sum.front().name == record.name; };
    const auto found = std::find_if(sums.begin(), sums.end(), same);
    (found == sums.end() ? sums.emplace_back() : *found).push_back(record);
  }
  return sums;
}

void sums_summary(SummaryEntries& entries) {
  for (const auto& sum : by_sum(entries.writer.result.table)) entries.add(sum, sum_entry);
}

void sums_totals(const Result& result, std::vector<Total>* all) {
  for (const auto& sum : result.table) {
    for (std::size_t k = 0; k < sum.values.size(); ++k)
      all->push_back({sum.key, sum.values[k].value, sum.values[k].standard_error, sum.unit, sum.name, k});
  }
}

/// "absorbed", or "absorbed 2" where the sum has several numbers.
std::string number_name(const TableResult& sum, std::size_t k) {
  return sum.values.size() > 1 ? sum.name + " " + std::to_string(k) : sum.name;
}

void show_sums(const Result& result, ResultText* text) {
  if (result.table.empty()) return;
  Columns table;
  table.add({"detector", "sum", "value"});
  std::size_t count = 0;
  for (const TableResult& sum : result.table) {
    for (std::size_t k = 0; k < sum.values.size(); ++k) {
      const std::string name = record_name(sum.key, result), number = number_name(sum, k);
      text->totals += name + ": " + number + " = " + amount(sum.values[k], 1.0, sum.unit) + "\n";
      if (++count > kMostRows) continue;
      table.add({k == 0 ? name : "", number, amount_with_interval(sum.values[k], sum.unit)});
    }
  }
  text->tables += "\n" + table.text("  ") + more_rows(count);
}

}  // namespace

const RecordRoom kSumRecords{write_sums, sums_summary, sums_totals, show_sums};

}  // namespace clray::io
