// SPDX-License-Identifier: Apache-2.0
// Blockers of a tile: those that are left out must shade none of its points. Points of tiles with all faces of the
// light's beam as blockers are the reference.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <random>

#include "exact/frontier.hpp"
#include "exact/portable_faces.hpp"
#include "exact/shadows.hpp"

using namespace clray;

namespace {

constexpr std::uint32_t kReplicates = 64;

/// Random triangles, of which many share corners and planes or lie in one place, as a beam meets them.
BeamFaces beam_of(std::uint32_t seed, bool lattice, const vec3& toward, const vec3& source) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto coordinate = [&] { return lattice ? std::floor(4.0 * any(random)) / 4.0 : any(random); };
  BeamFaces beam;
  static_cast<BeamFrame&>(beam) = BeamFrame(toward, 4.0);
  for (std::uint32_t n = 0; n < 60; ++n) {
    const vec3 middle = v3(coordinate(), coordinate(), coordinate());
    vec3 w[3];
    for (vec3& corner : w) corner = v3_add(middle, v3(0.5 * coordinate(), 0.5 * coordinate(), 0.5 * coordinate()));
    ClrayFace f{};
    const std::optional<FaceSide> side = place_face(beam, w[0], w[1], w[2], &f);
    if (!side) continue;
    set_path(beam, source, v3(0.0, 0.0, 0.0), &f);
    f.order = n;
    beam.x0 = std::min(beam.x0, f.box[0]);
    beam.x1 = std::max(beam.x1, f.box[1]);
    beam.y0 = std::min(beam.y0, f.box[2]);
    beam.y1 = std::max(beam.y1, f.box[3]);
    beam.faces.push_back(f);
    beam.origins.emplace_back();
    beam.origins.back().number = n;
  }
  return beam;
}

/// What points of a tile bring with these blockers.
std::vector<double> values(const BeamFaces& seen, const BeamFaces& lit, const Shadows& shadows,
                           const Frontier::Tile& tile, const std::vector<std::uint32_t>& blockers) {
  ClraySampling sampling{};
  sampling.replicates = kReplicates;
  sampling.elsewhere = 1;
  const ClrayTile at{tile.at.x0, tile.at.x1,  tile.at.y0, tile.at.y1,
                     seen.size,  seen.margin, 0,          static_cast<std::uint32_t>(tile.faces.size())};
  const std::uint32_t shaded[2] = {0, static_cast<std::uint32_t>(blockers.size())};
  const std::vector<double> weights(seen.faces.size(), 1.0);
  std::vector<double> found(kReplicates);
  SampleBuffers host;
  host.faces = seen.faces.data();
  host.weights = weights.data();
  host.tiles = &at;
  host.listed = tile.faces.data();
  host.carried = shadows.carried().data();
  host.lit_faces = lit.faces.data();
  host.shaded = shaded;
  host.blockers = blockers.data();
  host.sampling = &sampling;
  host.values = found.data();
  ExactNumbers numbers;
  numbers.carry = true;
  for (std::uint32_t k = 0; k < sample_items(1, kReplicates); ++k) sample_item_on_host(host, numbers, k);
  return found;
}

}  // namespace

TEST_CASE("shadows: a tile's blockers are all that shade its points, and what it leaves out as dark is dark") {
  std::size_t fewer = 0, dark = 0, bright = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const vec3 lights[] = {v3(0.48, 0.64, 0.6), v3(0.0, 0.6, -0.8), v3(0.8, -0.6, 1e-4), v3(0.0, 0.0, 1.0)};
    const vec3 way = lights[seed % 4];
    const double length = v3_length(way);
    const vec3 light = v3(way.x / length, way.y / length, way.z / length);
    const vec3 to = v3(0.0, 0.0, 1.0);
    const BeamFaces seen = beam_of(seed, seed % 2 == 0, to, light), lit = beam_of(seed, seed % 2 == 0, light, light);
    const Shadows shadows(seen, lit);
    Frontier frontier(seen, &shadows, [&](std::uint32_t face) { return shadows.may_be_lit(face); });
    const auto cut = [&](std::size_t most) {
      for (std::size_t count = 64; count <= most; count *= 4) {
        std::vector<double> areas;
        for (const Frontier::Tile& t : frontier.mixed()) areas.push_back(t.at.area());
        frontier.cut(areas, count);
      }
    };
    cut(1024);
    for (const Frontier::Tile& tile : frontier.mixed()) {
      const std::vector<double> right = values(seen, lit, shadows, tile, shadows.blockers());
      CHECK(values(seen, lit, shadows, tile, tile.blockers) == right);
      fewer += tile.blockers.size() < lit.faces.size() / 4;
    }
    cut(16384);
    for (const Frontier::Tile& tile : frontier.covered()) {
      for (const double value : values(seen, lit, shadows, tile, shadows.blockers())) CHECK(value == tile.at.area());
      ++bright;
    }
    // Of the rectangle, what is in no tile sends nothing: points of tiles that were left out find nothing lit.
    for (int i = 0; i < 32; ++i) {
      for (int k = 0; k < 32; ++k) {
        const double dx = (seen.x1 - seen.x0) / 32.0, dy = (seen.y1 - seen.y0) / 32.0;
        const Rectangle r{seen.x0 + i * dx, seen.x0 + (i + 1) * dx, seen.y0 + k * dy, seen.y0 + (k + 1) * dy};
        std::vector<std::uint32_t> all(seen.faces.size()), faces, kept;
        for (std::uint32_t f = 0; f < all.size(); ++f) all[f] = f;
        SeenFaces(seen).keep(r, all, &faces);
        std::vector<std::uint32_t> shining;
        for (const std::uint32_t f : faces) {
          if (shadows.may_be_lit(f)) shining.push_back(f);
        }
        if (shining.empty() || shadows.keep(r, shining, shadows.blockers(), &kept)) continue;
        for (const double value : values(seen, lit, shadows, {r, faces, {}, 0}, shadows.blockers()))
          CHECK(value == 0.0);
        ++dark;
      }
    }
  }
  CHECK(fewer > 100);
  CHECK(bright > 100);
  CHECK(dark > 100);
}
