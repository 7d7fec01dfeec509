// SPDX-License-Identifier: Apache-2.0
// Every kind of file at every place where the disk may fail: the fault is an Error(output), and no broken file is left.
// A limit on the size of files stands in for the disk. The last bytes matter most: libraries write them while closing.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>

#include <functional>

#include "clray/error.hpp"
#include "io/fits_file.hpp"
#include "io/netcdf_file.hpp"
#include "io/picture_file.hpp"
#include "io/table_file.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;
namespace fs = std::filesystem;

namespace {

/// While it lives, no file grows beyond `bytes`.
class FileLimit {
 public:
  explicit FileLimit(std::uintmax_t bytes) : handler_(::signal(SIGXFSZ, SIG_IGN)) {
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before_) == 0);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
  }
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

struct Kind {
  std::string name;
  std::function<void(const std::string&)> write;
};

std::vector<Kind> kinds() {
  std::vector<float> noise;
  io::Pixels pixels{64, 48, {}};
  for (unsigned i = 0, x = 1; i < 64 * 48; ++i) {
    x = x * 1664525u + 1013904223u;  // Numerical Recipes; noise hardly shrinks
    noise.push_back(static_cast<float>(x) * 0x1p-32f);
    for (int k = 0; k < 4; ++k) pixels.rgba.push_back(static_cast<std::uint8_t>(x >> (8 * k)));
  }
  return {{"exr",
           [noise](const std::string& path) {
             io::write_exr(path, 64, 48, {{"R", noise}, {"G", noise}, {"B", noise}}, "a picture");
           }},
          {"png", [pixels](const std::string& path) { io::write_png(path, pixels, "a picture"); }},
          {"fits",
           [](const std::string& path) {
             io::FitsFile file(path);
             file.image("", "", {{64, "X", "m", 1.0, 0.0, 1.0}, {48, "Y", "m", 1.0, 0.0, 1.0}},
                        std::vector<double>(64 * 48, 1.5));
             file.table("T", {{"A", "", std::vector<double>(100, 2.5), {}}});
             file.close();
           }},
          {"nc",
           [](const std::string& path) {
             io::NetcdfFile file(path, "numbers");
             file.dimension("x", 64);
             file.dimension("y", 48);
             file.with_error({"v", {"y", "x"}, "m", "a length", std::vector<double>(64 * 48, 1.5)},
                             std::vector<double>(64 * 48, 0.25));
             file.texts("words", "y", "words", std::vector<std::string>(48, "word"));
             file.close();
           }},
          {"csv", [](const std::string& path) {
             const Result result = io_test::result();
             io::TableFile file(path, result, io_test::scene(), "numbers", "none");
             file.columns({"a", "b"});
             for (int i = 0; i < 3000; ++i) file.cell(i / 7.0).cell(i * 1.25).end_row();
             file.close();
           }}};
}

}  // namespace

TEST_CASE("a disk that is full anywhere in a file is an error, and no broken file stays") {
  for (const Kind& kind : kinds()) {
    CAPTURE(kind.name);
    Scratch scratch;
    const std::string path = scratch / ("whole." + kind.name);
    kind.write(path);
    const std::uintmax_t size = fs::file_size(path);
    REQUIRE(size > 4096);
    for (const std::uintmax_t limit : {std::uintmax_t{0}, std::uintmax_t{100}, size / 3, size / 2, size - 3000,
                                       size - 1000, size - 100, size - 8, size - 1}) {
      CAPTURE(limit);
      const std::string cut = scratch / ("cut." + kind.name);
      bool failed = false;
      {
        const FileLimit full(limit);
        try {
          kind.write(cut);
        } catch (const Error& error) {
          failed = error.code() == ErrorCode::output;
        }
      }
      CHECK(failed);
      CHECK_FALSE(fs::exists(cut));
    }
    const FileLimit enough(size);
    kind.write(scratch / ("again." + kind.name));
    CHECK(io_test::slurp(scratch / ("again." + kind.name)) == io_test::slurp(path));
  }
}
