// SPDX-License-Identifier: Apache-2.0
// Names of files from users' names: safe, short, and distinct also where a file system ignores case.
#include <doctest/doctest.h>

#include <set>

#include "text/file_names.hpp"

using namespace clray::text;

TEST_CASE("parts of file names: no separators, no leading dot, never empty, at most 48 bytes of whole characters") {
  CHECK(file_name_part("../../etc") == "_._.._etc");
  CHECK(file_name_part("a b\n'\"") == "a_b___");
  CHECK(file_name_part("Ünïcode") == "Ünïcode");
  CHECK(file_name_part("") == "unnamed");
  CHECK(file_name_part(".hidden") == "_hidden");
  CHECK(file_name_part(std::string(500, 'x')) == std::string(48, 'x'));
  std::string odd = "x";  // two bytes a letter: the 48th byte is half of one
  for (int i = 0; i < 40; ++i) odd += "ж";
  CHECK(file_name_part(odd).size() == 47);
}

TEST_CASE("different things get different stems, the same thing always the same one") {
  const std::vector<std::vector<std::string>> things = {{"delay", "a b"},
                                                        {"delay", "a-b"},
                                                        {"delay", "a_b"},
                                                        {"delay", "a", "b"},
                                                        {"delay", "A B"},
                                                        {"delay", "тёмный"},
                                                        {"delay", "Тёмный"},
                                                        {"delay", "чёрный"},
                                                        {"delay", "ÉTÉ"},
                                                        {"delay", "été"},
                                                        {"delay", "Σ"},
                                                        {"delay", "σ"},
                                                        {"delay", "Ł"},
                                                        {"delay", "ł"},
                                                        {"delay", std::string(300, 'x')},
                                                        {"delay", std::string(299, 'x') + "y"},
                                                        {"delay", "?"},
                                                        {"delay", "!"},
                                                        {"delay", "Ž"},
                                                        {"delay", "ž"}};
  // Lower case by hand, apart from the code's fold.
  const auto lower = [](std::string s) {
    for (char& c : s) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    const std::pair<const char*, const char*> pairs[] = {{"Т", "т"}, {"É", "é"}, {"Σ", "σ"}, {"Ł", "ł"}, {"Ž", "ž"}};
    for (const auto& [upper, small] : pairs) {
      for (std::size_t at; (at = s.find(upper)) != std::string::npos;) s.replace(at, std::string(upper).size(), small);
    }
    return s;
  };
  FileNames names;
  std::set<std::string> seen;
  for (const auto& thing : things) {
    const std::string stem = names.stem(thing);
    CAPTURE(stem);
    CHECK(seen.insert(lower(stem)).second);
    CHECK(stem.size() <= 60);
    CHECK(names.stem(thing) == stem);
  }
  CHECK(names.stem({"delay", "a b"}) == "delay-a_b");
  CHECK(names.stem({"delay", "a b"}, "other kind") != "delay-a_b");
}

TEST_CASE("files with one name take numbers; what is reserved is not given out") {
  FileNames names;
  CHECK(names.file("delay", "csv") == "delay.csv");
  CHECK(names.file("Delay", "csv") == "Delay-2.csv");
  CHECK(names.file("delay", "png") == "delay.png");
  names.release("delay.png");
  CHECK(names.file("delay", "png") == "delay.png");
  names.reserve("Error");
  CHECK(names.stem({"error"}) == "error-2");
}
