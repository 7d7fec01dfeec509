// SPDX-License-Identifier: Apache-2.0
// Messages over MPI. Nothing waits inside MPI while others compute: receivers look and sleep, and what is sent is kept
// until it is gone. Several threads call, one at a time. A rank that is lost ends the job, as mpirun does it; what was
// saved by then stands.
#ifdef CLRAY_WITH_MPI

#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "clray/error.hpp"
#include "cluster/job.hpp"

namespace clray::cluster {
namespace {

constexpr std::size_t kWhole = 1u << 16;  // bytes of a message that goes as one
constexpr std::size_t kPart = 1u << 30;   // of each part of a larger one: MPI counts in 31 bits
constexpr int kMessage = 1, kLarge = 2, kPartOf = 3, kGoodbye = 4;  // tags

class MpiJob : public Job {
 public:
  MpiJob() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    if (provided < MPI_THREAD_SERIALIZED)
      throw Error(ErrorCode::usage, "this MPI cannot be called from several threads (MPI_THREAD_SERIALIZED)");
    int number = 0, count = 1, on_node = 0, of_node = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &number);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    MPI_Comm node = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
    MPI_Comm_rank(node, &on_node);
    MPI_Comm_size(node, &of_node);
    MPI_Comm_free(&node);
    number_ = static_cast<std::uint32_t>(number);
    count_ = static_cast<std::uint32_t>(count);
    on_node_ = static_cast<std::uint32_t>(on_node);
    of_node_ = static_cast<std::uint32_t>(of_node);
  }

  /// Rank 0 says goodbye, the others answer, and what is under way arrives: MPI may end only then.
  ~MpiJob() override {
    if (number_ == 0) say_goodbye();
    while (goodbyes_ < (number_ == 0 ? count_ - 1 : 1)) {
      if (!receive_any()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (number_ != 0) say_goodbye();
    while (!sent()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    MPI_Finalize();
  }

  std::uint32_t number() const override { return number_; }
  std::uint32_t count() const override { return count_; }
  std::uint32_t on_node() const override { return on_node_; }
  std::uint32_t of_node() const override { return of_node_; }
  std::uint64_t bytes() const override { return bytes_; }

  void send(std::uint32_t to, const std::string& bytes) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bytes.size() <= kWhole) return send_part(to, kMessage, bytes);
    const std::uint64_t size = bytes.size();
    send_part(to, kLarge, std::string(reinterpret_cast<const char*>(&size), sizeof size));
    for (std::size_t at = 0; at < bytes.size(); at += kPart) send_part(to, kPartOf, bytes.substr(at, kPart));
  }

  std::optional<RankMessage> receive() override {
    std::optional<RankMessage> message = receive_any();
    if (!message && goodbyes_ > 0) throw Error(ErrorCode::usage, "rank 0 has ended the job");
    return message;
  }

 private:
  struct Outgoing {
    std::string bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void send_part(std::uint32_t to, int tag, std::string bytes) {
    Outgoing& out = outgoing_.emplace_back();
    out.bytes = std::move(bytes);
    MPI_Isend(out.bytes.data(), static_cast<int>(out.bytes.size()), MPI_BYTE, static_cast<int>(to), tag, MPI_COMM_WORLD,
              &out.request);
  }

  void say_goodbye() {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (std::uint32_t rank = 0; rank < count_; ++rank) {
      if (rank != number_ && (number_ == 0 || rank == 0)) send_part(rank, kGoodbye, {});
    }
  }

  /// Forgets what has arrived; true: all has.
  bool sent() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return sweep();
  }
  bool sweep() {
    outgoing_.remove_if([](Outgoing& out) {
      int done = 0;
      MPI_Test(&out.request, &done, MPI_STATUS_IGNORE);
      return done != 0;
    });
    return outgoing_.empty();
  }

  /// A message; goodbyes are counted.
  std::optional<RankMessage> receive_any() {
    const std::lock_guard<std::mutex> lock(mutex_);
    sweep();
    int here = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &here, &status);
    if (here == 0) return std::nullopt;
    int bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    RankMessage message{static_cast<std::uint32_t>(status.MPI_SOURCE), std::string(static_cast<std::size_t>(bytes), 0)};
    receive_part(status.MPI_SOURCE, status.MPI_TAG, message.bytes.data(), message.bytes.size());
    if (status.MPI_TAG == kGoodbye) {
      ++goodbyes_;
      return std::nullopt;
    }
    if (status.MPI_TAG != kLarge) return message;
    std::uint64_t size = 0;
    std::memcpy(&size, message.bytes.data(), sizeof size);
    message.bytes.resize(size);
    for (std::size_t at = 0; at < size; at += kPart)
      receive_part(status.MPI_SOURCE, kPartOf, message.bytes.data() + at, std::min(kPart, size - at));
    return message;
  }

  void receive_part(int from, int tag, char* to, std::size_t bytes) {
    bytes_ += bytes;
    MPI_Recv(to, static_cast<int>(bytes), MPI_BYTE, from, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  }

  std::uint32_t number_ = 0, count_ = 1, on_node_ = 0, of_node_ = 1;
  std::mutex mutex_;  // of MPI and what is sent
  std::list<Outgoing> outgoing_;
  std::atomic<std::uint32_t> goodbyes_{0};  // heard
  std::atomic<std::uint64_t> bytes_{0};
};

}  // namespace

std::unique_ptr<Job> join_mpi_job() {
  return std::make_unique<MpiJob>();
}

}  // namespace clray::cluster

#endif
