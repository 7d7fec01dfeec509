// SPDX-License-Identifier: Apache-2.0
// The course of a pass: what it asks for, step by step, under errors that are made up; and that a course taken from the
// state of another goes on alike. Expected steps follow from the rule (docs/physics.md, section 6) by hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "body/reflectance.hpp"
#include "pipeline/course.hpp"
#include "pipeline/sums.hpp"

using namespace clray;

namespace {

CourseRules search_rules() {
  CourseRules rules;
  rules.first_points = 4;
  rules.most_points = 64;
  rules.enough_points = 32;
  rules.target = 0.1;
  rules.target_asked = true;
  rules.t95 = 2.0;
  return rules;
}

/// Takes a step whose error is `error` and checks which it was.
void step(Course& course, const char* phase, std::uint64_t points, std::uint32_t epoch, double error) {
  const auto next = course.next();
  REQUIRE(next.has_value());
  CHECK(std::string(next->phase) == phase);
  CHECK(next->points == points);
  CHECK(next->epoch == epoch);
  course.took(error);
}

template <typename Numbers>
std::size_t count_of(const Numbers& numbers, int value) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < numbers.size(); ++k) count += numbers[k] == static_cast<decltype(numbers[k])>(value);
  return count;
}

}  // namespace

TEST_CASE(
    "where points are found anew, a search leaps to where the target is expected and a confirmation is one step") {
  CourseRules rules = search_rules();
  rules.most_points = 512;
  rules.anew_power = 1.5;
  Course course(rules);
  step(course, "search", 4, 0, 0.4);     // 2 * 0.4 is 8 times 0.1: 4 times the points and a tenth, so 8 times
  step(course, "search", 32, 0, 0.06);   // nearly there: twice
  step(course, "search", 64, 0, 0.04);   // meets it
  step(course, "confirm", 64, 1, 0.06);  // misses
  step(course, "search", 128, 0, 0.7);   // 8 times would be more than there may be
  step(course, "search", 512, 0, 0.3);
  CHECK(!course.next());
  CHECK(std::string(course.state().ended_by) == "max_rays");
}

TEST_CASE("a search doubles to the target, confirms on fresh scrambles, and goes on where that misses") {
  Course course(search_rules());
  step(course, "search", 4, 0, 0.2);
  step(course, "search", 8, 0, 0.05);  // 2 · 0.05 meets 0.1
  step(course, "confirm", 4, 1, 0.04);
  step(course, "confirm", 8, 1, 0.06);  // misses
  Course resumed(course.rules(), course.state());
  for (Course* c : {&course, &resumed}) {
    step(*c, "search", 16, 0, 0.03);
    step(*c, "confirm", 4, 2, 0.09);
    step(*c, "confirm", 8, 2, 0.09);
    step(*c, "confirm", 16, 2, 0.02);
    CHECK(!c->next());
    CHECK(c->state().answer_confirmed);
    CHECK(c->state().reached);
    CHECK(std::string(c->state().ended_by) == "target");
    CHECK(c->state().confirmed == 8 + 16);
  }
}

TEST_CASE("the cap ends a search, zero totals end it as n/a, and an interrupt leaves the search's answer") {
  Course capped(search_rules());
  for (std::uint64_t n = 4; n <= 64; n *= 2) step(capped, "search", n, 0, 1.0);
  CHECK(!capped.next());
  CHECK(std::string(capped.state().ended_by) == "max_rays");
  CHECK(!capped.state().partial);

  Course zero(search_rules());
  for (std::uint64_t n = 4; n <= 32; n *= 2) step(zero, "search", n, 0, std::nan(""));
  for (std::uint64_t n = 4; n <= 32; n *= 2) step(zero, "confirm", n, 1, std::nan(""));
  CHECK(!zero.next());
  CHECK(std::string(zero.state().ended_by) == "zero");
  CHECK(!zero.state().reached);

  Course cut(search_rules());
  step(cut, "search", 4, 0, 0.01);
  step(cut, "confirm", 4, 1, 0.2);
  step(cut, "search", 8, 0, 0.04);
  cut.cut("interrupt");
  CHECK(!cut.next());
  CHECK(cut.state().partial);
  CHECK(!cut.state().answer_confirmed);
  CHECK(cut.state().error == 0.04);
}

TEST_CASE("blocks of sums: rows, offsets, and what belongs to a view") {
  SumLayout layout;
  layout.shape = {2, 3, 4, 5};
  const TableSum values{"a", SumRows::connection, "3", SumScale::weight, SumKeep::nothing, ""};
  const TableSum most{"b", SumRows::lane, "1", SumScale::greatest, SumKeep::nothing, ""};
  const TableSum hits{"c", SumRows::view, "7", SumScale::count, SumKeep::nothing, ""};
  for (const TableSum* sum : {&values, &most, &hits})
    layout.add(*sum, static_cast<std::uint32_t>(std::stoi(sum->width)));
  CHECK(layout.values == 2 * 3 * 4 * 5 * 3);
  CHECK(layout.counts == 2 * 3 * 5 + 2 * 7);
  CHECK(layout.blocks[2].offset == 2 * 3 * 5);
  const SumRange second = range_of(layout, layout.blocks[0], 1, 2);
  CHECK(second.begin == 3 * 4 * 5 * 3);
  CHECK(second.end == 2 * 3 * 4 * 5 * 3);
  const SumRange hits_of_second = range_of(layout, layout.blocks[2], 1, 2);
  CHECK(hits_of_second.begin == 2 * 3 * 5 + 7);
  CHECK(hits_of_second.end == 2 * 3 * 5 + 2 * 7);
  Sums a(layout), b(layout);
  CHECK(a.empty());
  for (std::size_t k = 0; k < b.values.size(); ++k) b.values.set(k, 5);
  for (std::size_t k = 0; k < b.counts.size(); ++k) b.counts.set(k, 6);
  b.points = {7, 8};
  a.set_view(layout, 1, &b);
  CHECK(count_of(a.values, 5) == 3 * 4 * 5 * 3);
  CHECK(a.values[0] == 0);
  CHECK(a.values[a.values.size() - 1] == 5);
  CHECK(count_of(a.counts, 6) == 3 * 5 + 7);
  CHECK(a.points == std::vector<std::uint64_t>{0, 8});
  b.set_view(layout, 0, nullptr);
  for (std::size_t k = 0; k < a.values.size(); ++k) CHECK(b.values[k] == a.values[k]);
  for (std::size_t k = 0; k < a.counts.size(); ++k) CHECK(b.counts[k] == a.counts[k]);
}

TEST_CASE("paged numbers are exact beyond their narrow type, and take memory where they are not zero") {
  using Wide = __int128;
  constexpr std::size_t kSize = 100000;
  PagedNumbers<std::int64_t, Wide> paged(kSize);
  std::vector<Wide> plain(kSize, 0);
  CHECK(paged.bytes() == 0);
  std::mt19937_64 random(7);
  const auto check = [&] {
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < kSize; ++k) wrong += paged[k] != plain[k];
    CHECK(wrong == 0);
  };
  for (int k = 0; k < 20000; ++k) {  // in the first half, and small
    const std::size_t i = random() % (kSize / 2);
    const Wide more = static_cast<std::int64_t>(random()) >> 20;
    paged.add(i, more);
    plain[i] += more;
  }
  check();
  CHECK(paged.bytes() <= (kSize / 2 + 16384) * 8);
  for (int k = 0; k < 20000; ++k) {  // everywhere, either side of 2^63
    const std::size_t i = random() % kSize;
    const Wide more = static_cast<std::int64_t>(random()) * Wide{4294967296} + INT64_MAX;
    paged.add(i, more);
    plain[i] += more;
  }
  paged.set(kSize - 1, 0);
  plain[kSize - 1] = 0;
  check();
  const std::size_t before = paged.bytes();
  paged.forget(10, 10000);  // no whole page
  CHECK(paged.bytes() == before);
  paged.forget(10000, kSize);
  for (std::size_t k = 0; k < 10000; ++k) CHECK(paged[k] == plain[k]);
  CHECK(paged.bytes() < before / 5);
}

TEST_CASE("a table of reflectance follows a step, a root at grazing incidence and a kink between its nodes") {
  const std::function<double(double)> functions[] = {
      [](double mu) { return mu < 0.7071 ? 0.9 : 0.1; },
      [](double mu) { return std::sqrt(mu); },
      [](double mu) { return std::fabs(mu - 0.123); },
      [](double mu) { return std::exp(-mu / 1e-4); },
  };
  for (const auto& f : functions) {
    const std::vector<double> table = reflectance_table(f, {});
    const auto count = static_cast<std::size_t>(table[0]);
    REQUIRE(table.size() == 1 + 2 * count);
    double worst = 0.0;
    for (int k = 1; k <= 20000; ++k) {
      const double mu = std::pow(k / 20000.0, 4.0);  // most of them at grazing incidence
      if (std::fabs(mu - 0.7071) < 1e-9) continue;   // within the step itself there is no line to follow
      std::size_t low = 0;
      while (low + 2 < count && table[1 + low + 1] <= mu) ++low;
      const double share = (mu - table[1 + low]) / (table[2 + low] - table[1 + low]);
      const double found = table[1 + count + low] + share * (table[2 + count + low] - table[1 + count + low]);
      worst = std::max(worst, std::fabs(found - f(mu)));
    }
    CHECK(worst <= kReflectanceError);
  }
}
