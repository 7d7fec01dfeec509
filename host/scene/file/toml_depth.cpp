// SPDX-License-Identifier: Apache-2.0
// Counts the dots between the signs that end a key; see toml_depth.hpp. Texts and comments are passed over by TOML's
// rules (TOML 1.0: basic and literal strings, each also of several lines).
#include "scene/file/toml_depth.hpp"

namespace clray {

namespace {

/// The position after the string that begins at `at`.
std::size_t after_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view three = text.substr(at, 3);
  const bool several = three.size() == 3 && three[1] == quote && three[2] == quote;
  if (several) at += 2;
  for (++at; at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (!several && (text[at] == quote || text[at] == '\n')) {
      return at + 1;
    } else if (several && text[at] == quote && text.substr(at, 3) == three) {
      return at + 3;
    }
  }
  return text.size();
}

TextPlace place_of(std::string_view text, std::size_t at) {
  TextPlace place{1, 1};
  for (const char c : text.substr(0, at)) {
    place.line += c == '\n';
    place.column = c == '\n' ? 1 : place.column + 1;
  }
  return place;
}

}  // namespace

TextPlace deep_key(std::string_view toml) {
  std::size_t dots = 0;
  for (std::size_t at = 0; at < toml.size();) {
    const char c = toml[at];
    if (c == '"' || c == '\'') {
      at = after_string(toml, at);
      continue;
    }
    if (c == '#') {
      at = toml.find('\n', at);
      if (at == std::string_view::npos) break;
      continue;
    }
    if (c == '.') {
      if (++dots == kMostKeyParts) return place_of(toml, at);
    } else if (c == '\n' || c == '=' || c == '[' || c == ']' || c == '{' || c == '}' || c == ',') {
      dots = 0;
    }
    ++at;
  }
  return {};
}

}  // namespace clray
