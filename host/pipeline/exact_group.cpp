// SPDX-License-Identifier: Apache-2.0
// See exact_group.hpp.
#include "pipeline/exact_group.hpp"

#include <algorithm>

#include "body/portable_tables.hpp"

namespace clray {
namespace {

class GroupMaker {
 public:
  GroupMaker(const PassPlan& plan, const Geometry& geometry, const std::vector<Sight>& sights)
      : plan_(plan), geometry_(geometry), sights_(sights) {}

  void add_view(const Sight& sight, std::size_t v, Group* group) const {
    const ClrayView& view = plan_.beams.views[v];
    const vec3 source = v3_load(view.toward);
    group->beams.push_back(beam_faces(
        geometry_, plan_.materials, plan_.motions[v],
        {direction_of(sight, v), source, v3_load(plan_.constants.reference), static_cast<std::uint32_t>(v)}));
    const BeamFaces& beam = group->beams.back();
    group->offsets.push_back(group->on_device.faces.size());
    const std::size_t lanes = plan_.request.lanes.size();
    const bool seen = !sight.connections.empty();
    for (std::size_t k = 0; k < beam.faces.size(); ++k) {
      ClrayFace face = beam.faces[k];
      face.bin_scale = view.weight_scale / plan_.beams.area_m2[v];
      const bool solved = !plan_.unsolved.has(v, beam.origins[k].primitive);
      face.carried = solved && is_source(sights_, sight) && wanted_elsewhere(beam, k, v) ? 1u : 0u;
      group->on_device.faces.push_back(face);
      for (std::size_t l = 0; l < lanes; ++l)
        group->on_device.weights.push_back(seen && solved ? weight(beam, k, l, source, beam.toward) : 0.0);
    }
  }

 private:
  vec3 direction_of(const Sight& sight, std::size_t v) const {
    if (is_source(sights_, sight)) return v3_load(plan_.beams.views[v].toward);
    return v3_load(plan_.beams.connections[v * plan_.traits.connections + sight.connection()].direction);
  }

  /// Radiant intensity over irradiance of a face in a lane, per area across its beam: f·mu_i of a beam toward the
  /// observer, and in that of the source f·mu_o, which is the same where both are one.
  double weight(const BeamFaces& beam, std::size_t face, std::size_t lane, const vec3& source, const vec3& to) const {
    const FaceOrigin& origin = beam.origins[face];
    const vec3 n = v3_load(beam.faces[face].normal);
    const double mu_i = v3_dot(n, source), mu_o = v3_dot(n, to);
    if (!origin.lit || !plan_.traits.connect || !(mu_i > 0.0) || !(mu_o > 0.0)) return 0.0;
    const double f_mu_o =
        surface_weight(plan_.materials.of(lane, origin.material), plan_.materials.tables, n, source, to);
    const bool monostatic = mu_i == mu_o;
    return monostatic ? f_mu_o : f_mu_o * (mu_i / mu_o);
  }

  /// Whether an observer elsewhere may see a lit face.
  bool wanted_elsewhere(const BeamFaces& beam, std::size_t face, std::size_t v) const {
    for (std::size_t s = 1; s < sights_.size(); ++s) {
      const vec3 to = direction_of(sights_[s], v);
      for (std::size_t l = 0; l < plan_.request.lanes.size(); ++l) {
        if (weight(beam, face, l, beam.toward, to) != 0.0) return true;
      }
    }
    return false;
  }

  const PassPlan& plan_;
  const Geometry& geometry_;
  const std::vector<Sight>& sights_;
};

}  // namespace

bool Group::shines(std::size_t face) const {
  const std::size_t lanes = on_device.weights.size() / on_device.faces.size();
  const double* weights = on_device.weights.data() + face * lanes;
  return std::any_of(weights, weights + lanes, [](double w) { return w != 0.0; });
}

Group group_of(const PassPlan& plan, const Geometry& geometry, const std::vector<Sight>& sights, const Sight& sight,
               std::size_t first, std::size_t end) {
  Group group;
  group.first_view = first;
  group.on_device.binnings = sight.binnings;
  group.on_device.seen = !is_source(sights, sight);
  const GroupMaker maker(plan, geometry, sights);
  for (std::size_t v = first; v < end; ++v) maker.add_view(sight, v, &group);
  return group;
}

VisibleFace visible_face(const ClrayFace& face, const i64* sums) {
  const double area = 1.0 / face.area_scale, length = area / face.inv_length, path = area / face.inv_path;
  const auto number = [&](int k) { return static_cast<double>(sums[k]); };
  VisibleFace v;
  v.area_m2 = number(CLRAY_FACE_AREA) * area;
  v.x_m3 = number(CLRAY_FACE_X) * length;
  v.y_m3 = number(CLRAY_FACE_Y) * length;
  v.path_m3 = number(CLRAY_FACE_PATH) * path;
  v.path2_m4 = number(CLRAY_FACE_PATH2) * path / face.inv_path;
  v.rounding_m2 = (number(CLRAY_FACE_LOST) + number(CLRAY_FACE_PIECES)) * area;
  return v;
}

}  // namespace clray
