// SPDX-License-Identifier: Apache-2.0
// Makes one OpenCL source out of the kernel files: resolves #include, emits #line, expands the tables.
#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "device/program.hpp"

namespace clray {
namespace {

struct Table {
  const char* name;    // folder and .def file
  const char* prefix;  // of its macros
  std::vector<int> (*used)(const ProgramOptions&);
};

const Table kTables[] = {
    {"brdf", "BRDF", [](const ProgramOptions& options) { return options.brdfs; }},
    {"shape", "SHAPE", [](const ProgramOptions& options) { return options.shapes; }},
    {"detector", "DETECTOR", [](const ProgramOptions& options) { return options.detectors; }},
    {"walk", "WALK", [](const ProgramOptions& options) { return std::vector<int>{options.walk}; }}};

std::string once_macro(const std::string& path) {
  std::string name = "CLRAY_ONCE_" + path;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

/// The ids of a table's rows that match, in order.
std::vector<std::string> matching_ids(const std::string& table, const KernelFiles& files, const std::regex& row) {
  const auto file = files.find(fmt::format("{0}/{0}.def", table));
  if (file == files.end()) return {};
  std::vector<std::string> ids;
  std::istringstream lines(file->second);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.compare(0, 2, "//") != 0 && std::regex_match(line, match, row)) ids.push_back(match[1]);
  }
  return ids;
}

/// The ids of shapes that are made of faces: walks test those by themselves.
std::vector<std::string> undispatched_ids(const std::string& table, const KernelFiles& files) {
  static const std::regex row(R"(^\s*SHAPE\(\s*(\w+)\s*,\s*"[^"]*"\s*,\s*"[^"]*\bfaces\b.*)");
  return matching_ids(table, files, row);
}

/// The ids of the used rows, in the table's order.
std::vector<std::string> used_ids(const Table& table, const ProgramOptions& options, const KernelFiles& files) {
  const auto ids = table_row_ids(table.name, files);
  const std::vector<int> numbers = table.used(options);
  const std::set<int> rows(numbers.begin(), numbers.end());
  std::vector<std::string> used;
  for (const int row : rows) {
    if (row < 0 || row >= static_cast<int>(ids.size())) {
      throw Error(ErrorCode::bug, fmt::format("there is no row {} in {}.def", row, table.name), "flatten");
    }
    used.push_back(ids[static_cast<std::size_t>(row)]);
  }
  return used;
}

class Flattener {
 public:
  Flattener(const ProgramOptions& options, const KernelFiles& files) : options_(options), files_(files) {}

  std::string run(const std::string& entry) {
    preamble();
    if (!files_.count(entry)) throw Error(ErrorCode::bug, "no such kernel file", entry);
    add_file(entry, false);
    return out_;
  }

 private:
  void preamble() {
    out_ += "#line 1 \"preamble\"\n";
    out_ += "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n";
    if (!options_.defines.count("CLRAY_NO_INT64_ATOMICS")) {
      out_ += "#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable\n";
    }
    out_ += "#pragma OPENCL FP_CONTRACT OFF\n";
    for (const auto& [name, value] : options_.defines) out_ += fmt::format("#define {} {}\n", name, value);
  }

  /// `conditional`: inside an #if that is not the file's own guard, so the text may not reach the compiler.
  void add_file(const std::string& path, bool conditional) {
    stack_.push_back(path);
    const std::string guard = once_macro(path);
    out_ += fmt::format("#ifndef {0}\n#define {0}\n#line 1 \"{1}\"\n", guard, path);
    add_lines(path, files_.at(path), conditional);
    out_ += "#endif\n";
    stack_.pop_back();
    if (!conditional) done_.insert(path);
  }

  void add_lines(const std::string& path, const std::string& text, bool conditional) {
    static const std::regex include(R"re(^\s*#\s*include\s*"([^"]*)".*)re");
    static const std::regex begin_if(R"(^\s*#\s*(if|ifdef|ifndef)\b.*)");
    static const std::regex end_if(R"(^\s*#\s*endif\b.*)");
    const int own_guard = begins_with_guard(text) ? 1 : 0;
    int depth = 0;
    int number = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      ++number;
      std::smatch match;
      const bool directive = line.find('#') != std::string::npos;
      if (directive && std::regex_match(line, match, include)) {
        const std::string where = fmt::format("{}:{}", path, number);
        if (add_include(match[1], where, conditional || depth > own_guard)) {
          out_ += fmt::format("#line {} \"{}\"\n", number + 1, path);
        } else {
          out_ += "\n";
        }
        continue;
      }
      if (directive && std::regex_match(line, begin_if)) ++depth;
      if (directive && std::regex_match(line, end_if)) --depth;
      out_ += line + "\n";
    }
  }

  static bool begins_with_guard(const std::string& text) {
    static const std::regex guard(R"(^(?:\s*//[^\n]*\n|\s*\n)*\s*#\s*ifndef\s+(\w+)\s*\n\s*#\s*define\s+(\w+)\s*\n)");
    std::smatch match;
    return std::regex_search(text, match, guard, std::regex_constants::match_continuous) && match[1] == match[2];
  }

  /// Whether anything was emitted.
  bool add_include(const std::string& path, const std::string& where, bool conditional) {
    for (const auto& table : kTables) {
      if (path == fmt::format("generated/{}_all.inc", table.name)) {
        add_table(table, where, conditional);
        return true;
      }
    }
    if (std::find(stack_.begin(), stack_.end(), path) != stack_.end()) {
      throw Error(ErrorCode::bug, fmt::format("'{}' includes itself", path), where);
    }
    if (done_.count(path)) return false;
    if (!files_.count(path)) throw Error(ErrorCode::bug, fmt::format("there is no kernel file '{}'", path), where);
    add_file(path, conditional);
    return true;
  }

  void add_table(const Table& table, const std::string& where, bool conditional) {
    const auto ids = table_row_ids(table.name, files_), undispatched = undispatched_ids(table.name, files_);
    const auto used = used_ids(table, options_, files_);
    const std::string name = fmt::format("generated/{}_all.inc", table.name);
    out_ += fmt::format("#line 1 \"{}\"\n", name);
    for (std::size_t row = 0; row < ids.size(); ++row) {
      out_ += fmt::format("#define CLRAY_{}_{} {}\n", table.prefix, ids[row], row);
    }
    for (const auto& id : used) add_include(fmt::format("{}/{}.cl", table.name, id), where, conditional);
    std::vector<std::string> dispatched;
    for (const auto& id : used) {
      if (std::find(undispatched.begin(), undispatched.end(), id) == undispatched.end()) dispatched.push_back(id);
    }
    out_ += fmt::format("#line {} \"{}\"\n#define CLRAY_{}S(X)", ids.size() + 1, name, table.prefix);
    for (const auto& id : dispatched) out_ += fmt::format(" X({})", id);
    out_ += "\n";
    if (dispatched.size() == 1) out_ += fmt::format("#define CLRAY_{}_ONLY {}\n", table.prefix, dispatched.front());
  }

  const ProgramOptions& options_;
  const KernelFiles& files_;
  std::string out_;
  std::vector<std::string> stack_;  // files being read, outermost first
  std::set<std::string> done_;      // files already in the source, whatever the conditions
};

}  // namespace

std::vector<std::string> table_row_ids(const std::string& table, const KernelFiles& files) {
  static const std::regex row(R"(^\s*(?:BRDF|SHAPE|DETECTOR|WALK)\(\s*(\w+)\s*,.*)");
  return matching_ids(table, files, row);
}

std::string flatten(const std::string& entry, const ProgramOptions& options, const KernelFiles& files) {
  return Flattener(options, files).run(entry);
}

std::string flatten(const std::string& entry, const ProgramOptions& options) {
  return flatten(entry, options, embedded_kernels());
}

}  // namespace clray
