// SPDX-License-Identifier: Apache-2.0
// See cell_weights.hpp. Lengths in m, in the beam's axes (u, v, toward the source). Plain fp64 without contraction: the
// same weights on every host.
#include "beam/cell_weights.hpp"

#include <algorithm>
#include <cmath>

#include "body/portable_tables.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr std::size_t kMostLooks = 16;  // weights of a cell: observers times lanes
constexpr std::size_t kExchangeLooks = 2;
constexpr double kMostPairs = 1 << 16;     // of cells that exchange light, of a view
constexpr double kPairsOfViews = 1 << 24;  // of all views
constexpr vec3 kSource{0.0, 0.0, 1.0};

const ClrayMaterial& material_of(const CellsOfView& x, const BeamCell& cell, std::size_t lane) {
  const MaterialTable& table = x.steering.materials;
  return table.rows[lane * table.columns + x.geometry.primitives[cell.primitive].material];
}

bool reflects(const BeamCell& cell, const ClrayMaterial& material) {
  return !cell.back || (material.flags & CLRAY_MATERIAL_TWO_SIDED) != 0;
}

double weight_of(const CellsOfView& x, const BeamCell& cell, std::size_t lane, const vec3& o) {
  if (cell.state == BeamCell::empty || !(cell.normal.z > 0.0)) return 0.0;
  if (x.steering.counts && !x.steering.counts(x.view, cell.primitive)) return 0.0;
  const ClrayMaterial& material = material_of(x, cell, lane);
  if (!reflects(cell, material)) return 0.0;
  const vec3 n = v3_unit(cell.normal);
  if (!(v3_dot(n, o) > 0.0)) return 0.0;
  return surface_weight(material, x.steering.materials.tables, n, kSource, o);
}

/// A surface that stands for a block of cells.
struct Patch {
  vec3 point, normal;
  double area_m2;
  const BeamCell* cell;
  std::uint32_t u, v;  // of the block
};

/// One surface for each block of side × side cells, from the cell at its middle or, if that is empty, another.
std::vector<Patch> patches(const CellsOfView& x, std::uint32_t side) {
  std::vector<Patch> found;
  const std::uint32_t n = x.grid.cells;
  const double size_u = x.grid.size_u / n, size_v = x.grid.size_v / n;
  for (std::uint32_t v = 0; v < n; v += side) {
    for (std::uint32_t u = 0; u < n; u += side) {
      const std::uint32_t middle = side / 2;
      for (std::uint32_t k = 0; k < side * side; ++k) {
        const std::uint32_t j = v + (middle + k / side) % side, i = u + (middle + k % side) % side;
        const BeamCell& cell = x.cells[j * n + i];
        if (cell.state == BeamCell::empty || !(cell.normal.z > 0.0)) continue;
        const vec3 normal = v3_unit(cell.normal);
        const vec3 point = v3(x.grid.u0 + (i + 0.5) * size_u, x.grid.v0 + (j + 0.5) * size_v, cell.w);
        const double across = size_u * size_v * side * side;
        found.push_back({point, normal, across / std::max(normal.z, 1e-3), &cell, u / side, v / side});
        break;
      }
    }
  }
  return found;
}

/// What a patch that the source lights sends toward d, per unit of solid angle; of a mirror as if it were even.
double sent(const CellsOfView& x, const Patch& p, std::size_t lane, const vec3& d) {
  const double mu = v3_dot(p.normal, d);
  const ClrayMaterial& material = material_of(x, *p.cell, lane);
  if (!(mu > 0.0) || !reflects(*p.cell, material)) return 0.0;
  if (table("brdf")[material.model].delta) return mu * CLRAY_INV_PI;
  return surface_weight(material, x.steering.materials.tables, p.normal, kSource, d);
}

/// The light that goes from one patch to another and from there toward o.
double exchanged(const CellsOfView& x, const Patch& from, const Patch& to, std::size_t lane, const vec3& o) {
  if (!(v3_dot(to.normal, o) > 0.0)) return 0.0;
  const vec3 way = v3_sub(to.point, from.point);
  const double square = v3_dot(way, way) + to.area_m2;  // patches are no points
  const vec3 d = v3_unit(way);
  const double mu = -v3_dot(to.normal, d);
  const ClrayMaterial& material = material_of(x, *to.cell, lane);
  if (!(mu > 0.0) || !reflects(*to.cell, material)) return 0.0;
  const double left = sent(x, from, lane, d);
  if (left == 0.0) return 0.0;
  return left * mu * to.area_m2 / square *
         surface_weight(material, x.steering.materials.tables, to.normal, v3_neg(d), o);
}

/// Adds up the shares of each cell in what `found_of` (of a lane, and of the direction o to an observer) finds: for
/// every observer, and for so many lanes that there are some `most` looks.
template <class Function>
std::vector<double> mean_shares(const CellsOfView& x, std::size_t most, Function&& found_of) {
  std::vector<double> weights(x.cells.size(), 0.0);
  const std::size_t connections = x.beams.connections.size() / x.beams.views.size();
  const std::size_t lanes = x.steering.lanes, some = std::max<std::size_t>(most / connections, 1);
  const std::size_t step = (lanes + some - 1) / some;
  for (std::size_t c = 0; c < connections; ++c) {
    const vec3 body = v3_load(x.beams.connections[x.view * connections + c].direction);
    const vec3 o = v3(v3_dot(body, x.grid.u), v3_dot(body, x.grid.v), v3_dot(body, x.grid.toward));
    for (std::size_t lane = 0; lane < lanes; lane += step) {
      const std::vector<double> found = found_of(lane, o);
      double sum = 0.0;
      for (const double w : found) sum += w;
      for (std::size_t k = 0; k < found.size() && sum > 0.0; ++k) weights[k] += found[k] / sum;
    }
  }
  return weights;
}

}  // namespace

std::vector<double> direct_weights(const CellsOfView& x) {
  std::vector<double> found(x.cells.size());
  return mean_shares(x, kMostLooks, [&](std::size_t lane, const vec3& o) {
    for (std::size_t k = 0; k < found.size(); ++k) found[k] = weight_of(x, x.cells[k], lane, o);
    return found;
  });
}

std::vector<double> exchange_weights(const CellsOfView& x) {
  // Every patch of a fine raster against all of a coarse one.
  const double pairs = std::min(kMostPairs, kPairsOfViews / static_cast<double>(x.beams.views.size()));
  std::uint32_t fine = 1, coarse = 1;
  const auto count = [&](std::uint32_t side) { return std::pow(x.grid.cells / side, 2); };
  while (count(fine) * count(coarse) > pairs && fine < x.grid.cells) (coarse >= 4 * fine ? fine : coarse) *= 2;
  const std::vector<Patch> from = patches(x, fine), to = patches(x, coarse);
  const std::uint32_t n = x.grid.cells;
  std::vector<double> found(x.cells.size());
  return mean_shares(x, kExchangeLooks, [&](std::size_t lane, const vec3& o) {
    for (const Patch& p : from) {
      double sum = 0.0;
      for (const Patch& q : to) sum += exchanged(x, p, q, lane, o);
      for (std::uint32_t j = 0; j < fine; ++j) {
        for (std::uint32_t i = 0; i < fine; ++i) found[(p.v * fine + j) * n + p.u * fine + i] = sum;
      }
    }
    return found;
  });
}

}  // namespace clray
