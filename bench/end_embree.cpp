// SPDX-License-Identifier: Apache-2.0
// See end_methods.hpp: the rival of clray-bench end. A tracer made for nothing but the pulse of one Lambert mesh: a
// rectangle as tight as the body's corners allow, packets of 16 rays from blocks of 4 x 4 neighbours, a random number
// by a hash per lane (the compiler makes vectors of these loops), all cores, a histogram per thread. Embree 3 and 4.
#include "end_methods.hpp"

#ifdef CLRAY_EMBREE
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>

#include "embree_body.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

using clray::now;
using clray::Vec3;

namespace {

constexpr std::uint32_t kPacketsPerThread = 512;  // below which another thread costs more than it brings

double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A hash of 32 bits (Wellons 2018, "lowbias32").
inline std::uint32_t hashed(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

/// From 0 to 1, 1 excluded.
inline float unit(std::uint32_t bits) {
  return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * 0x1p-24f;
}

/// Which points are traced: a grid of columns x rows cells with one point each, in blocks of 4 x 4, or random points.
struct Points {
  std::uint32_t packets = 0, across = 1;  // blocks in a row
  float inv_columns = 1.0f, inv_rows = 1.0f;
  std::uint32_t key = 0;
  bool grid = true;
};

class Tracer {
 public:
  explicit Tracer(const EndCase& which) {
    const clray::Mesh& mesh = *which.scene.components.at(0).mesh;
    const double rho = which.scene.materials.at(0).parameters.at("rho");
    const Vec3 s = which.scene.source.direction;
    find_beam(mesh, s);
    const double start = now();
    body_.emplace(mesh, RTC_BUILD_QUALITY_HIGH, false);
    build_s_ = now() - start;
    weights_.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
      const Vec3 n(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
      const double length = std::sqrt(dot(n, n));
      weights_.push_back(
          static_cast<float>(length > 0.0 ? rho / clray_test::kPi * std::fabs(dot(n, s)) / length : 0.0));
    }
  }

  Answer pulse(bool grid, int log2_rays, std::uint64_t seed, const Window& window) const {
    const double start = now();
    const Points points = points_of(grid, log2_rays, seed);
    // Of a hit: 0 below the window, then the bins, then above it.
    const double metres = 0.5 * clray_test::kLightSpeed;  // of depth per second of delay
    const auto per_depth = static_cast<float>(1.0 / (metres * window.width_s));
    const auto zero = static_cast<float>(1.0 - (start_depth_ / metres + window.first_s) / window.width_s);
    const auto most = static_cast<float>(window.bins + 1);
    const unsigned threads = threads_for(points);
    std::vector<std::vector<double>> sums(threads, std::vector<double>(window.bins + 2, 0.0));
    run(points, threads, [&](unsigned thread, std::uint32_t first, std::uint32_t end) {
      double* const sum = sums[thread].data();
      RTCRayHit16 packet = new_packet();
      alignas(64) std::int32_t bin[kLanes];
      for (std::uint32_t p = first; p < end; ++p) {
        aim(points, p, &packet);
        intersect(points.grid, &packet);
        for (int k = 0; k < kLanes; ++k) {
          const float x = std::min(packet.ray.tfar[k], 1e30f) * per_depth + zero;
          bin[k] = static_cast<std::int32_t>(std::min(std::max(x, 0.0f), most));
        }
        for (int k = 0; k < kLanes; ++k) {
          const std::uint32_t face = packet.hit.primID[k];
          if (face != RTC_INVALID_GEOMETRY_ID) sum[bin[k]] += static_cast<double>(weights_[face]);
        }
      }
    });
    Answer answer;
    const double share = area_ / (16.0 * points.packets);
    std::vector<double> all(window.bins + 2, 0.0);
    for (const std::vector<double>& one : sums) {
      for (std::size_t b = 0; b < all.size(); ++b) all[b] += share * one[b];
    }
    for (const double b : all) answer.total += b;
    answer.bins.assign(all.begin() + 1, all.end() - 1);
    answer.seconds = now() - start;
    answer.prepared_s = build_s_;
    return answer;
  }

  /// Seconds of the same rays, made before, with intersection and nothing else: origins are copied in from memory.
  double bare(bool grid, int log2_rays) const {
    const Points points = points_of(grid, log2_rays, 1);
    RTCRayHit16 packet = new_packet();
    std::vector<float> origins(std::size_t{3} * kLanes * points.packets);
    for (std::uint32_t p = 0; p < points.packets; ++p) {
      aim(points, p, &packet);
      std::copy_n(packet.ray.org_x, 3 * kLanes, &origins[std::size_t{3} * kLanes * p]);  // x, y and z follow each other
    }
    const double start = now();
    run(points, threads_for(points), [&](unsigned, std::uint32_t first, std::uint32_t end) {
      RTCRayHit16 own = new_packet();
      for (std::uint32_t p = first; p < end; ++p) {
        std::copy_n(&origins[std::size_t{3} * kLanes * p], 3 * kLanes, own.ray.org_x);
        open(&own);
        intersect(grid, &own);
      }
    });
    return now() - start;
  }

 private:
  void find_beam(const clray::Mesh& mesh, const Vec3& s) {
    const Vec3 aside = std::fabs(s.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 across(aside.y * s.z - aside.z * s.y, aside.z * s.x - aside.x * s.z, aside.x * s.y - aside.y * s.x);
    const Vec3 u = (1.0 / std::sqrt(dot(across, across))) * across;
    const Vec3 v(s.y * u.z - s.z * u.y, s.z * u.x - s.x * u.z, s.x * u.y - s.y * u.x);
    double low[3], high[3];
    std::fill(low, low + 3, std::numeric_limits<double>::infinity());
    std::fill(high, high + 3, -std::numeric_limits<double>::infinity());
    for (const Vec3& p : mesh.vertices) {
      const double at[3] = {dot(u, p), dot(v, p), dot(s, p)};
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    start_depth_ = high[2] + 0.01 * (high[2] - low[2]);
    width_ = high[0] - low[0];
    height_ = high[1] - low[1];
    area_ = width_ * height_;
    corner_ = floats(low[0] * u + low[1] * v + start_depth_ * s);
    edge_u_ = floats(width_ * u);
    edge_v_ = floats(height_ * v);
    down_ = floats(-1.0 * s);
  }

  Points points_of(bool grid, int log2_rays, std::uint64_t seed) const {
    Points p;
    p.grid = grid;
    p.key = hashed(static_cast<std::uint32_t>(seed) * 0x9e3779b9u + 1u);
    const double packets = std::ldexp(1.0, log2_rays) / kLanes;
    if (!grid) {
      p.packets = static_cast<std::uint32_t>(packets);
      return p;
    }
    // Cells as square as can be.
    p.across = static_cast<std::uint32_t>(std::max(1.0, std::round(std::sqrt(packets * width_ / height_))));
    const auto down = static_cast<std::uint32_t>(std::max(1.0, std::round(packets / p.across)));
    p.packets = p.across * down;
    p.inv_columns = 0.25f / static_cast<float>(p.across);
    p.inv_rows = 0.25f / static_cast<float>(down);
    return p;
  }

  static unsigned threads_for(const Points& points) {
    return std::clamp(points.packets / kPacketsPerThread, 1u, std::max(1u, std::thread::hardware_concurrency()));
  }

  template <class Work>
  static void run(const Points& points, unsigned threads, const Work& work) {
    std::atomic<std::uint32_t> next{0};
    const auto take = [&](unsigned thread) {
      const NoSubnormals scope;
      for (std::uint32_t first; (first = next.fetch_add(kChunk)) < points.packets;)
        work(thread, first, std::min(first + kChunk, points.packets));
    };
    std::vector<std::thread> others;
    for (unsigned k = 1; k < threads; ++k) others.emplace_back(take, k);
    take(0);
    for (std::thread& t : others) t.join();
  }

  RTCRayHit16 new_packet() const {
    RTCRayHit16 packet{};
    for (int k = 0; k < kLanes; ++k) {
      packet.ray.dir_x[k] = down_.x;
      packet.ray.dir_y[k] = down_.y;
      packet.ray.dir_z[k] = down_.z;
      packet.ray.mask[k] = ~0u;
      packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    return packet;
  }

  /// Sets the rays of a packet.
  void aim(const Points& points, std::uint32_t number, RTCRayHit16* packet) const {
    alignas(64) float p[kLanes], q[kLanes];
    const std::uint32_t first = number * kLanes ^ points.key;
    for (int k = 0; k < kLanes; ++k) {
      const std::uint32_t h = hashed(first + static_cast<std::uint32_t>(k));
      p[k] = unit(h);
      q[k] = unit(hashed(h ^ 0x68bc21ebu));
    }
    if (points.grid) {
      const std::uint32_t row = number / points.across;
      const auto x = static_cast<float>(4 * (number - row * points.across)), y = static_cast<float>(4 * row);
      for (int k = 0; k < kLanes; ++k) {
        p[k] = (x + static_cast<float>(k & 3) + p[k]) * points.inv_columns;
        q[k] = (y + static_cast<float>(k >> 2) + q[k]) * points.inv_rows;
      }
    }
    for (int k = 0; k < kLanes; ++k) {
      packet->ray.org_x[k] = corner_.x + p[k] * edge_u_.x + q[k] * edge_v_.x;
      packet->ray.org_y[k] = corner_.y + p[k] * edge_u_.y + q[k] * edge_v_.y;
      packet->ray.org_z[k] = corner_.z + p[k] * edge_u_.z + q[k] * edge_v_.z;
    }
    open(packet);
  }

  /// Forgets the last hits.
  static void open(RTCRayHit16* packet) {
    for (int k = 0; k < kLanes; ++k) {
      packet->ray.tfar[k] = std::numeric_limits<float>::infinity();
      packet->hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      packet->hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
    }
  }

  void intersect(bool coherent, RTCRayHit16* packet) const {
    alignas(64) static constexpr int kAll[kLanes] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
#if CLRAY_EMBREE >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(kAll, body_->scene(), packet, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(kAll, body_->scene(), &context, packet);
#endif
  }

  std::optional<EmbreeBody> body_;
  double build_s_ = 0.0;
  double start_depth_ = 0.0, width_ = 0.0, height_ = 0.0, area_ = 0.0;
  Floats corner_{}, edge_u_{}, edge_v_{}, down_{};
  std::vector<float> weights_;  // A per m² across the beam
};

/// Speeds as the quickest of some runs in turn: what else the machine does only adds to a time.
struct Speed {
  double share = 0.0, bare_mrays_s = 0.0;  // of bare intersection, and that
};
Speed speed_of(const Tracer& tracer, const Window& window, bool grid, int log2_rays) {
  double whole = std::numeric_limits<double>::infinity(), bare = whole;
  for (std::uint64_t k = 1; k <= 9; ++k) {
    whole = std::min(whole, tracer.pulse(grid, log2_rays, k, window).seconds);
    bare = std::min(bare, tracer.bare(grid, log2_rays));
  }
  return {bare / whole, std::ldexp(1e-6, log2_rays) / bare};
}

}  // namespace

std::vector<EndMethod> embree_methods(const EndCase& which, const Window& window, const std::vector<int>& log2_rays,
                                      std::string* about) {
  const auto tracer = std::make_shared<Tracer>(which);
  const int some = std::min(log2_rays.back(), 18);
  const Speed grid = speed_of(*tracer, window, true, some), random = speed_of(*tracer, window, false, some);
  *about = fmt::format(
      "{}: {:.0f} % of the speed of bare `rtcIntersect16` on the grid (which is {:.1f} million rays/s), {:.0f} % on "
      "random points "
      "({:.1f})",
      which.name, 100.0 * grid.share, grid.bare_mrays_s, 100.0 * random.share, random.bare_mrays_s);
  std::vector<EndMethod> methods;
  for (const bool jittered : {true, false}) {
    methods.push_back({jittered ? "Embree, jittered grid" : "Embree, random points", false, log2_rays,
                       [tracer, window, jittered](int effort, std::uint64_t seed) {
                         return tracer->pulse(jittered, effort, seed, window);
                       }});
  }
  return methods;
}

std::string embree_line() {
  return "Embree " RTC_VERSION_STRING;
}

}  // namespace clray_bench

#else

namespace clray_bench {

std::vector<EndMethod> embree_methods(const EndCase&, const Window&, const std::vector<int>&, std::string*) {
  return {};
}

std::string embree_line() {
  return "no Embree (this clray-bench was built without it: the rival is left out)";
}

}  // namespace clray_bench
#endif
