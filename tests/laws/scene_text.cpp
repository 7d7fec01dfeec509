// SPDX-License-Identifier: Apache-2.0
// See scene_text.hpp.
#include "laws/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "laws/generator.hpp"
#include "scene/tables.hpp"
#include "support/scenes.hpp"

namespace clray_test {

using clray::Scene;
using clray::TableKey;
using clray::Vec3;

namespace {

std::string number(double v) {
  return fmt::format("{:.17g}", v);
}
std::string vector(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", number(v.x), number(v.y), number(v.z));
}
std::string degrees(double radians) {
  return number(radians / kPi * 180.0);
}

class Text {
 public:
  Text(const Scene& scene, const std::string& folder) : scene_(scene), folder_(folder) {
    std::filesystem::create_directories(folder);
  }

  std::string write() {
    line("# clray --device cpu --no-plots {}/scene.toml", folder_);
    line("reference_point = {}", vector(scene_.reference_point));
    for (const clray::Material& m : scene_.materials) {
      line("[[material]]");
      line("name = \"{}\"", m.name);
      material(m);
    }
    for (const clray::Component& c : scene_.components) component(c);
    for (const clray::Variant& v : scene_.variants) {
      line("[[variant]]\nname = \"{}\"", v.name);
      for (const clray::Material& m : v.materials) {
        line("[[variant.material]]\nname = \"{}\"", m.name);
        material(m);
      }
    }
    source();
    for (const clray::Observer& o : scene_.observers) observer(o);
    if (scene_.motion) motion(*scene_.motion);
    if (scene_.pass) pass(*scene_.pass);
    if (scene_.station) station(*scene_.station);
    for (const clray::DetectorSpec& d : scene_.detectors) {
      line("[[detector]]\nkind = \"{}\"\nname = \"{}\"", d.kind, d.name);
      keys("detector", d.kind, d.parameters);
    }
    const clray::TraceOptions& t = scene_.trace;
    constexpr const char* kSamplers[] = {"random", "sobol", "strata"};
    line("[trace]\nmax_bounces = {}\nseed = {}\nsampler = \"{}\"", t.max_bounces, t.seed,
         kSamplers[static_cast<int>(t.sampler)]);
    if (t.rays > 0) line("rays = {}", t.rays);
    std::ofstream(folder_ + "/scene.toml") << text_;
    return text_;
  }

 private:
  template <class... Args>
  void line(const char* format, const Args&... args) {
    text_ += fmt::format(fmt::runtime(format), args...) + "\n";
  }

  std::string file(const std::string& extension, const std::string& content) {
    const std::string name = fmt::format("file{}.{}", files_++, extension);
    std::ofstream(folder_ + "/" + name) << content;
    return name;
  }
  std::string spectrum(const clray::Spectrum& s, const std::string& column) {
    std::string rows = "wavelength_nm," + column + "\n";
    for (std::size_t i = 0; i < s.value.size(); ++i)
      rows += number(s.wavelength_nm[i]) + "," + number(s.value[i]) + "\n";
    return file("csv", rows);
  }

  void keys(const char* kind, const std::string& row, const std::map<std::string, double>& parameters) {
    for (const TableKey& key : clray::table_row(kind, row).keys) {
      const auto given = parameters.find(key.name);
      if (given == parameters.end()) continue;
      line("{} = {}", key.name,
           key.is_switch ? std::string(given->second != 0.0 ? "true" : "false") : number(given->second));
    }
  }

  void material(const clray::Material& m) {
    line("model = \"{}\"", m.model);
    std::map<std::string, double> numbers = m.parameters;
    for (const auto& [key, s] : m.spectra) {
      line("{} = \"{}\"", key, spectrum(s, "value"));
      numbers.erase(key);
    }
    keys("brdf", m.model, numbers);
    line("two_sided = {}", m.two_sided);
    line("infrared_reflectance = {}", number(m.infrared_reflectance));
    if (!m.table) return;
    const clray::BrdfTable& t = *m.table;
    std::string rows = "theta_i_deg,theta_o_deg,phi_deg,value\n";
    std::size_t at = 0;
    for (const double i : t.theta_i_rad) {
      for (const double o : t.theta_o_rad) {
        for (const double p : t.phi_rad)
          rows += fmt::format("{},{},{},{}\n", degrees(i), degrees(o), degrees(p), number(t.value[at++]));
      }
    }
    line("file = \"{}\"", file("csv", rows));
  }

  void component(const clray::Component& c) {
    line("[[component]]\nname = \"{}\"\nshape = \"{}\"", c.name, c.shape);
    keys("shape", c.shape, c.parameters);
    if (c.mesh) {
      line("file = \"{}\"", mesh(*c.mesh));
      std::string map;
      for (std::size_t s = 0; s < c.materials.size(); ++s) {
        if (uses(*c.mesh, s))
          map += fmt::format("{}slot{} = \"{}\"", map.empty() ? "" : ", ", s, scene_.materials[c.materials[s]].name);
      }
      line("materials = {{ {} }}", map);
    } else {
      line("material = \"{}\"", scene_.materials[c.materials[0]].name);
    }
    const clray::Transform& t = c.transform;
    line("transform = {{ translate = {}, axis = {}, angle_deg = {}, scale = {} }}", vector(t.translate), vector(t.axis),
         degrees(t.angle_rad), number(t.scale));
    if (!c.hinge) return;
    const char* follow[] = {"none", "source", "observer"};
    line("hinge = {{ axis = {}, point = {}, angle_deg = {}, follow = \"{}\" }}", vector(c.hinge->axis),
         vector(c.hinge->point), degrees(c.hinge->angle_rad), follow[static_cast<int>(c.hinge->follow)]);
  }

  static bool uses(const clray::Mesh& m, std::size_t slot) {
    return std::find(m.triangle_slot.begin(), m.triangle_slot.end(), slot) != m.triangle_slot.end();
  }

  std::string mesh(const clray::Mesh& m) {
    std::string rows;
    for (const Vec3& v : m.vertices) rows += fmt::format("v {} {} {}\n", number(v.x), number(v.y), number(v.z));
    for (std::size_t s = 0; s < m.material_slots.size(); ++s) {
      if (uses(m, s)) rows += fmt::format("usemtl slot{}\n", s);
      for (std::size_t k = 0; k < m.triangles.size(); ++k) {
        const auto& t = m.triangles[k];
        if (m.triangle_slot[k] == s) rows += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
      }
    }
    return file("obj", rows);
  }

  void source() {
    const clray::Source& s = scene_.source;
    const bool sun = s.kind == clray::Source::Kind::sun;
    line("[source]\nkind = \"{}\"\ndirection = {}", sun ? "sun" : "laser",
         s.toward == clray::Toward::sun ? "\"sun\"" : vector(s.direction));
    if (!sun) return line("wavelength_nm = {}", number(s.wavelength_nm));
    if (s.spectrum) line("spectrum = \"{}\"", spectrum(*s.spectrum, "value"));
    if (!s.spectrum) line("irradiance_W_m2 = {}", number(s.irradiance_W_m2));
    if (!s.spectrum && s.blackbody_K > 0.0) line("blackbody_K = {}", number(s.blackbody_K));
    std::string list;
    for (const clray::Band& b : s.bands) {
      list += list.empty() ? "" : ", ";
      list += b.response
                  ? fmt::format("{{ file = \"{}\", name = \"{}\" }}", spectrum(*b.response, "transmission"), b.name)
                  : fmt::format("{{ low_nm = {}, high_nm = {}, name = \"{}\" }}", number(b.low_nm), number(b.high_nm),
                                b.name);
    }
    if (!list.empty()) line("bands = [{}]", list);
  }

  void observer(const clray::Observer& o) {
    const bool site = o.toward == clray::Toward::site;
    line("[[observer]]\nname = \"{}\"\n{} = {}", o.name, site ? "ecef_m" : "direction",
         site           ? vector(o.site_m)
         : o.monostatic ? "\"source\""
                        : vector(o.direction));
    line("acceptance_mrad = {}", number(o.acceptance_rad * 1e3));
    if (o.range_m > 0.0) line("range_m = {}", number(o.range_m));
  }

  void motion(const clray::Motion& m) {
    line("[motion]\nstart_s = {}\nstop_s = {}", number(m.start_s), number(m.stop_s));
    if (m.attitudes.empty()) {
      line("axis = {}\nperiod_s = {}\nphase_deg = {}\nstep_deg = {}", vector(m.axis), number(m.period_s),
           degrees(m.phase_rad), degrees(m.step_rad));
      return;
    }
    attitudes(m.attitudes);
  }

  void attitudes(const std::vector<clray::Attitude>& list) {
    std::string rows = "time_s,qw,qx,qy,qz\n";
    for (const clray::Attitude& a : list) {
      const auto& q = a.body_to_space;
      rows += fmt::format("{},{},{},{},{}\n", number(a.time_s), number(q.w), number(q.x), number(q.y), number(q.z));
    }
    line("attitudes = \"{}\"", file("csv", rows));
  }

  void pass(const clray::Pass& p) {
    std::string times = "time_s\n";
    for (const double t : p.times_s) times += number(t) + "\n";
    line("[pass]\nstart_mjd = {}.75\naberration = {}\nmin_elevation_deg = -90", p.start.mjd, p.aberration);
    line("ephemeris = \"{}\"\ntimes = \"{}\"\n[pass.attitude]", file("csv", kOrbitStates), file("csv", times));
    const clray::PassAttitude& a = p.attitude;
    if (!a.attitudes.empty()) return attitudes(a.attitudes);
    line("law = \"spin\"\nspin = {{ axis = {}, period_s = {}, phase_deg = {}, frame = \"{}\" }}", vector(a.spin_axis),
         number(a.spin_period_s), degrees(a.spin_phase_rad), a.spin_in_orbit_frame ? "orbit" : "gcrf");
  }

  void station(const clray::Station& s) {
    line("[station]\npulse_fwhm_ps = {}", number(s.pulse_fwhm_s * 1e12));
    if (s.ranges.empty()) return line("range_m = {}", number(s.range_m));
    std::string rows = "time_s,range_m\n";
    for (const auto& [time, range] : s.ranges) rows += number(time) + "," + number(range) + "\n";
    line("ranges = \"{}\"", file("csv", rows));
  }

  const Scene& scene_;
  std::string folder_, text_;
  int files_ = 0;
};

}  // namespace

std::string write_scene(const Scene& scene, const std::string& folder) {
  return Text(scene, folder).write();
}

}  // namespace clray_test
