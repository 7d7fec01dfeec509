// SPDX-License-Identifier: Apache-2.0
// A fault that scripts/check tidy must find: a text is used after it was given away.
#include <string>
#include <utility>

std::size_t planted() {
  std::string text = "a text that is longer than what a string holds in place";
  const std::string other = std::move(text);
  return text.size() + other.size();
}
