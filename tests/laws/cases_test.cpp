// SPDX-License-Identifier: Apache-2.0
// Single cases of the law of the single run, against closed forms: bands and variants that share paths, backs, sheets
// in one place, light by way of mirrors, reflectances between the nodes of their table. C = F·c/E and A as in
// docs/results.md; every tolerance is 4 claimed standard errors and the rounding of the sums, unless it says more
// (over 400 lines: the cases of one law stay together).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "laws/records.hpp"
#include "reference/brdf.hpp"
#include "support/checks.hpp"

using namespace clray_test;
using clray::Material;
using clray::Scene;
using clray::Vec3;

namespace {

/// A sun in bands of 50 nm, the k-th from 400 + 100·k nm, named by k.
void in_bands(Scene& scene, const std::vector<int>& order) {
  scene.source.kind = clray::Source::Kind::sun;
  for (const int k : order) scene.source.bands.push_back({std::to_string(k), 400.0 + 100.0 * k, 450.0 + 100.0 * k});
}

/// A key's values in those bands.
clray::Spectrum by_band(const std::vector<double>& values) {
  clray::Spectrum s;
  for (std::size_t k = 0; k < values.size(); ++k) {
    s.wavelength_nm.insert(s.wavelength_nm.end(),
                           {400.0 + 100.0 * static_cast<double>(k), 450.0 + 100.0 * static_cast<double>(k)});
    s.value.insert(s.value.end(), {values[k], values[k]});
  }
  return s;
}

Material ggx(double roughness, double f0) {
  Material m;
  m.name = m.model = "ggx";
  m.parameters = {{"roughness", roughness}, {"f0", f0}};
  return m;
}

struct Reflected {
  double share = 0.0;
  Vec3 momentum{0.0};  ///< ∫ f μ_o ω_o dω_o
};

/// What a surface in z = 0 reflects of light from s, by a midpoint rule over the hemisphere (error about 10⁻⁵ of f
/// smooth).
Reflected reflected(const clray_reference::Material& m, const Vec3& s) {
  constexpr int kSteps = 500;
  const clray_reference::V3 n{0, 0, 1}, wi{s.x, s.y, s.z};
  Reflected r;
  for (int i = 0; i < kSteps; ++i) {
    const double theta = kPi / 2.0 * (i + 0.5) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const Vec3 o = toward(theta, 2.0 * kPi * (k + 0.5) / kSteps);
      const double f = static_cast<double>(clray_reference::reflect(m, n, wi, {o.x, o.y, o.z}));
      const double weight = f * o.z * std::sin(theta) * (kPi / 2.0 / kSteps) * (2.0 * kPi / kSteps);
      r.share += weight;
      r.momentum += weight * o;
    }
  }
  return r;
}

/// The same for Cook-Torrance with GGX (docs/surfaces.md), over half vectors: dω_o = 4 (o·h) dω_h. With tan θ_h =
/// α·tan x the distribution D is smooth in x.
Reflected reflected_ggx(double alpha, double f0, const Vec3& s) {
  constexpr int kSteps = 1500;
  const auto lambda = [&](double mu) { return std::sqrt(alpha * alpha + (1.0 - alpha * alpha) * mu * mu); };
  Reflected r;
  for (int i = 0; i < kSteps; ++i) {
    const double x = kPi / 2.0 * (i + 0.5) / kSteps, tangent = alpha * std::tan(x);
    const double theta = std::atan(tangent), c = std::cos(theta);
    const double slope = alpha / (std::cos(x) * std::cos(x)) / (1.0 + tangent * tangent);  // dθ/dx
    const double part = alpha * alpha * c * c + std::sin(theta) * std::sin(theta);
    const double density = alpha * alpha / (kPi * part * part);
    for (int k = 0; k < kSteps; ++k) {
      const Vec3 h = toward(theta, 2.0 * kPi * (k + 0.5) / kSteps);
      const double u = h.x * s.x + h.y * s.y + h.z * s.z;
      const Vec3 o = 2.0 * u * h - s;
      if (u <= 0.0 || o.z <= 0.0) continue;
      const double fresnel = f0 + (1.0 - f0) * std::pow(1.0 - u, 5);
      const double f = fresnel * density / (2.0 * (o.z * lambda(s.z) + s.z * lambda(o.z)));
      const double weight = f * o.z * 4.0 * u * std::sin(theta) * slope * (kPi / 2.0 / kSteps) * (2.0 * kPi / kSteps);
      r.share += weight;
      r.momentum += weight * o;
    }
  }
  return r;
}

/// A plate of 1 m² in z = 0, lit from s, under `pressure`.
Scene pressed_plate(const Material& m, const Vec3& s) {
  Scene scene = scene_of(plate_mesh(1, 1), m);
  monostatic(scene, s);
  detect(scene, "pressure");
  return rays(scene, 16);
}

/// Light of irradiance 1 on 1 m² hands over μ_i·(−s) and what leaves, −μ_i·∫ f μ_o ω_o dω_o.
void check_force(const clray::PressureResult& p, const Vec3& s, const Reflected& r, const std::string& what) {
  // The quadratures are good to 2·10⁻⁵.
  constexpr double kQuadrature = 2e-5;
  for (int k = 0; k < 3; ++k) {
    const double exact = -s.z * (s[k] + r.momentum[k]);
    INFO(what, ", axis ", k, ": ", p.coefficient_m2.value[k], " +- ", p.coefficient_m2.standard_error[k], ", exact ",
         exact);
    CHECK(std::fabs(p.coefficient_m2.value[k] - exact) <= 4.0 * p.coefficient_m2.standard_error[k] + kQuadrature);
    CHECK(std::fabs(p.coefficient_m2.value[k] - exact) <= 0.01);
  }
}

const clray::PressureResult& band_of(const clray::Result& result, int band) {
  for (const auto& p : result.pressure) {
    if (p.key.band == std::to_string(band)) return p;
  }
  FAIL("no result of band ", band);
  return result.pressure.at(0);
}

void check_near(double found, double error, double exact, double bound, const std::string& what) {
  INFO(what, ": ", found, " +- ", error, ", exact ", exact);
  CHECK(std::fabs(found - exact) <= 4.0 * error + 1e-9);
  CHECK(std::fabs(found - exact) <= bound);
}

/// Two sheets of 1 m² in z = 0 that look away from each other: `up` toward +z, `down` toward -z.
enum class Sheets { shapes, shapes_down_first, parts, one_mesh };
Scene back_to_back(const Material& up, const Material& down, Sheets how) {
  const std::map<std::string, double> size{{"size_x", 1.0}, {"size_y", 1.0}};
  if (how == Sheets::shapes || how == Sheets::shapes_down_first) {
    const bool first = how == Sheets::shapes;
    Scene scene = scene_of("rectangle", size, first ? up : down);
    add(scene, "rectangle", size, first ? down : up);
    clray::Transform& turned = scene.components[first ? 1 : 0].transform;
    turned.axis = {1, 0, 0};
    turned.angle_rad = kPi;
    return scene;
  }
  auto flipped = std::make_shared<clray::Mesh>(*plate_mesh(1, 1));
  for (auto& t : flipped->triangles) std::swap(t[1], t[2]);
  if (how == Sheets::parts) {
    Scene scene = scene_of(plate_mesh(1, 1), up);
    add(scene, flipped, down);
    return scene;
  }
  auto both = std::make_shared<clray::Mesh>(*plate_mesh(1, 1));
  both->material_slots = {"up", "down"};
  for (const auto& t : flipped->triangles) {
    both->triangles.push_back(t);
    both->triangle_slot.push_back(1);
  }
  Scene scene = scene_of(both, up);
  scene.materials.push_back(down);
  scene.materials.back().name = "down";
  scene.components[0].materials = {0, 1};
  return scene;
}

Material one_sided(double rho) {
  Material m = lambert(rho);
  m.two_sided = false;
  return m;
}

}  // namespace

TEST_CASE("bands share no direction that one of them never takes: a surface dark in its first band") {
  const Vec3 s = toward(0.7, 0.4);
  const std::vector<double> rho{0.0, 0.9, 0.3};
  std::vector<Reflected> exact;
  for (const double r : rho)
    exact.push_back(reflected({clray_reference::Material::Model::ashikhmin_shirley, r, 1, 20, 0, true}, s));
  for (const auto& order : {std::vector<int>{0, 1}, {1, 0}, {0, 1, 2}, {2, 1, 0}}) {
    Material m = ashikhmin_shirley(0.5, 1.0, 20);
    m.parameters["f0"] = 0.0;
    m.spectra["rho"] = by_band(rho);
    Scene scene = pressed_plate(m, s);
    in_bands(scene, order);
    const clray::Result result = run(scene);
    for (const int k : order)
      check_force(band_of(result, k), s, exact[static_cast<std::size_t>(k)], "band " + std::to_string(k));
  }
}

TEST_CASE("bands of one path differ in roughness") {
  const Vec3 s = toward(0.5, 2.0);
  const std::vector<double> roughness{0.1, 0.9, 0.4};
  for (const auto& order : {std::vector<int>{0, 1, 2}, {1, 0, 2}}) {
    Material m = ggx(0.3, 0.9);
    m.spectra["roughness"] = by_band(roughness);
    Scene scene = pressed_plate(m, s);
    in_bands(scene, order);
    const clray::Result result = run(scene);
    for (const int k : order)
      check_force(band_of(result, k), s, reflected_ggx(roughness[static_cast<std::size_t>(k)], 0.9, s),
                  "band " + std::to_string(k));
  }
}

TEST_CASE("the order of bands changes nothing at four bounces, and each band is itself alone") {
  const auto corner = [](const std::vector<int>& order) {
    Material m = ashikhmin_shirley(0.5, 1.0, 200);
    m.parameters["f0"] = 0.0;
    m.spectra["rho"] = by_band({0.0, 0.9});
    Scene scene = scene_of(plate_mesh(1, 1), m);
    add(scene, plate_mesh(1, 1), m).transform = {{-0.5, 0, 0.5}, {0, 1, 0}, kPi / 2.0, 1.0};
    bistatic(scene, toward(0.8, 0.2), toward(0.6, -0.4));
    detect(scene, "spectrometer");
    scene.trace.max_bounces = 4;
    in_bands(scene, order);
    return rays(scene, 18);
  };
  for (const int k : {0, 1}) {
    const auto only = run(corner({k})).spectrometer.at(0).intensity_m2_per_sr;
    for (const auto& order : {std::vector<int>{0, 1}, {1, 0}}) {
      Scene both = corner(order);
      for (const auto& found : run(rays(both, 18, 2)).spectrometer) {
        if (found.key.band != std::to_string(k)) continue;
        const double error = std::hypot(only.standard_error, found.intensity_m2_per_sr.standard_error);
        INFO("band ", k, ": ", found.intensity_m2_per_sr.value, ", alone ", only.value, " +- ", error);
        CHECK(std::fabs(found.intensity_m2_per_sr.value - only.value) <= 4.0 * error + 1e-9);
        CHECK(error <= 0.02 * only.value);
      }
    }
  }
}

namespace {

/// A floor of 2 x 2 m in z = 0 and a Lambert wall of 2 x 2 m on its edge x = -1, looking to +x; light from s in the
/// plane y = 0, view from o along the floor, so that nothing is seen in it.
Scene floor_and_wall(const Material& floor, double rho, const Vec3& s, const Vec3& o) {
  Scene scene = scene_of(plate_mesh(2, 2), floor);
  add(scene, plate_mesh(2, 2), lambert(rho)).transform = {{-1, 0, 1}, {0, 1, 0}, kPi / 2.0, 1.0};
  bistatic(scene, s, o);
  scene.trace.max_bounces = 3;
  return rays(scene, 18);
}

/// What the wall sends to o. A mirror floor lights the wall once more, up to the height 2 s_z/s_x that its reflection
/// reaches: A = (rho/π)·s_x·o_x·∫∫ (1 + lit) dy dz.
double wall_intensity(double rho, const Vec3& s, const Vec3& o, bool mirror_floor) {
  const double lit = mirror_floor ? std::min(2.0, 2.0 * s.z / s.x) : 0.0;
  return rho / kPi * s.x * o.x * 2.0 * (2.0 + lit);
}

/// The sum of a picture's pixels in a variant, or of all.
const Record picture_of(const clray::Result& result, const Scene& scene, const std::string& variant) {
  for (const auto& [name, r] : records_of(result, scene)) {
    if (r.kind == "picture" && (variant.empty() || name.find("/" + variant + "/") != std::string::npos)) return r;
  }
  FAIL("no picture of variant ", variant);
  return {};
}

}  // namespace

TEST_CASE("variants of one picture: a mirror, a black and a white floor, in any order") {
  const Vec3 s = toward(0.9), o(0.8, -0.6, 0.0);
  const auto named = [](Material m) {
    m.name = "lambert0";
    return m;
  };
  const std::vector<clray::Variant> variants{
      {"mirror", {named(mirror(1.0))}}, {"black", {named(lambert(0.0))}}, {"white", {named(lambert(1.0))}}};
  for (const auto& order : {std::vector<int>{0, 1, 2}, {2, 1, 0}, {1, 0, 2}}) {
    Scene scene = floor_and_wall(lambert(0.5), 0.5, s, o);
    for (const int v : order) scene.variants.push_back(variants[static_cast<std::size_t>(v)]);
    detect(scene, "hyperspectral", {{"width", 32.0}, {"height", 32.0}, {"samples", 128.0}});
    scene.detectors.push_back({"spectrometer", "beam", {}});
    const clray::Result result = run(scene);
    for (const auto& beam : result.spectrometer) {
      const Record found = picture_of(result, scene, beam.key.variant);
      INFO("variant ", beam.key.variant);
      if (beam.key.variant != "white") {
        const double exact = wall_intensity(0.5, s, o, beam.key.variant == "mirror");
        check_near(beam.intensity_m2_per_sr.value, beam.intensity_m2_per_sr.standard_error, exact, 0.02 * exact,
                   "beam");
        check_near(found.value, found.error, exact, 0.02 * exact, "picture");
      }
      // The white floor's own light has no closed form here: the beam traces it the other way round.
      const double error = std::hypot(found.error, beam.intensity_m2_per_sr.standard_error);
      if (beam.key.variant == "white") check_near(found.value, error, beam.intensity_m2_per_sr.value, 0.02, "picture");
    }
  }
}

TEST_CASE("a wall lit by way of a mirror is as bright in a picture as under the other detectors") {
  const Vec3 s = toward(kPi / 4.0), o(0.8, -0.6, 0.0);
  Scene scene = floor_and_wall(mirror(1.0), 1.0, s, o);
  detect(scene, "hyperspectral", {{"width", 32.0}, {"height", 32.0}, {"samples", 128.0}});
  scene.detectors.push_back({"delay", "delay", {}});
  const clray::Result result = run(scene);
  const double exact = wall_intensity(1.0, s, o, true);
  const auto& beam = result.delay.at(0).intensity_m2_per_sr;
  check_near(beam.value, beam.standard_error, exact, 0.02 * exact, "delay");
  const Record found = picture_of(result, scene, "");
  check_near(found.value, found.error, exact, 0.02 * exact, "picture");
}

TEST_CASE("variants differ in their backs alone, in any order, under every detector") {
  for (const bool back_first : {false, true}) {
    Scene scene = scene_of(plate_mesh(1, 1), lambert(0.5));
    monostatic(scene, {0, 0, -1});
    scene.variants = {{"both", {scene.materials[0]}}, {"front", {scene.materials[0]}}};
    scene.variants[1].materials[0].two_sided = false;
    if (back_first) std::swap(scene.variants[0], scene.variants[1]);
    scene.detectors = {{"delay", "delay", {}},
                       {"spectrometer", "spectrometer", {}},
                       {"pressure", "pressure", {}},
                       {"hyperspectral", "picture", {{"width", 8.0}, {"height", 8.0}}}};
    for (const int bounces : {1, 2}) {
      scene.trace.max_bounces = bounces;
      const clray::Result result = run(rays(scene, 14));
      for (const auto& one : records_of(result, scene)) {
        const auto& name = one.first;
        const auto& r = one.second;
        const bool lit = name.find("/both/") != std::string::npos;
        INFO(name, " at ", bounces, " bounces");
        // Seen from behind: rho/π and push 1 + 2 rho/3 where both sides reflect, else nothing and 1.
        if (name.find("/intensity") != std::string::npos)
          check_near(r.value, r.error, lit ? 0.5 / kPi : 0.0, 1e-4, name);
        if (name.find("/force.z") != std::string::npos) check_near(r.value, r.error, lit ? 4.0 / 3.0 : 1.0, 2e-3, name);
      }
    }
  }
}

TEST_CASE("of sheets in one place the one whose lit side looks at the ray is met") {
  for (const Sheets how : {Sheets::shapes, Sheets::shapes_down_first, Sheets::parts, Sheets::one_mesh}) {
    for (const bool sided : {false, true}) {
      for (const double z : {1.0, -1.0}) {
        Scene scene = back_to_back(sided ? one_sided(0.2) : lambert(0.2), sided ? one_sided(0.8) : lambert(0.8), how);
        monostatic(scene, {0, 0, z});
        const auto& found = run(rays(scene, 14)).delay.at(0).intensity_m2_per_sr;
        CAPTURE(static_cast<int>(how));
        CAPTURE(sided);
        CAPTURE(z);
        check_near(found.value, found.standard_error, (z > 0.0 ? 0.2 : 0.8) / kPi, 1e-6, "intensity");
      }
    }
  }
}

TEST_CASE("light pushes the sheet that it meets, and shadows are of both sheets") {
  for (const Sheets how : {Sheets::shapes, Sheets::parts, Sheets::one_mesh}) {
    CAPTURE(static_cast<int>(how));
    Scene scene = back_to_back(one_sided(0.0), one_sided(1.0), how);
    monostatic(scene, {0, 0, -1});
    detect(scene, "pressure");
    const auto& white = run(rays(scene, 14)).pressure.at(0).coefficient_m2;
    check_near(white.value.z, white.standard_error.z, 5.0 / 3.0, 0.01, "white side");
    monostatic(scene, {0, 0, 1});
    const auto& black = run(scene).pressure.at(0).coefficient_m2;
    check_near(black.value.z, black.standard_error.z, -1.0, 1e-6, "black side");
    // Nothing of one side is seen from the other.
    bistatic(scene, {0, 0, -1}, {0, 0, 1});
    detect(scene, "spectrometer");
    CHECK(run(scene).spectrometer.at(0).intensity_m2_per_sr.value == 0.0);
  }
}

TEST_CASE("no word of missing hits beside a picture, a force or a bright member of the run") {
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  bistatic(scene, toward(kPi / 4.0, kPi / 2.0), {0, 0, 1});
  scene.trace.max_bounces = 2;
  rays(scene, 14);
  for (const char* kind : {"rgb", "pressure", "spectrometer"}) {
    detect(scene, kind);
    if (std::string(kind) == "rgb") scene.detectors[0].parameters = {{"width", 16.0}, {"height", 16.0}};
    CAPTURE(kind);
    CHECK_FALSE(warns(run(scene), "all results are zero"));
  }
  // Dark it is where nothing that was lit is seen.
  bistatic(scene, {0, 0, -1}, {0, 0, 1});
  CHECK(warns(run(scene), "all results are zero"));
}

TEST_CASE("a smooth metal grazed: what it does not reflect it absorbs") {
  for (const auto& one : {std::pair<double, double>{0.05, 0.02}, {0.01, 0.006}, {0.003, 0.002}, {0.3, 0.4}}) {
    const auto& roughness = one.first;
    const auto& mu = one.second;
    const Vec3 s(std::sqrt(1.0 - mu * mu), 0.0, mu);
    const clray::Result result = run(pressed_plate(ggx(roughness, 0.9), s));
    const double exact = mu * (1.0 - reflected_ggx(roughness, 0.9, s).share);
    INFO("roughness ", roughness, ", mu ", mu);
    const auto& found = result.pressure.at(0).absorbed_m2;
    // 1e-4 of what arrives: what a table of reflectances is made for (docs/surfaces.md).
    INFO("absorbed ", found.value / mu, " of 1, exact ", exact / mu);
    CHECK(std::fabs(found.value - exact) <= 4.0 * found.standard_error + 1e-4 * mu);
  }
}

TEST_CASE("a step in a tabulated surface is where the table has it") {
  Material m;
  m.name = m.model = "tabulated";
  auto table = std::make_shared<clray::BrdfTable>();
  table->theta_i_rad = {0.0, radians(44.9), radians(45.1), radians(90.0)};
  table->theta_o_rad = {0.0, radians(90.0)};
  table->phi_rad = {0.0, kPi};
  for (const double f : {0.3, 0.3, 0.02, 0.02}) table->value.insert(table->value.end(), 4, f);
  m.table = table;
  for (const double degrees : {30.0, 44.5, 44.8, 44.95, 45.05, 45.2, 45.6, 50.0}) {
    const double f = degrees <= 44.9 ? 0.3 : degrees >= 45.1 ? 0.02 : 0.3 - 0.28 * (degrees - 44.9) / 0.2;
    const Vec3 s = toward(radians(degrees));
    Scene scene = pressed_plate(m, s);
    scene.detectors[0].parameters["thermal"] = 1.0;
    const clray::Result result = run(scene);
    // The same f everywhere over the table's other angles reflects π·f of the light, and as Lambert does.
    const double mu = s.z, absorbed = mu * (1.0 - kPi * f);
    const auto& p = result.pressure.at(0);
    CAPTURE(degrees);
    INFO("absorbed ", p.absorbed_m2.value, ", exact ", absorbed);
    CHECK(std::fabs(p.absorbed_m2.value - absorbed) <= 4.0 * p.absorbed_m2.standard_error + 1e-4 * mu);
    // Reflected and radiated light both leave with 2/3 of their momentum along the normal.
    const double push = -mu * (mu + 2.0 / 3.0);
    INFO("force ", p.coefficient_m2.value.z, " +- ", p.coefficient_m2.standard_error.z, ", exact ", push);
    CHECK(std::fabs(p.coefficient_m2.value.z - push) <= 4.0 * p.coefficient_m2.standard_error.z + 1e-4 * mu);
  }
}
