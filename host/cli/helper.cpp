// SPDX-License-Identifier: Apache-2.0
// See helper.hpp.
#include "helper.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <exception>
#include <string>

#include "arguments.hpp"
#include "clray/device.hpp"
#include "clray/result.hpp"

namespace clray::cli {

namespace {

/// Help, versions and lists are printed once, by rank 0.
void be_silent() {
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere < 0) return;
  ::dup2(nowhere, STDOUT_FILENO);
  ::close(nowhere);
}

void help(int argc, char** argv, cluster::Job& job) {
  const Arguments arguments = parse_arguments(argc, argv);
  const bool asks = !arguments.list.empty() || arguments.check || arguments.dump_kernel || arguments.verb == "verify";
  if (arguments.finished || asks) return;
  Scene scene = load_scene(arguments.scene, arguments.scene_options);
  apply(arguments, scene);
  Device device(arguments.device, {job.on_node(), job.of_node()});
  device.limit_memory(arguments.memory_bytes);
  trace(scene, device, {}, {}, job);
}

}  // namespace

void help_rank_0(int argc, char** argv, cluster::Job& job, KernelFolder& kernels) noexcept {
  be_silent();
  try {
    help(argc, argv, job);
  } catch (const std::exception& error) {
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    try {
      leave_run(job, std::string(error.what()) + " (on " + host + ")");
    } catch (const std::exception&) {  // rank 0 is gone, and the job with it
    }
  }
  kernels.note_files();
}

}  // namespace clray::cli
