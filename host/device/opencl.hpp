// SPDX-License-Identifier: Apache-2.0
// The OpenCL C++ binding as clray uses it (OpenCL 1.2, exceptions), and the conversion of its errors into
// clray::Error. Everything that calls OpenCL includes this header and no other.
#pragma once

#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <string>
#include <utility>

#include "clray/error.hpp"

namespace clray {

/// The symbolic name of an OpenCL status, such as "CL_OUT_OF_RESOURCES"; "OpenCL error -n" for an unknown one.
std::string cl_error_name(cl_int status);

/// The error for a failed OpenCL call: names the call and the status; the context is `where` (a device's name).
Error cl_error(const cl::Error& error, const std::string& where);

/// Calls `function` and turns a cl::Error that leaves it into clray::Error(device) about `where`.
template <class Function>
auto with_cl_errors(const std::string& where, Function&& function) -> decltype(function()) {
  try {
    return std::forward<Function>(function)();
  } catch (const cl::Error& error) {
    throw cl_error(error, where);
  }
}

}  // namespace clray
