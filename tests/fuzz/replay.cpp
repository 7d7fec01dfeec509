// SPDX-License-Identifier: Apache-2.0
// Replays the corpora of all readers without libFuzzer: each file as it is, then changed in ways that broke readers
// before, by a fixed seed. What a fuzzer found once stays found.
// Usage: fuzz_replay CORPORA CHANGES [READER…]
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "readers.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;
namespace fs = std::filesystem;

constexpr double kMostSeconds = 10.0;  // of one input: the corpora are small

const char* const kWords[] = {"1e400",
                              "-1e308",
                              "nan",
                              "inf",
                              "-0",
                              "4294967296",
                              "-1",
                              "1e-320",
                              "0x10",
                              "\"",
                              "[[",
                              "\xef\xbb\xbf",
                              "\r\n",
                              "\n\n",
                              "\t",
                              "0.1.2",
                              "99999999999999999999",
                              "}",
                              "2026-02-30T00:00:00",
                              "="};

/// One to four changes: a bit, a byte, a piece left out or repeated, a word put in, an end cut off.
Bytes changed(Bytes bytes, std::mt19937* random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : (*random)() % n; };
  for (std::size_t k = 1 + below(4); k > 0 && !bytes.empty(); --k) {
    const std::size_t at = below(bytes.size()), length = std::min(bytes.size() - at, 1 + below(40));
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at), to = from + static_cast<std::ptrdiff_t>(length);
    switch (below(6)) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(below(256));
        break;
      case 2:
        bytes.erase(from, to);
        break;
      case 3: {
        const Bytes piece(from, to);
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), piece.begin(), piece.end());
        break;
      }
      case 4: {
        const std::string word = kWords[below(std::size(kWords))];
        bytes.insert(from, word.begin(), word.end());
        break;
      }
      default:
        if (below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

Bytes bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Reads the bytes; says what went wrong and keeps them in `last`, so that a crash leaves them too. A file of a corpus
/// must be read without complaint: else its changes would be refused for what is wrong with it.
bool read(const std::string& reader, const Bytes& bytes, const std::string& what, const fs::path& last, bool sound) {
  std::ofstream(last, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const auto start = std::chrono::steady_clock::now();
  std::string fault;
  try {
    const std::string complaint = clray_fuzz::read_bytes(reader, bytes.data(), bytes.size());
    if (sound && !complaint.empty()) fault = complaint;
  } catch (const std::exception& e) {
    fault = e.what();
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (seconds > kMostSeconds) fault = reader + ": read for " + std::to_string(seconds) + " s";
  if (fault.empty()) return true;
  const fs::path kept = fs::current_path() / ("fuzz_replay." + reader);
  fs::copy_file(last, kept, fs::copy_options::overwrite_existing);
  std::fprintf(stderr, "%s: %s (kept in %s)\n", what.c_str(), fault.c_str(), kept.c_str());
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: fuzz_replay CORPORA CHANGES [READER...]\n");
    return 2;
  }
  // In memory, since it is written for every input; after a crash it holds the one that did it.
  const fs::path corpora = argv[1], memory = "/dev/shm";
  const fs::path last =
      (fs::is_directory(memory) ? memory : fs::temp_directory_path()) / ("fuzz_replay." + std::to_string(::getpid()));
  std::printf("the input being read is %s\n", last.c_str());
  const int changes = std::atoi(argv[2]);
  const std::vector<std::string> asked(argv + 3, argv + argc);
  int faults = 0;
  for (const std::string& reader : clray_fuzz::reader_names()) {
    if (!asked.empty() && std::find(asked.begin(), asked.end(), reader) == asked.end()) continue;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(corpora / reader)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::mt19937 random(1);
    std::size_t read_so_far = 0;
    for (const fs::path& file : files) {
      const Bytes bytes = bytes_of(file);
      faults += !read(reader, bytes, file.string(), last, true);
      for (int k = 0; k < changes; ++k)
        faults += !read(reader, changed(bytes, &random), file.string() + ", changed", last, false);
      read_so_far += 1 + static_cast<std::size_t>(changes);
    }
    std::printf("%-12s %zu inputs\n", reader.c_str(), read_so_far);
    if (files.empty()) {
      std::fprintf(stderr, "%s has no corpus\n", reader.c_str());
      ++faults;
    }
  }
  fs::remove(last);
  return faults == 0 ? 0 : 1;
}
