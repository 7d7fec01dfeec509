// SPDX-License-Identifier: Apache-2.0
// NetCDF files through libnetcdf; see netcdf_file.hpp. No dates are written: equal results make equal files.
#include "io/netcdf_file.hpp"

#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "clray/error.hpp"
#include "text/output_file.hpp"
#include "text/text.hpp"

namespace clray::io {

using namespace text;

namespace {

/// A file that libnetcdf has open; without close() it is given up.
class Open {
 public:
  Open(const std::string& path, int mode) : path_(path) { check(nc_create(path.c_str(), mode, &id)); }
  ~Open() {
    if (id >= 0) nc_abort(id);
    if (!whole_) discard_output_file(path_);
  }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;

  void check(int status) const {
    if (status == NC_NOERR) return;
    throw Error(ErrorCode::output, "cannot write " + shown(path_) + ": " + nc_strerror(status));
  }
  void close() {
    const int closed = nc_close(id);
    id = -1;
    check(closed);
    whole_ = true;
  }

  int id = -1;

 private:
  std::string path_;
  bool whole_ = false;
};

bool has_attribute(const NetcdfVariable& v, const std::string& name, const std::string& value) {
  return std::any_of(v.more.begin(), v.more.end(), [&](const auto& a) { return a.first == name && a.second == value; });
}

bool is_coordinate(const NetcdfVariable& v) {
  return v.dimensions.size() == 1 && v.dimensions.front() == v.name;
}

/// The auxiliary coordinates of a variable, for its attribute `coordinates`; empty where there are none.
std::string coordinates_of(const NetcdfVariable& v, const std::vector<NetcdfVariable>& all) {
  const bool bounds =
      std::any_of(all.begin(), all.end(), [&](const auto& o) { return has_attribute(o, "bounds", v.name); });
  if (v.auxiliary || bounds || is_coordinate(v)) return "";
  std::string names;
  for (const NetcdfVariable& other : all) {
    const bool along = std::all_of(other.dimensions.begin(), other.dimensions.end(), [&](const std::string& d) {
      return std::find(v.dimensions.begin(), v.dimensions.end(), d) != v.dimensions.end();
    });
    if (other.auxiliary && along) names += (names.empty() ? "" : " ") + other.name;
  }
  return names;
}

}  // namespace

NetcdfFile::NetcdfFile(std::string path, const std::string& title) : path_(std::move(path)) {
  attribute("Conventions", "CF-1.11");
  attribute("title", title);
  attribute("source", "clray " CLRAY_VERSION);
}

void NetcdfFile::attribute(const std::string& name, const std::string& value) {
  attributes_.emplace_back(name, value);
}

void NetcdfFile::dimension(const std::string& name, std::size_t length) {
  dimensions_.emplace_back(name, length);
}

void NetcdfFile::variable(NetcdfVariable variable) {
  variables_.push_back(std::move(variable));
}

void NetcdfFile::with_error(NetcdfVariable variable, std::vector<double> errors) {
  NetcdfVariable error{variable.name + "_error", variable.dimensions, variable.units,
                       "standard error of the " + variable.long_name, std::move(errors)};
  auto ancillary = std::find_if(variable.more.begin(), variable.more.end(),
                                [](const auto& attribute) { return attribute.first == "ancillary_variables"; });
  if (ancillary == variable.more.end()) {
    variable.more.emplace_back("ancillary_variables", error.name);
  } else {
    ancillary->second = error.name + " " + ancillary->second;
  }
  variables_.push_back(std::move(variable));
  variables_.push_back(std::move(error));
}

void NetcdfFile::texts(const std::string& name, const std::string& dimension, const std::string& long_name,
                       const std::vector<std::string>& values) {
  Texts texts{name, dimension, long_name, values};
  for (const std::string& value : values) texts.longest = std::max(texts.longest, value.size());
  texts_.push_back(std::move(texts));
}

void NetcdfFile::close() {
  constexpr double kMostOf64BitOffset = 4294967292.0;  // bytes of a variable
  bool large = false;
  for (const NetcdfVariable& v : variables_)
    large = large || static_cast<double>(v.values.size()) * sizeof(double) > kMostOf64BitOffset;
  Open file(path_, NC_CLOBBER | (large ? NC_64BIT_DATA : NC_64BIT_OFFSET));
  const auto put_text = [&](int variable, const std::string& name, const std::string& value) {
    file.check(nc_put_att_text(file.id, variable, name.c_str(), value.size(), value.c_str()));
  };
  file.check(nc_set_fill(file.id, NC_NOFILL, nullptr));
  for (const auto& [name, value] : attributes_) put_text(NC_GLOBAL, name, value);
  std::map<std::string, int> dimensions;
  for (const auto& [name, length] : dimensions_)
    file.check(nc_def_dim(file.id, name.c_str(), length, &dimensions[name]));
  std::vector<int> ids, text_ids;
  for (const NetcdfVariable& v : variables_) {
    std::vector<int> along;
    for (const std::string& name : v.dimensions) along.push_back(dimensions.at(name));
    ids.push_back(0);
    file.check(
        nc_def_var(file.id, v.name.c_str(), NC_DOUBLE, static_cast<int>(along.size()), along.data(), &ids.back()));
    put_text(ids.back(), "units", v.units);
    put_text(ids.back(), "long_name", v.long_name);
    for (const auto& [name, value] : v.more) put_text(ids.back(), name, value);
    if (const std::string names = coordinates_of(v, variables_); !names.empty())
      put_text(ids.back(), "coordinates", names);
    const double missing = std::numeric_limits<double>::quiet_NaN();
    if (!is_coordinate(v)) file.check(nc_put_att_double(file.id, ids.back(), "_FillValue", NC_DOUBLE, 1, &missing));
  }
  for (const Texts& t : texts_) {
    const std::string name = t.name + "_letters";
    int along[2] = {dimensions.at(t.dimension), 0};
    file.check(nc_def_dim(file.id, name.c_str(), t.longest, &along[1]));
    text_ids.push_back(0);
    file.check(nc_def_var(file.id, t.name.c_str(), NC_CHAR, 2, along, &text_ids.back()));
    put_text(text_ids.back(), "long_name", t.long_name);
    put_text(text_ids.back(), "_Encoding", "utf-8");
  }
  file.check(nc_enddef(file.id));
  for (std::size_t i = 0; i < variables_.size(); ++i)
    file.check(nc_put_var_double(file.id, ids[i], variables_[i].values.data()));
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    std::string block;
    for (std::string value : texts_[i].values) {
      value.resize(texts_[i].longest, '\0');
      block += value;
    }
    file.check(nc_put_var_text(file.id, text_ids[i], block.data()));
  }
  file.close();
}

}  // namespace clray::io
