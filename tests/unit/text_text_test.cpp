// SPDX-License-Identifier: Apache-2.0
// Numbers and names as text, and what goes to gnuplot.
#include "text/text.hpp"

#include <doctest/doctest.h>

#include <charconv>
#include <clocale>
#include <cmath>
#include <limits>

#include "text/gnuplot.hpp"

using namespace clray::text;

namespace {

double parse(const std::string& text) {
  double value = std::nan("");
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

TEST_CASE("numbers do not follow the locale, and every double survives") {
  // Without a comma locale on the machine this checks the classic one only.
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8"}) std::setlocale(LC_ALL, locale);
  const double values[] = {0.1,  1.0 / 3.0,  5e-324, std::numeric_limits<double>::max(), -2.2250738585072014e-308,
                           1e22, 123456789.0};
  for (const double value : values) CHECK(parse(number(value)) == value);
  CHECK(number(std::nan("")) == "nan");
  CHECK(number(-std::numeric_limits<double>::infinity()) == "-inf");
  CHECK(number(1.5).find(',') == std::string::npos);
  std::setlocale(LC_ALL, "C");
}

TEST_CASE("a user's text reaches gnuplot as it is, on one line") {
  CHECK(gnuplot_text("it's a\n`name`_1") == "'it''s a\\x0a`name`_1' noenhanced");
}

TEST_CASE("what is hidden is shown in letters: controls, marks of direction, bytes that are not UTF-8") {
  CHECK(shown("plain тёмный °é") == "plain тёмный °é");
  CHECK(shown("a\x1b[31m\n\x7f") == "a\\x1b[31m\\x0a\\x7f");
  CHECK(shown("\xc2\x9b\xe2\x80\xae\xef\xbb\xbf|") == "\\x9b\\u202e\\ufeff|");
  CHECK(shown("\xff\xc3|\xe2\x80") == "\\xff\\xc3|\\xe2\\x80");
  CHECK(shown(shown("a\x1b\\")) == shown("a\x1b\\"));
  CHECK(shown_lines("a\tb\nc\r\x1b") == "a\tb\nc\\x0d\\x1b");
  CHECK(shown_json("{\"a\": \"\xc2\x9b\x7f é\"}\n") == "{\"a\": \"\\u009b\\u007f é\"}\n");
}

TEST_CASE("a script that fails says so and leaves no picture; names no folder, too") {
  Plot plot("nothing.png");
  plot.line("plot no_such_thing(x)");
  CHECK(plot.draw(".").rfind("no nothing.png: gnuplot ", 0) == 0);
  CHECK(Plot("nothing.png").draw("/no/such/folder").rfind("no nothing.png: ", 0) == 0);
}

TEST_CASE("counts of one and of several") {
  CHECK(counted(0, "pair") == "0 pairs");
  CHECK(counted(1, "pair") == "1 pair");
  CHECK(counted(2, "pair") == "2 pairs");
  CHECK(counted(1, "byte follows", "bytes follow") == "1 byte follows");
  CHECK(counted(3, "byte follows", "bytes follow") == "3 bytes follow");
  CHECK(counted(0, "byte follows", "bytes follow") == "0 bytes follow");
}
