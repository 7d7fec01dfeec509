// SPDX-License-Identifier: Apache-2.0
// Which known word was meant by a misspelt one, for messages about scene files and about the command line.
// Near misses by the distance of Damerau (1964) and Levenshtein (1966).
#pragma once

#include <string>
#include <vector>

namespace clray::text {

/// The word of `known` nearest to `word` if it is a near miss (at most a third of its letters wrong), else "".
std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// "; did you mean 'x'?" or "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

}  // namespace clray::text
