// SPDX-License-Identifier: Apache-2.0
// See sample_device.hpp.
#include "pipeline/sample_device.hpp"

#include <algorithm>

#include "device/buffers.hpp"
#include "pipeline/exact_self_test.hpp"

namespace clray {
namespace {

constexpr std::size_t kGroup = 64;      // work-items
constexpr double kSliceSeconds = 0.15;  // of a launch: an interrupt waits no longer

}  // namespace

SampleDevice::SampleDevice(OpenedDevice& device, const ProgramOptions& options, const ExactNumbers& numbers)
    : opened_(device), numbers_(numbers) {
  kernel_ = make_kernel(opened_, build_program(opened_, "exact.cl", options), "clray_sample");
  opened_.test_once("sampled\n" + program_name("exact.cl", options), [&] {
    run_sample_self_test(opened_, program_source(opened_, "exact.cl", options), kernel_, numbers_);
  });
}

SampleDevice::SampleDevice(OpenedDevice& device, const cl::Kernel& kernel, const ExactNumbers& numbers)
    : opened_(device), numbers_(numbers), kernel_(kernel) {}

void SampleDevice::begin_view(const FaceGroup& group, const LightBeam& light) {
  check_buffer_size(opened_, static_cast<double>(sizeof(ClrayFace)) * static_cast<double>(group.faces.size()),
                    "the faces of a view", "faces");
  faces_ = make_buffer(opened_, group.faces);
  weights_ = make_buffer(opened_, group.weights);
  binnings_ = make_buffer(opened_, group.binnings);
  lit_faces_ = make_buffer(opened_, light.faces);
  carried_ = make_buffer(opened_, light.carried);
  bin_numbers_ = 0;
  for (const ClrayBinning& b : group.binnings) bin_numbers_ += numbers_.lanes * (b.bins + 2);
}

SampleSums SampleDevice::sample(const SampledTiles& tiles, const ClraySampling& sampling, Pause* pause) {
  const std::size_t points = tiles.tiles.size() * sampling.replicates;
  const std::size_t moments = sampling.adds == 0 ? 0 : std::size_t{3} * numbers_.lanes * sampling.replicates;
  const std::size_t bins = sampling.adds == 0 ? 0 : bin_numbers_ * sampling.replicates;
  check_sums_size(opened_, bins);
  const cl::Buffer values = make_buffer<double>(opened_, points), sums = make_zero_buffer<i64>(opened_, moments);
  const cl::Buffer histogram = make_zero_buffer<i64>(opened_, bins), hits = make_zero_buffer<u32>(opened_, bins);
  if (points > 0) {
    const cl::Buffer at = make_buffer(opened_, tiles.tiles), listed = make_buffer(opened_, tiles.listed);
    const cl::Buffer shaded = make_buffer(opened_, tiles.shaded), blockers = make_buffer(opened_, tiles.blockers);
    const cl::Buffer how = make_buffer(opened_, std::vector<ClraySampling>{sampling});
    const std::size_t items = sample_items(tiles.tiles.size(), sampling.replicates);
    for (std::size_t first = 0, end; first < items; first = end) {
      end = first + std::min(slice_items_, items - first);
      set_arguments(opened_, kernel_, faces_, weights_, at, listed, carried_, lit_faces_, shaded, blockers, binnings_,
                    how, values, sums, histogram, hits, static_cast<cl_uint>(first), static_cast<cl_uint>(end));
      const double start = now();
      launch(opened_, kernel_, end - first, kGroup);
      finish(opened_);
      const double factor = std::clamp(kSliceSeconds / std::max(now() - start, 1e-6), 0.25, 4.0);
      if (end - first == slice_items_ || factor < 1.0)
        slice_items_ = std::clamp<std::size_t>(static_cast<std::size_t>(factor * static_cast<double>(end - first)),
                                               kGroup, opened_.most_items);
      if (end < items && pause != nullptr) pause->ask();
    }
  }
  return {read_buffer<double>(opened_, values, points), read_buffer<i64>(opened_, sums, moments),
          read_buffer<i64>(opened_, histogram, bins), read_buffer<u32>(opened_, hits, bins)};
}

}  // namespace clray
