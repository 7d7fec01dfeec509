// SPDX-License-Identifier: Apache-2.0
// What the rivals on Embree share (end_embree.cpp, rays_embree.cpp): Embree's header of the version that was found, and
// a mesh in its scene.
#pragma once

#if CLRAY_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cstdint>

#include "clray/scene.hpp"
#include "pipeline/clock.hpp"

namespace clray_bench {

constexpr int kLanes = 16;             // rays of a packet
constexpr std::uint32_t kChunk = 256;  // packets that a thread takes at a time

struct Floats {
  float x, y, z;
};
inline Floats floats(const clray::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Subnormal numbers are zero for this thread, as Embree recommends, until it goes.
class NoSubnormals {
 public:
#ifdef __SSE__
  NoSubnormals() {
    _mm_setcsr(before_ | 0x8040u);
  }
  ~NoSubnormals() {
    _mm_setcsr(before_);
  }

 private:
  const unsigned before_ = _mm_getcsr();
#else
  NoSubnormals() {}
#endif
};

/// The triangles of a mesh as Embree holds them.
class EmbreeBody {
 public:
  EmbreeBody(const clray::Mesh& mesh, RTCBuildQuality quality, bool robust)
      : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneBuildQuality(scene_, quality);
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<Floats*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Floats), mesh.vertices.size()));
    std::transform(mesh.vertices.begin(), mesh.vertices.end(), corners, floats);
    auto* faces = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) std::copy_n(mesh.triangles[k].begin(), 3, faces + 3 * k);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    const double begin = clray::now();
    rtcCommitScene(scene_);
    commit_s_ = clray::now() - begin;
  }
  ~EmbreeBody() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeBody(const EmbreeBody&) = delete;
  EmbreeBody& operator=(const EmbreeBody&) = delete;

  RTCScene scene() const { return scene_; }
  double commit_s() const { return commit_s_; }  ///< of building the tree alone

 private:
  RTCDevice device_;
  RTCScene scene_;
  double commit_s_ = 0.0;
};

}  // namespace clray_bench
