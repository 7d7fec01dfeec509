// SPDX-License-Identifier: Apache-2.0
// NetCDF files through libnetcdf: variables of doubles with dimensions, units and attributes of the CF conventions
// (1.11), in the classic format of 64-bit offsets, which every reader knows.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace clray::io {

using NetcdfAttributes = std::vector<std::pair<std::string, std::string>>;

/// One variable; the last dimension runs fastest. NaN is a missing value. Units in the words of UDUNITS.
struct NetcdfVariable {
  std::string name;
  std::vector<std::string> dimensions;
  std::string units, long_name;
  std::vector<double> values;
  NetcdfAttributes more = {};
  /// A coordinate beside that of its dimension: variables along the same dimensions name it in `coordinates`.
  bool auxiliary = false;
};

/// A NetCDF file being made. It is kept in memory until close(), which writes it. All members throw Error(output).
class NetcdfFile {
 public:
  NetcdfFile(std::string path, const std::string& title);

  void attribute(const std::string& name, const std::string& value);
  /// A dimension of at least one.
  void dimension(const std::string& name, std::size_t length);
  void variable(NetcdfVariable variable);
  /// A value and its standard error, a variable name_error that the first names as ancillary.
  void with_error(NetcdfVariable variable, std::vector<double> errors);
  /// Texts along a dimension, as an array of characters in UTF-8.
  void texts(const std::string& name, const std::string& dimension, const std::string& long_name,
             const std::vector<std::string>& values);
  void close();

 private:
  struct Texts {
    std::string name, dimension, long_name;
    std::vector<std::string> values;
    std::size_t longest = 1;
  };
  std::string path_;
  NetcdfAttributes attributes_;
  std::vector<std::pair<std::string, std::size_t>> dimensions_;
  std::vector<NetcdfVariable> variables_;
  std::vector<Texts> texts_;
};

}  // namespace clray::io
