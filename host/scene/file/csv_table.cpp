// SPDX-License-Identifier: Apache-2.0
// Tables by the names of their columns; see csv_table.hpp. A unit is a ratio of two whole numbers to a base unit, so
// that nearly every conversion is one exact factor or divisor. Kilometres and ångströms lose no digits.
#include "scene/file/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "clray/error.hpp"
#include "ephemeris/epoch.hpp"
#include "shared/portable.h"
#include "text/input_file.hpp"
#include "text/text.hpp"

namespace clray {
namespace {

struct Unit {
  const char *name, *kind;
  double times, over;  // of the kind's base
};
constexpr Unit kUnits[] = {{"s", "time", 1, 1},
                           {"ms", "time", 1, 1e3},
                           {"us", "time", 1, 1e6},
                           {"ns", "time", 1, 1e9},
                           {"ps", "time", 1, 1e12},
                           {"min", "time", 60, 1},
                           {"h", "time", 3600, 1},
                           {"d", "time", 86400, 1},
                           {"m", "length", 1, 1},
                           {"km", "length", 1e3, 1},
                           {"cm", "length", 1, 1e2},
                           {"mm", "length", 1, 1e3},
                           {"um", "length", 1, 1e6},
                           {"nm", "length", 1, 1e9},
                           {"angstrom", "length", 1, 1e10},
                           {"pm", "length", 1, 1e12},
                           {"m_s", "speed", 1, 1},
                           {"km_s", "speed", 1e3, 1},
                           {"utc", "date", 1, 1},
                           {"mjd", "date", 1, 1},
                           {"deg", "angle", 1, 1},
                           {"rad", "angle", 180, CLRAY_PI},
                           {"", "share", 1, 1},
                           {"percent", "share", 1, 1e2},
                           {"W_m2_nm", "irradiance", 1e9, 1},
                           {"W_m2_um", "irradiance", 1e6, 1},
                           {"W_m2_angstrom", "irradiance", 1e10, 1},
                           {"W_m2_m", "irradiance", 1, 1}};

const Unit& unit_of(const std::string& name) {
  const Unit* found = std::find_if(std::begin(kUnits), std::end(kUnits), [&](const Unit& u) { return name == u.name; });
  if (found == std::end(kUnits)) throw Error(ErrorCode::bug, "no table has this unit", name);
  return *found;
}

/// Converts by one product or quotient where the units allow it.
double converted(double value, const Unit& from, const Unit& to) {
  const double times = from.times * to.over, over = from.over * to.times;
  return times >= over ? value * (times / over) : value / (over / times);
}

/// A column of a file: which of the expected columns it is, and the unit that it states.
struct Place {
  std::size_t column = 0;
  const Unit* unit = nullptr;
};

[[noreturn]] void fail(const std::string& file, int line, const std::string& message) {
  throw Error(ErrorCode::input, message, line > 0 ? fmt::format("{}:{}", file, line) : file);
}

std::string trimmed(const std::string& text) {
  return text::trimmed(text, " \t\r");
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(',', at), line.size());
    fields.push_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
  return fields;
}

/// Whether the whole text is a number, finite or not.
bool is_number(const std::string& text, double* value) {
  const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(begin, end, *value);
  if (read.ec == std::errc::result_out_of_range) *value = std::nan("");
  return read.ec != std::errc::invalid_argument && read.ptr == end;
}

/// A header's word in the form that is compared: "Range [km]" and "\"range_km\"" become "range_km".
std::string folded(std::string word) {
  const std::pair<const char*, const char*> kWords[] = {{"%", "_percent"}, {"²", "2"},        {"µ", "u"},
                                                        {"μ", "u"},        {"Å", "angstrom"}, {"λ", "lambda"}};
  for (const auto& [sign, letters] : kWords) {
    for (std::size_t at; (at = word.find(sign)) != std::string::npos;)
      word.replace(at, std::string(sign).size(), letters);
  }
  std::string text;
  for (const char c : word) {
    if (c == '"' || c == '\'' || c == ')' || c == ']') continue;
    const bool gap = c == ' ' || c == '_' || c == '(' || c == '[' || c == '/' || c == '.';
    if (!gap) {
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!text.empty() && text.back() != '_') {
      text += '_';
    }
  }
  while (!text.empty() && text.back() == '_') text.pop_back();
  return text;
}

/// Which of the expected columns a header's word means.
std::optional<Place> place_of(const std::string& word, const std::vector<CsvColumn>& columns) {
  const std::string name = folded(word);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Unit& wanted = unit_of(columns[c].unit);
    if (columns[c].dated) {
      for (const char* date : {"utc", "time_utc", "epoch", "epoch_utc", "date", "date_utc"}) {
        if (name == date) return Place{c, &unit_of("utc")};
      }
      for (const char* day : {"mjd", "time_mjd", "mjd_utc", "epoch_mjd"}) {
        if (name == day) return Place{c, &unit_of("mjd")};
      }
    }
    if (!columns[c].bare.empty() && name == folded(columns[c].bare)) return Place{c, &wanted};
    for (const std::string& known : columns[c].names) {
      for (const Unit& unit : kUnits) {
        const std::string stated = *unit.name == '\0' ? known : known + "_" + unit.name;
        if (std::string(unit.kind) == wanted.kind && name == folded(stated)) return Place{c, &unit};
      }
    }
  }
  return std::nullopt;
}

/// "wavelength_nm (or pm, angstrom, …), value (or percent)".
std::string expected_text(const std::vector<CsvColumn>& columns) {
  std::string text;
  for (const CsvColumn& column : columns) {
    if (column.optional) continue;
    text += (text.empty() ? "" : ", ") + (column.bare.empty() ? column.shown() : column.bare);
    if (column.dated) text += " (or time_utc, mjd)";
    const Unit& wanted = unit_of(column.unit);
    std::string others;
    for (const Unit& unit : kUnits) {
      const bool other = std::string(unit.kind) == wanted.kind && &unit != &wanted && *unit.name != '\0';
      if (other && !column.unit.empty()) others += (others.empty() ? "" : ", ") + std::string(unit.name);
    }
    if (!others.empty() && !column.dated) text += " (or " + others + ")";
  }
  return text;
}

/// Reads a file line by line.
class Reader {
 public:
  Reader(const std::string& file, const std::vector<CsvColumn>& columns, CsvHeader header)
      : columns_(columns), header_(header) {
    table_.file = file;
  }

  CsvTable read() {
    const std::string all = text::read_input_file(table_.file);
    std::size_t at = all.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
    for (line_ = 1; at < all.size(); ++line_) {
      const std::size_t end = std::min(all.find('\n', at), all.size());
      const std::string text = all.substr(at, end - at);
      at = end + 1;
      const std::size_t hash = text.find('#');
      const std::string content = trimmed(text.substr(0, hash));
      if (content.empty()) {
        if (hash != std::string::npos && places_.empty()) consider_comment(text.substr(hash + 1));
      } else {
        read_line(fields_of(content));
      }
    }
    if (table_.rows.empty()) fail(table_.file, 0, fmt::format("holds no rows of {}", order()));
    return std::move(table_);
  }

 private:
  std::string order() const {
    std::string text;
    for (const CsvColumn& column : columns_) {
      if (!column.optional) text += (text.empty() ? "" : ",") + column.shown();
    }
    return text;
  }

  /// A comment above the first row names the columns if it has as many words and one of them is a column's name.
  void consider_comment(const std::string& text) {
    const std::vector<std::string> words = fields_of(text);
    const bool names = std::any_of(words.begin(), words.end(),
                                   [&](const std::string& word) { return place_of(word, columns_).has_value(); });
    const auto needed = std::count_if(columns_.begin(), columns_.end(), [](const CsvColumn& c) { return !c.optional; });
    if (words.size() > columns_.size() || words.size() < static_cast<std::size_t>(needed) || !names) return;
    comment_ = words;
    comment_line_ = line_;
  }

  void read_line(const std::vector<std::string>& fields) {
    if (places_.empty()) {
      double ignored = 0.0;
      const bool words = std::none_of(fields.begin(), fields.end(), [&](const std::string& field) {
        return field.empty() || is_number(field, &ignored);
      });
      if (words) return read_header(fields, line_);
      if (!comment_.empty()) {
        read_header(comment_, comment_line_);
      } else if (header_ == CsvHeader::required) {
        fail(table_.file, line_,
             fmt::format("the columns have no names; expected a first line with {}, in any order", order()));
      } else {
        for (std::size_t c = 0; c < columns_.size(); ++c) places_.push_back({c, &unit_of(columns_[c].unit)});
      }
    }
    if (fields.size() != places_.size()) {
      fail(table_.file, line_,
           fmt::format("expected {} columns ({}), found {}", places_.size(), order(), fields.size()));
    }
    std::vector<double> row(columns_.size(), std::nan(""));
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double value = 0.0;
      const CsvColumn& column = columns_[places_[i].column];
      if (std::string(places_[i].unit->kind) == "date") {
        read_epoch(fields[i], places_[i].unit->name);
        continue;
      }
      if (!is_number(fields[i], &value) || !std::isfinite(value)) {
        fail(table_.file, line_, fmt::format("{}: expected a finite number, found '{}'", column.shown(), fields[i]));
      }
      row[places_[i].column] = converted(value, *places_[i].unit, unit_of(column.unit));
    }
    table_.rows.push_back(std::move(row));
    table_.lines.push_back(line_);
  }

  void read_epoch(const std::string& field, const std::string& form) {
    Epoch epoch;
    const bool read = form == "mjd" ? ephemeris::read_mjd(field, &epoch) : ephemeris::read_date(field, &epoch);
    if (!read) {
      fail(table_.file, line_,
           fmt::format("{}: expected {}, found '{}'", form == "mjd" ? "mjd" : "time_utc",
                       form == "mjd" ? "a Modified Julian Date" : "a date such as 2026-11-25T18:02:00.5Z", field));
    }
    table_.epochs.push_back(epoch);
  }

  void read_header(const std::vector<std::string>& words, int line) {
    const auto refuse = [&](const std::string& why) {
      fail(table_.file, line,
           fmt::format("columns {}: {}; expected {}, in any order", fmt::join(words, ","), why,
                       expected_text(columns_)));
    };
    std::vector<std::string> named(columns_.size());
    for (const std::string& word : words) {
      const std::optional<Place> place = place_of(word, columns_);
      if (!place) refuse(fmt::format("'{}' is none of them", word));
      std::string& before = named[place->column];
      if (!before.empty()) refuse(fmt::format("'{}' and '{}' are the same", before, word));
      before = word;
      places_.push_back(*place);
    }
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (named[c].empty() && !columns_[c].optional) refuse(fmt::format("{} is missing", columns_[c].shown()));
    }
  }

  const std::vector<CsvColumn>& columns_;
  CsvHeader header_;
  CsvTable table_;
  int line_ = 0, comment_line_ = 0;
  std::vector<std::string> comment_;  ///< words of a comment that names the columns
  std::vector<Place> places_;         ///< what each column of the file is; empty before the first row
};

}  // namespace

CsvTable read_csv(const std::string& file, const std::vector<CsvColumn>& columns, CsvHeader header) {
  return Reader(file, columns, header).read();
}

}  // namespace clray
