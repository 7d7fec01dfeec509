// SPDX-License-Identifier: Apache-2.0
// The one exception type of clray. The library throws it and never prints or exits;
// the command line maps its code to an exit status.
#pragma once

#include <stdexcept>
#include <string>

#include "clray/export.hpp"

CLRAY_API_BEGIN
namespace clray {

/// What kind of thing went wrong; the value is the exit status of the command line.
enum class ErrorCode : int {
  bug = 1,     ///< A fault of clray itself.
  usage = 2,   ///< Arguments that make no sense.
  input = 3,   ///< A scene, mesh, material or table that cannot be used.
  device = 4,  ///< No device, a device that cannot compute, or a kernel that does not build.
  output = 5,  ///< A result that cannot be written.
};

/// An error with its code, one sentence for a person, and where it happened.
class Error : public std::runtime_error {
 public:
  /// `message` says what was found and what was expected; `context` is `file:line[:column]`,
  /// a key, a device name or empty. `what()` is "context: message".
  Error(ErrorCode code, std::string message, std::string context = {})
      : std::runtime_error(context.empty() ? message : context + ": " + message),
        code_(code),
        message_(std::move(message)),
        context_(std::move(context)) {}

  /// What kind of thing went wrong.
  ErrorCode code() const noexcept { return code_; }
  /// What was found and what was expected.
  const std::string& message() const noexcept { return message_; }
  /// Where: `file:line[:column]`, a key, a device name or empty.
  const std::string& context() const noexcept { return context_; }

 private:
  ErrorCode code_;
  std::string message_;
  std::string context_;
};

}  // namespace clray
CLRAY_API_END
