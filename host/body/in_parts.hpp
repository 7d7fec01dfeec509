// SPDX-License-Identifier: Apache-2.0
// Work on many elements, shared by the host's cores. What comes out does not depend on how many there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace clray {

constexpr std::size_t kPerThread = 16384;  ///< elements below which another thread costs more than it brings

/// Threads that pay for so many elements; `most`: at most so many, or, where it is 0, as many as there are cores.
inline unsigned threads_for(std::size_t count, unsigned most = 0) {
  if (most == 0) most = std::max(1u, std::thread::hardware_concurrency());
  return static_cast<unsigned>(std::min<std::size_t>(most, count / kPerThread + 1));
}

/// Calls function(first, end) with parts of [0, count), one on each thread. Throws what one of them throws.
template <class Function>
void in_parts(std::size_t count, unsigned threads, const Function& function) {
  std::vector<std::exception_ptr> failures(threads);
  const auto part = [&](unsigned k) {
    try {
      function(count * k / threads, count * (k + 1) / threads);
    } catch (...) {
      failures[k] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (unsigned k = 1; k < threads; ++k) others.emplace_back(part, k);
  part(0);
  for (std::thread& thread : others) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

/// Sorts by an order in which no two different elements are equal: parts on each thread, then merged in pairs. `most`
/// as in threads_for().
template <class T, class Less>
void sort_in_parts(std::vector<T>* values, const Less& less, unsigned most = 0) {
  const unsigned threads = threads_for(values->size(), most);
  const auto at = [&](std::size_t k) {
    return values->begin() + static_cast<std::ptrdiff_t>(values->size() * std::min<std::size_t>(k, threads) / threads);
  };
  in_parts(threads, threads, [&](std::size_t k, std::size_t) { std::sort(at(k), at(k + 1), less); });
  for (std::size_t width = 1; width < threads; width *= 2) {
    const std::size_t pairs = (threads + 2 * width - 1) / (2 * width);
    in_parts(pairs, static_cast<unsigned>(pairs), [&](std::size_t p, std::size_t) {
      const std::size_t k = 2 * width * p;
      std::inplace_merge(at(k), at(k + width), at(k + 2 * width), less);
    });
  }
}

/// Of sorted values, sorts each run of those that `equal` takes for equal by a further order, in which no two are.
template <class T, class Equal, class Less>
void sort_equals_in_parts(std::vector<T>* values, const Equal& equal, const Less& less) {
  const unsigned threads = threads_for(values->size());
  const auto at = [&](std::size_t k) { return values->begin() + static_cast<std::ptrdiff_t>(k); };
  // Each part begins with a run.
  std::vector<std::size_t> begins(threads + 1, values->size());
  for (unsigned k = 0; k < threads; ++k) {
    begins[k] = values->size() * k / threads;
    while (begins[k] > 0 && begins[k] < values->size() && equal(*at(begins[k] - 1), *at(begins[k]))) ++begins[k];
  }
  in_parts(threads, threads, [&](std::size_t k, std::size_t) {
    for (std::size_t first = begins[k], end = first; first < begins[k + 1]; first = end) {
      for (end = first + 1; end < begins[k + 1] && equal(*at(first), *at(end)); ++end) continue;
      if (end - first > 1) std::sort(at(first), at(end), less);
    }
  });
}

}  // namespace clray
