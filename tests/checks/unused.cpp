// SPDX-License-Identifier: Apache-2.0
// A fault that scripts/check clang must find: clang warns of a private member that nobody uses, other compilers do not.
class Planted {
  int unused_ = 0;
};

int planted() {
  return static_cast<int>(sizeof(Planted));
}
