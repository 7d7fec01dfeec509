// SPDX-License-Identifier: Apache-2.0
// See readers.hpp.
#include "readers.hpp"

#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "clray/error.hpp"
#include "clray/result.hpp"
#include "clray/scene.hpp"
#include "clray/write.hpp"
#include "ephemeris/aem.hpp"
#include "ephemeris/cpf.hpp"
#include "ephemeris/oem.hpp"
#include "pipeline/saved_sums.hpp"
#include "scene/file/scene_csv.hpp"
#include "slr/crd.hpp"
#include "support/sealed_sums.hpp"
#include "text/input_file.hpp"

namespace clray_fuzz {

using namespace clray;

namespace {

namespace fs = std::filesystem;

/// A folder of its own in memory, gone with the program.
struct Folder {
  std::string path = fs::is_directory("/dev/shm") ? "/dev/shm/clray-fuzz-XXXXXX" : "/tmp/clray-fuzz-XXXXXX";
  Folder() {
    if (::mkdtemp(path.data()) == nullptr) throw std::runtime_error("no folder for the files of a fuzz target");
    fs::copy(CLRAY_SOURCE_DIR "/tests/fuzz/beside", path);
  }
  ~Folder() {
    std::error_code gone;
    fs::remove_all(path, gone);
  }
};

/// A trajectory is used as well as read: where it begins, ends and between.
void use(const ephemeris::Trajectory& t) {
  const double first = t.first_s(), last = t.last_s();
  for (const double s : {first, last, first + 0.5 * (last - first)}) t.at(s);
}

/// A file of sums whose version and checksum are made right, so that what is between them is believed.
void read_sums(const std::string& path) {
  std::string bytes = text::read_input_file(path);
  if (bytes.size() >= clray_test::kSumsHead + clray_test::kSumsSeal)
    bytes = clray_test::sealed(clray_test::between_seals(bytes));
  from_bytes(bytes, path);
}

struct Reader {
  const char* name;
  const char* file;
  void (*read)(const std::string& folder, const std::string& path);
};

const Reader kReaders[] = {
#define READER(name, file, read) \
  {#name, file, [](const std::string& folder, const std::string& path) { (void)folder, (void)path, (void)(read); }},
#include "readers.def"
#undef READER
};

}  // namespace

std::vector<std::string> reader_names() {
  std::vector<std::string> names;
  for (const Reader& r : kReaders) names.emplace_back(r.name);
  return names;
}

std::string read_bytes(const std::string& reader, const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  for (const Reader& r : kReaders) {
    if (reader != r.name) continue;
    const std::string path = folder.path + "/" + r.file;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0)
      throw std::runtime_error("cannot write " + path);
    try {
      r.read(folder.path, path);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::input || e.message().size() < 8)
        throw std::logic_error(reader + ": not an error of the input in words: " + e.what());
      return e.what();
    } catch (const std::exception& e) {
      throw std::logic_error(reader + ": an error that is no clray::Error: " + e.what());
    }
    return {};
  }
  throw std::logic_error("there is no reader " + reader);
}

}  // namespace clray_fuzz
