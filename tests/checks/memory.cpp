// SPDX-License-Identifier: Apache-2.0
// Faults that scripts/check asan and valgrind must find. Usage: memory heap | overflow | leak | unset
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

void* volatile kept = nullptr;  // so that no compiler sees through a fault

int past_the_end(int n) {
  int* const numbers = static_cast<int*>(std::calloc(3, sizeof(int)));
  kept = numbers;
  const int found = numbers[n + 1];
  std::free(kept);
  return found;
}

int too_large(int n) {
  return INT_MAX - 2 + n;
}

int leaked() {
  kept = std::malloc(100);
  kept = nullptr;
  return 0;
}

int never_set(int n) {
  int* const numbers = static_cast<int*>(std::malloc(3 * sizeof(int)));
  kept = numbers;
  if (numbers[n - 1] > 7) std::puts("more");
  std::free(kept);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const int n = static_cast<int>(std::strlen(argv[1])) - 2;  // heap 2, overflow 6, leak 2, unset 3
  if (std::strcmp(argv[1], "heap") == 0) return past_the_end(n) == 77;
  if (std::strcmp(argv[1], "overflow") == 0) return too_large(n) == 77;
  if (std::strcmp(argv[1], "leak") == 0) return leaked();
  return never_set(n);
}
