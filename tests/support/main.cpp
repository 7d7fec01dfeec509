// SPDX-License-Identifier: Apache-2.0
// The main function of every test program.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <csignal>

int main(int count, char** words) {
  // Tests send signals to the programs that they start. nohup has them ignored, which started programs inherit and
  // keep.
  for (const int signal : {SIGHUP, SIGINT}) std::signal(signal, SIG_DFL);
  return doctest::Context(count, words).run();
}
