// SPDX-License-Identifier: Apache-2.0
// See rays.hpp: the rival of clray-bench rays. Its paths go as those of clray do: the same rectangle, shadow rays and
// roulette (kernels/stage/scatter.cl). Embree 3.
#include "rays.hpp"

#if defined(CLRAY_EMBREE) && CLRAY_EMBREE == 3
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "embree_body.hpp"

namespace clray_bench {

using clray::now;
using clray::Vec3;

namespace {

constexpr int kBounces = 4;
constexpr float kSurvival[kBounces] = {1.0f, 1.0f, 0.125f, 0.5f};  // of roulette, for albedo 0.5

Floats operator+(Floats a, Floats b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Floats operator*(float s, Floats a) {
  return {s * a.x, s * a.y, s * a.z};
}
float dot(Floats a, Floats b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Floats cross(Floats a, Floats b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Floats unit(Floats a) {
  return (1.0f / std::sqrt(dot(a, a))) * a;
}

/// Random numbers by a hash of a counter (Wellons 2018, "lowbias32").
struct Random {
  std::uint32_t state;
  float next() {
    std::uint32_t x = state += 0x9e3779b9u;
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return static_cast<float>((x ^ x >> 16) >> 8) * 0x1p-24f;
  }
};

class Tracer : public PathRival {
 public:
  Tracer(const clray::Mesh& mesh, const PathViews& views, bool robust, unsigned threads)
      : light_(floats(views.light)),
        observer_(floats(views.observer)),
        threads_(threads),
        body_(mesh, RTC_BUILD_QUALITY_MEDIUM, robust) {
    find_beam(mesh);
  }
  double build_s() const override { return body_.commit_s(); }

  PathRun run(PathKind kind, bool single, int log2_paths) const override {
    const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(std::ldexp(1.0, log2_paths) / kLanes)));
    const std::uint32_t packets = side * side;
    std::atomic<std::uint32_t> next{0};
    std::atomic<std::uint64_t> rays{0}, hits{0};
    const auto work = [&] {
      const NoSubnormals scope;
      PathRun own;
      for (std::uint32_t first; (first = next.fetch_add(kChunk)) < packets;) {
        for (std::uint32_t p = first; p < std::min(first + kChunk, packets); ++p) {
          Random random{p * 2654435761u};
          single ? alone(kind, &random, &own) : packet(kind, p, side, &random, &own);
        }
      }
      rays += own.rays;
      hits += own.hits;
    };
    const double start = now();
    std::vector<std::thread> threads;
    for (unsigned k = 0; k < threads_; ++k) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    return {now() - start, std::uint64_t{packets} * kLanes, rays, hits};
  }

 private:
  void find_beam(const clray::Mesh& mesh) {
    const Floats aside = std::fabs(light_.x) < 0.5f ? Floats{1, 0, 0} : Floats{0, 1, 0};
    const Floats u = unit(cross(aside, light_)), v = cross(light_, u);
    float low[3], high[3];
    std::fill(low, low + 3, std::numeric_limits<float>::infinity());
    std::fill(high, high + 3, -std::numeric_limits<float>::infinity());
    for (const Vec3& vertex : mesh.vertices) {
      const Floats p = floats(vertex);
      const float at[3] = {dot(u, p), dot(v, p), dot(light_, p)};
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    reach_ = 1e-5f * (high[2] - low[2] + high[0] - low[0]);
    corner_ = low[0] * u + low[1] * v + (high[2] + 1000.0f * reach_) * light_;
    edge_u_ = (high[0] - low[0]) * u;
    edge_v_ = (high[1] - low[1]) * v;
  }

  Floats start(float x, float y) const { return corner_ + x * edge_u_ + y * edge_v_; }

  static RTCIntersectContext context_of(bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
  }

  void packet(PathKind kind, std::uint32_t number, std::uint32_t side, Random* random, PathRun* run) const {
    if (kind == PathKind::bounces) return alone(kind, random, run);
    alignas(64) int valid[kLanes];
    RTCRayHit16 r;
    const float cell = 0.25f / static_cast<float>(side);
    const auto x = static_cast<float>(4 * (number % side)), y = static_cast<float>(4 * (number / side));
    for (int k = 0; k < kLanes; ++k) {
      const Floats o = start((x + static_cast<float>(k & 3) + random->next()) * cell,
                             (y + static_cast<float>(k >> 2) + random->next()) * cell);
      valid[k] = -1;
      r.ray.org_x[k] = o.x, r.ray.org_y[k] = o.y, r.ray.org_z[k] = o.z;
      r.ray.dir_x[k] = -light_.x, r.ray.dir_y[k] = -light_.y, r.ray.dir_z[k] = -light_.z;
      r.ray.tnear[k] = 0.0f, r.ray.tfar[k] = std::numeric_limits<float>::infinity();
      r.ray.time[k] = 0.0f, r.ray.mask[k] = ~0u, r.ray.flags[k] = 0;
      r.hit.geomID[k] = r.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context = context_of(true);
    rtcIntersect16(valid, body_.scene(), &context, &r);
    run->rays += kLanes;
    int shadows = 0;
    for (int k = 0; k < kLanes; ++k) {
      valid[k] = 0;
      if (r.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
      ++run->hits;
      const Floats n = outward({r.hit.Ng_x[k], r.hit.Ng_y[k], r.hit.Ng_z[k]}, light_);
      if (kind == PathKind::beam || dot(n, observer_) <= 0.0f) continue;
      const float t = r.ray.tfar[k];
      valid[k] = -1;
      ++shadows;
      r.ray.org_x[k] += t * r.ray.dir_x[k] + reach_ * n.x;
      r.ray.org_y[k] += t * r.ray.dir_y[k] + reach_ * n.y;
      r.ray.org_z[k] += t * r.ray.dir_z[k] + reach_ * n.z;
      r.ray.dir_x[k] = observer_.x, r.ray.dir_y[k] = observer_.y, r.ray.dir_z[k] = observer_.z;
      r.ray.tfar[k] = std::numeric_limits<float>::infinity();
    }
    if (shadows == 0) return;
    rtcOccluded16(valid, body_.scene(), &context, &r.ray);
    run->rays += static_cast<std::uint64_t>(shadows);
  }

  static Floats outward(Floats normal, Floats toward) {
    const Floats n = unit(normal);
    return dot(n, toward) < 0.0f ? -1.0f * n : n;
  }

  RTCRay ray_of(Floats o, Floats d) const {
    return {o.x, o.y, o.z, 0.0f, d.x, d.y, d.z, 0.0f, std::numeric_limits<float>::infinity(), ~0u, 0, 0};
  }

  void alone(PathKind kind, Random* random, PathRun* run) const {
    for (int k = 0; k < kLanes; ++k) path(kind, random, run);
  }

  void path(PathKind kind, Random* random, PathRun* run) const {
    RTCIntersectContext context = context_of(false);
    const float x = random->next();
    Floats o = start(x, random->next()), d = -1.0f * light_;
    const Floats observer = kind == PathKind::bounces ? light_ : observer_;
    for (int bounce = 0; bounce <= kBounces; ++bounce) {
      RTCRayHit r;
      r.ray = ray_of(o, d);
      r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(body_.scene(), &context, &r);
      ++run->rays;
      if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
      run->hits += bounce == 0;
      if (kind == PathKind::beam || bounce == kBounces) return;
      const Floats n = outward({r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z}, -1.0f * d);
      o = o + r.ray.tfar * d + reach_ * n;
      if ((kind == PathKind::bistatic || bounce > 0) && dot(n, observer) > 0.0f) {
        RTCRay shadow = ray_of(o, observer);
        rtcOccluded1(body_.scene(), &context, &shadow);
        ++run->rays;
      }
      if (kind == PathKind::bistatic || random->next() >= kSurvival[bounce]) return;
      const float s = random->next(), angle = 6.2831853f * random->next(), radius = std::sqrt(s);
      const Floats u = unit(cross(std::fabs(n.x) < 0.5f ? Floats{1, 0, 0} : Floats{0, 1, 0}, n)), v = cross(n, u);
      d = unit(radius * std::cos(angle) * u + radius * std::sin(angle) * v + std::sqrt(1.0f - s) * n);
    }
  }

  Floats light_, observer_, corner_{}, edge_u_{}, edge_v_{};
  float reach_ = 0.0f;  // how far from a surface rays leave it
  unsigned threads_;
  EmbreeBody body_;
};

}  // namespace

std::unique_ptr<PathRival> path_rival(const clray::Mesh& mesh, const PathViews& views, bool robust, unsigned threads) {
  return std::make_unique<Tracer>(mesh, views, robust, threads);
}

}  // namespace clray_bench

#else

namespace clray_bench {

std::unique_ptr<PathRival> path_rival(const clray::Mesh&, const PathViews&, bool, unsigned) {
  return nullptr;
}

}  // namespace clray_bench
#endif
