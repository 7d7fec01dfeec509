// SPDX-License-Identifier: Apache-2.0
// What the parts of the extension module share.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <string>
#include <vector>

namespace clray_python {

namespace nb = nanobind;
using namespace nb::literals;

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& each : list) names.push_back(each.name);
  return names;
}

/// Results and what they give as columns.
void bind_result(nb::module_& m);

}  // namespace clray_python
