// SPDX-License-Identifier: Apache-2.0
// See tracer.hpp. A triangle is the plane through it and three half-spaces, each bounded by the plane that holds
// an edge and the ray's direction; all rays of a run share two directions, so these are made once for each.
#include "tracer.hpp"

#include <algorithm>

namespace clray_reference {
namespace {

constexpr Real kNear = 1e-12L;  // of the extent: closer calls are not this judge's to make

struct Crossing {
  std::size_t triangle = 0;
  Real t = 0;
  bool firm = true;  // farther than kNear from every edge
};

/// All triangles as rays of one direction see them.
class Sight {
 public:
  Sight(const Body& body, V3 direction, Real near_m) : direction_(direction), near_m_(near_m) {
    for (std::size_t i = 0; i < body.triangles.size(); ++i) add(body.triangles[i], i);
  }

  /// Crossings of the ray from `p` with t > t_low, nearest first.
  std::vector<Crossing> crossings(V3 p, Real t_low, std::size_t except) const {
    std::vector<Crossing> found;
    for (const Seen& s : seen_) {
      if (s.triangle == except) continue;
      Real inside = dot(s.side[0], p) - s.offset[0];
      if (inside < -near_m_) continue;
      inside = std::min(inside, dot(s.side[1], p) - s.offset[1]);
      if (inside < -near_m_) continue;
      inside = std::min(inside, dot(s.side[2], p) - s.offset[2]);
      if (inside < -near_m_) continue;
      const Real t = (s.plane - dot(s.normal, p)) / s.slope;
      if (t > t_low) found.push_back({s.triangle, t, inside > near_m_});
    }
    std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
    return found;
  }

 private:
  struct Seen {
    std::size_t triangle;
    V3 normal;
    Real plane, slope;
    V3 side[3];
    Real offset[3];
  };

  void add(const Triangle& triangle, std::size_t index) {
    Seen s;
    s.triangle = index;
    s.normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
    s.plane = dot(s.normal, triangle.a);
    s.slope = dot(s.normal, direction_);
    // Edge-on to long double's rounding: nothing to hit.
    if (!(std::fabs(s.slope) > 1e-17L * length(s.normal))) return;
    const V3 corner[3] = {triangle.a, triangle.b, triangle.c};
    const Real turn = s.slope > 0 ? 1 : -1;
    for (int i = 0; i < 3; ++i) {
      s.side[i] = turn * unit(cross(direction_, corner[(i + 1) % 3] - corner[i]));
      s.offset[i] = dot(s.side[i], corner[i]);
    }
    seen_.push_back(s);
  }

  V3 direction_;
  Real near_m_;
  std::vector<Seen> seen_;
};

enum class Lit { yes, no, unsure };

Lit toward_observer(const Sight& sight, V3 x, std::size_t own, Real near_m) {
  Lit lit = Lit::yes;
  for (const Crossing& c : sight.crossings(x, -near_m, own)) {
    if (c.firm && c.t > near_m) return Lit::no;
    lit = Lit::unsure;
  }
  return lit;
}

Real extent_of(const Body& body) {
  Real extent = 0;
  for (const Triangle& t : body.triangles)
    for (V3 v : {t.a, t.b, t.c}) extent = std::max(extent, length(v));
  return extent;
}

struct Tracer {
  const Body& body;
  V3 s, o, reference;
  bool shadow_rays;
  Window window;
  Real near_m, sample_m2;
  Sight from_source, to_observer;
  Histogram result;

  Real weight(std::size_t triangle) const {
    const Triangle& t = body.triangles[triangle];
    const V3 n = unit(cross(t.b - t.a, t.c - t.a));
    return reflect(body.materials[t.material], n, s, o) * std::fabs(dot(n, o)) * sample_m2;
  }

  Real position(V3 x) const {  // in bins
    const Real delay = -(dot(s, x - reference) + dot(o, x - reference)) / kLightSpeed;
    return (delay - window.first_s) / window.bin_s;
  }

  bool in_window(Real bin) const { return bin >= 0 && bin < static_cast<Real>(window.bins); }

  void doubt(V3 x, Real w) {
    const Real slack = 4 * near_m / (kLightSpeed * window.bin_s);
    const Real at = position(x);
    for (Real bin = std::floor(at - slack); bin <= std::floor(at + slack); ++bin)
      if (in_window(bin)) result.undecided[static_cast<std::size_t>(bin)] += w;
  }

  void record(V3 x, Real w) {
    const Real at = position(x), bin = std::floor(at);
    result.total += w;
    if (bin < 0) {
      result.below += w;
    } else if (!in_window(bin)) {
      result.above += w;
    } else {
      result.bin[static_cast<std::size_t>(bin)] += w;
      ++result.hits[static_cast<std::size_t>(bin)];
    }
  }

  void sample(V3 p) {
    const std::vector<Crossing> met = from_source.crossings(p, -near_m, body.triangles.size());
    if (met.empty()) return;
    bool sure = met[0].firm && (met.size() == 1 || met[1].t - met[0].t > near_m);
    const V3 first = p - met[0].t * s;
    const Real slack = 4 * near_m / (kLightSpeed * window.bin_s);
    const Real at = position(first);
    if (std::fabs(at - std::round(at)) < slack) sure = false;
    if (sure) {
      const Real w = weight(met[0].triangle);
      if (!(w > 0)) return;
      const Lit lit = shadow_rays ? toward_observer(to_observer, first, met[0].triangle, near_m) : Lit::yes;
      if (lit == Lit::yes) record(first, w);
      if (lit == Lit::unsure) exclude(p, {met[0]});
    } else {
      exclude(p, met);
    }
  }

  /// What an excluded sample could bring: any crossing up to the first one that surely stops the ray.
  void exclude(V3 p, const std::vector<Crossing>& met) {
    ++result.excluded;
    Real stop = 0;
    bool stopped = false;
    for (const Crossing& c : met) {
      if (stopped && c.t - stop > near_m) break;
      const V3 x = p - c.t * s;
      if (!shadow_rays || toward_observer(to_observer, x, c.triangle, near_m) != Lit::no) doubt(x, weight(c.triangle));
      if (c.firm && !stopped) stopped = true, stop = c.t;
    }
  }
};

}  // namespace

Beam bounding_beam(const Body& body, V3 s) {
  const Real sign = s.z >= 0 ? 1 : -1;
  const Real a = -1 / (sign + s.z), b = s.x * s.y * a;
  const V3 u = {1 + sign * s.x * s.x * a, sign * b, -sign * s.x}, v = {b, sign + s.y * s.y * a, -s.y};
  Real low[3], high[3];
  const V3 axis[3] = {u, v, s};
  for (int i = 0; i < 3; ++i) {
    low[i] = INFINITY, high[i] = -INFINITY;
    for (const Triangle& t : body.triangles)
      for (V3 x : {t.a, t.b, t.c}) {
        low[i] = std::min(low[i], dot(axis[i], x));
        high[i] = std::max(high[i], dot(axis[i], x));
      }
  }
  // Started above the body, so that no hit is at t = 0.
  const Real start = high[2] + (high[2] - low[2]) + (high[0] - low[0]) + (high[1] - low[1]);
  return {low[0] * u + low[1] * v + start * s, (high[0] - low[0]) * u, (high[1] - low[1]) * v};
}

Histogram trace(const Body& body, V3 s, V3 o, bool shadow_rays, const Beam& beam, const Window& window,
                const std::vector<Point>& points, V3 reference) {
  const Real near_m = kNear * extent_of(body);
  const Real sample_m2 = length(cross(beam.edge_u, beam.edge_v)) / static_cast<Real>(points.size());
  Tracer tracer{
      body, s, o, reference, shadow_rays, window, near_m, sample_m2, Sight(body, -s, near_m), Sight(body, o, near_m),
      {}};
  Histogram& result = tracer.result;
  result.bin.assign(window.bins, 0);
  result.undecided.assign(window.bins, 0);
  result.hits.assign(window.bins, 0);
  result.samples = points.size();
  result.sample_m2 = sample_m2;
  for (const Point& q : points)
    tracer.sample(beam.corner + static_cast<Real>(q[0]) * beam.edge_u + static_cast<Real>(q[1]) * beam.edge_v);
  return result;
}

}  // namespace clray_reference
