// SPDX-License-Identifier: Apache-2.0
// Runs that several processes share have the bits of one process: whatever the method and the stopping rule. Here the
// ranks are threads with devices of their own, which tests/cli/mpi_test.cpp replaces by processes. The run of one is
// the reference.
#include "clray/ranks.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <random>
#include <thread>

#include "clray/device.hpp"
#include "clray/error.hpp"
#include "physics/saved_cases.hpp"
#include "support/sanitized.hpp"

using namespace clray_test;

namespace {

/// Boxes of messages.
struct Post {
  explicit Post(std::size_t ranks) : boxes(ranks) {}
  std::mutex mutex;
  std::vector<std::deque<clray::RankMessage>> boxes;
  std::atomic<std::size_t> present{0}, handed_over{0};
};

class Thread : public clray::Ranks {
 public:
  Thread(Post& post, std::uint32_t number) : post_(post), number_(number) {}

  std::uint32_t number() const override { return number_; }
  std::uint32_t count() const override { return static_cast<std::uint32_t>(post_.boxes.size()); }
  void send(std::uint32_t to, const std::string& bytes) override {
    const std::lock_guard<std::mutex> lock(post_.mutex);
    post_.present += number_ != 0 && bytes[0] != 'a' ? 1 : 0;  // it has planned the run, or failed
    post_.handed_over += bytes[0] == 's' ? 1 : 0;
    post_.boxes[to].push_back({number_, bytes});
  }
  std::optional<clray::RankMessage> receive() override {
    const std::lock_guard<std::mutex> lock(post_.mutex);
    auto& box = post_.boxes[number_];
    if (box.empty()) return std::nullopt;
    clray::RankMessage message = std::move(box.front());
    box.pop_front();
    return message;
  }

 private:
  Post& post_;
  const std::uint32_t number_;
};

/// Of rank 1, of which every message but the first few is replaced by word that it has failed.
class Failing : public Thread {
 public:
  Failing(Post& post, std::uint32_t number, int good) : Thread(post, number), left_(good) {}
  void send(std::uint32_t to, const std::string& bytes) override {
    if (left_-- > 0) return Thread::send(to, bytes);
    if (left_ == -1) Thread::send(to, std::string(1, 'e') + std::string(8, '\0') + "it broke");
  }

 private:
  std::atomic<int> left_;
};

clray::Device& device_of(std::uint32_t rank) {
  static std::vector<std::unique_ptr<clray::Device>> devices(4);
  const char* choice = ::getenv("CLRAY_TEST_DEVICE");
  if (!devices[rank]) devices[rank] = std::make_unique<clray::Device>(choice != nullptr ? choice : "cpu");
  return *devices[rank];
}

struct Shared {
  clray::Result result;
  std::size_t handed_over = 0;  ///< how many times
};

/// `good`: messages of rank 1 before it fails; `helper`: the scene of the others.
Shared shared(const clray::Scene& scene, std::uint32_t ranks, int good = 1 << 30, const clray::Saving& saving = {},
              const clray::TraceHooks& hooks = {}, const clray::Scene* helper = nullptr) {
  Post post(ranks);
  std::vector<std::thread> threads;
  for (std::uint32_t rank = 0; rank < ranks; ++rank) device_of(rank);
  for (std::uint32_t rank = 1; rank < ranks; ++rank) {
    threads.emplace_back([&, rank] {
      Failing one(post, rank, rank == 1 ? good : 1 << 30);
      clray::trace(helper != nullptr ? *helper : scene, device_of(rank), {}, {}, one);
    });
  }
  Thread first(post, 0);
  clray::TraceHooks waiting = hooks;  // else small runs are over before the others have a share
  waiting.progress = [&](const clray::Progress& progress) {
    while (post.present < ranks - 1) std::this_thread::sleep_for(std::chrono::microseconds(50));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (hooks.progress) hooks.progress(progress);
  };
  Shared all;
  std::exception_ptr failure;
  try {
    all.result = clray::trace(scene, device_of(0), waiting, saving, first);
  } catch (...) {
    failure = std::current_exception();
  }
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  all.handed_over = post.handed_over;
  return all;
}

/// All, or one of each way to share.
std::vector<Case> some_cases() {
  std::vector<Case> some;
  for (const Case& c : cases()) {
    if (long_tests() || c.name == "points" || c.name == "exact" || c.name == "tiles seen from elsewhere")
      some.push_back(c);
  }
  return some;
}

void check_same(const clray::Result& result, const clray::Result& whole) {
  CHECK(result.digest == whole.digest);
  CHECK(result.rays_total == whole.rays_total);
  CHECK(result.stopped_by == whole.stopped_by);
  CHECK(result.reached_percent == whole.reached_percent);
  CHECK(result.errors.size() == whole.errors.size());
}

bool says(const clray::Result& result, const std::string& words) {
  for (const std::string& warning : result.warnings) {
    if (warning.find(words) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("runs shared by 2 to 4 ranks have the digest of one, whatever the method and the stopping rule") {
  std::size_t handed_over = 0;
  for (const Case& c : some_cases()) {
    CAPTURE(c.name);
    const clray::Result whole = run(c.scene);
    for (const std::uint32_t ranks : {2u, 4u}) {
      if (ranks == 4 && !long_tests() && c.name != "points") continue;
      const Shared all = shared(c.scene, ranks);
      check_same(all.result, whole);
      CHECK_FALSE(says(all.result, "left out"));
      handed_over += all.handed_over;
    }
  }
  // With sanitizers one rank may be done before the other begins.
  CHECK(handed_over > (kSanitized ? 0 : long_tests() ? 20 : 3));
}

TEST_CASE("a rank that fails after any number of messages is left out, and the digest is the same") {
  std::mt19937 random(18);
  for (const Case& c : some_cases()) {
    CAPTURE(c.name);
    const clray::Result whole = run(c.scene);
    for (int k = 0; k < (long_tests() ? 10 : 2); ++k) {
      const int good = k == 0 ? 2 : 1 + static_cast<int>(random() % 12);
      CAPTURE(good);
      check_same(shared(c.scene, 3, good).result, whole);
    }
  }
}

TEST_CASE("ranks that would walk otherwise, such as CPUs and GPUs, take the walk of rank 0") {
  clray::Scene scene = cases().front().scene;
  for (const auto& walks : {std::pair("packet", "plain"), std::pair("plain", "packet"), std::pair("placed", "packet"),
                            std::pair("packet", "placed")}) {
    CAPTURE(walks.first);
    scene.trace.walk = walks.second;
    const clray::Scene helper = scene;
    scene.trace.walk = walks.first;
    const Shared all = shared(scene, 2, 1 << 30, {}, {}, &helper);
    check_same(all.result, run(scene));
    CHECK_FALSE(says(all.result, "left out"));
    CHECK((all.handed_over > 0 || kSanitized));
  }
}

TEST_CASE("a rank with another scene is left out and said") {
  const Case c = cases().front();
  clray::Scene other = c.scene;
  other.trace.seed = 2;
  const Shared all = shared(c.scene, 2, 1 << 30, {}, {}, &other);
  CHECK(all.result.digest == run(c.scene).digest);
  CHECK(says(all.result, "rank 1 is left out, and the others do its share: it has another scene"));
}

TEST_CASE("shared runs are cut and resumed, by other numbers of ranks, too, with the digest of one") {
  std::mt19937 random(3);
  std::string name = (std::filesystem::temp_directory_path() / "clray-ranks-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  int cuts = 0;
  for (const Case& c : some_cases()) {
    CAPTURE(c.name);
    clray::Saving saving;
    saving.file = (folder / "sums").string();
    saving.every_s = 1e-9;
    std::filesystem::remove(saving.file);
    for (int most = 2;; most += 4) {
      std::atomic<bool> stop{false};
      clray::TraceHooks hooks;
      hooks.stop = &stop;
      int left = static_cast<int>(random() % static_cast<unsigned>(most));
      hooks.progress = [&](const clray::Progress&) { stop = stop || left-- <= 0; };
      const clray::Result result = shared(c.scene, 1 + random() % 3, 1 << 30, saving, hooks).result;
      if (!result.partial) {
        check_same(result, run(c.scene));
        break;
      }
      ++cuts;
      saving.from = {saving.file};
    }
  }
  CHECK(cuts > 0);
  std::filesystem::remove_all(folder);
}

TEST_CASE("an error of rank 0 ends the others") {
  clray::Scene scene = cases().front().scene;
  clray::Saving saving;
  saving.share = {1, 2};
  scene.trace.rays = 0;
  scene.trace.target_error_percent = 1.0;
  CHECK_THROWS_AS(shared(scene, 2, 1 << 30, saving), clray::Error);
  clray::TraceHooks hooks;
  hooks.progress = [](const clray::Progress&) { throw clray::Error(clray::ErrorCode::output, "stop here"); };
  CHECK_THROWS_AS(shared(cases().front().scene, 3, 1 << 30, {}, hooks), clray::Error);
}
