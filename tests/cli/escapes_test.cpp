// SPDX-License-Identifier: Apache-2.0
// Words of files and of the command line that hold escapes of a terminal: none reaches the terminal or a text file raw,
// whichever way it comes in. The escapes: ESC and BEL (C0), DEL, CSI (C1, U+009B), a mark that turns the direction of
// writing (U+202E), a byte that is not UTF-8.
#include <doctest/doctest.h>

#include <filesystem>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

const std::string kEvil = "p\x1b[31m\x07q\x7f\xc2\x9br\xe2\x80\xaes\xff";
const std::string kValid = kEvil.substr(0, kEvil.size() - 1);  // what JSON, TOML and file systems take as UTF-8

/// The first hidden character of a text, as its place and byte, or "".
std::string raw_escape(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const bool control = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f || c == 0xff;
    const bool c1 = c == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
    if (control || c1 || text.compare(i, 3, "\xe2\x80\xae") == 0)
      return "byte " + std::to_string(c) + " after \"" + text.substr(i < 30 ? 0 : i - 30, i < 30 ? i : 30) + "\"";
  }
  return "";
}

const std::string kBall = "[[component]]\nshape = \"sphere\"\n";

struct Way {
  std::string name;
  std::vector<std::pair<std::string, std::string>> files;
  std::vector<std::string> arguments;
};

std::string square_of(const std::string& material) {
  return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl " + material + "\nf 1 2 3 4\n";
}

Way scene_way(const std::string& name, const std::string& text) {
  return {name, {{"s.toml", text}}, {"--check", "s.toml"}};
}

Way table_way(const std::string& name, const std::string& section, const std::string& table) {
  return {name, {{"s.toml", kBall + section + " = \"t.csv\"\n"}, {"t.csv", table}}, {"--check", "s.toml"}};
}

std::vector<Way> ways() {
  const std::string quoted = "\"p\\u001b[31m\\u0007\\u009b\\u202E\"";
  return {
      {"usemtl", {{"m.obj", square_of(kEvil)}}, {"--check", "m.obj"}},
      {"mtllib", {{"m.obj", "mtllib " + kEvil + ".mtl\n" + square()}}, {"--check", "m.obj"}},
      {"newmtl",
       {{"m.obj", "mtllib m.mtl\n" + square_of(kEvil)}, {"m.mtl", "newmtl " + kEvil + "\nKd 2 2 2\n"}},
       {"--check", "m.obj"}},
      {"MTL value",
       {{"m.obj", "mtllib m.mtl\n" + square()}, {"m.mtl", "newmtl m\nKd " + kEvil + "\n"}},
       {"--check", "m.obj"}},
      {"OBJ statement", {{"m.obj", kEvil + "\n" + square()}}, {"--check", "m.obj"}},
      {"OBJ number", {{"m.obj", "v 0 0 " + kEvil + "\n"}}, {"--check", "m.obj"}},
      {"OBJ corner", {{"m.obj", "v 0 0 0\nf 1 " + kEvil + " 1\n"}}, {"--check", "m.obj"}},
      {"PLY header",
       {{"m.ply", "ply\nformat ascii 1.0\n" + kEvil + "\nelement vertex 1\nend_header\n"}},
       {"--check", "m.ply"}},
      {"OFF number", {{"m.off", "OFF\n3 1 0\n0 0 " + kEvil + "\n"}}, {"--check", "m.off"}},
      {"STL word", {{"m.stl", "solid x\nfacet normal 0 0 1\nouter " + kEvil + "\n"}}, {"--check", "m.stl"}},
      {"mesh's name", {{kEvil + ".obj", square()}}, {"--check", kEvil + ".obj"}},
      {"missing file", {}, {"--check", kEvil + ".obj"}},
      {"extension", {{"m." + kEvil, "x"}}, {"--check", "m." + kEvil}},
      {"scene's name", {{kEvil + ".toml", kBall}}, {"--check", kEvil + ".toml"}},
      scene_way("TOML key", kBall + quoted + " = 1\n"),
      scene_way("TOML header", kBall + "[" + quoted + "]\n"),
      scene_way("TOML name", kBall + "name = " + quoted + "\n"),
      scene_way("TOML choice", "[[component]]\nshape = " + quoted + "\n"),
      scene_way("TOML material", kBall + "material = " + quoted + "\n"),
      scene_way("TOML file", "[[component]]\nshape = \"mesh\"\nfile = " + quoted + "\n"),
      {"TOML slot",
       {{"s.toml", "[[component]]\nshape = \"mesh\"\nfile = \"m.obj\"\nmaterials = { " + quoted + " = \"a\" }\n"},
        {"m.obj", square_of(kEvil)}},
       {"--check", "s.toml"}},
      scene_way("TOML text for a number", "[[component]]\nshape = \"sphere\"\nradius = " + quoted + "\n"),
      scene_way("no TOML", "a = " + kValid + "\n"),
      scene_way("not UTF-8", "a = \"" + kEvil + "\"\n"),
      scene_way("station", kBall + "[station]\nname = " + quoted + "\n"),
      scene_way("observer", kBall + "[observer]\nname = " + quoted + "\n"),
      scene_way("band",
                kBall + "[source]\nkind = \"sun\"\nbands = [{ low_nm = 1, high_nm = 2, name = " + quoted + " }]\n"),
      table_way("CSV column", "[station]\nranges", "time_s," + kEvil + "\n1,2\n"),
      table_way("CSV number", "[station]\nranges", "time_s,range_m\n1," + kEvil + "\n"),
      table_way("CSV comment", "[station]\nranges", "# time_s," + kEvil + "\n1,2\n"),
      table_way("CPF", "[station]\nposition_m = [6e6, 0, 0]\ncpf", "H1 CPF  2  " + kEvil + "\n" + kEvil + "\n"),
      {"detector", {{"m.obj", square()}}, {"--detector", kEvil, "m.obj"}},
      {"option", {}, {"--" + kEvil}},
      {"option's value", {{"m.obj", square()}}, {"--rays", kEvil, "m.obj"}},
      {"material option", {{"m.obj", square()}}, {"--material", kEvil, "m.obj"}},
      {"material's file", {{"m.obj", square()}}, {"--material", "lambert rho=" + kEvil + ".csv", "m.obj"}},
      {"reference", {{"m.obj", square()}, {kEvil, "{\"a\":1}"}}, {"--reference", kEvil, "m.obj"}},
      {"output folder", {{"m.obj", square()}, {kEvil, "a file"}}, {"--out", kEvil, "m.obj"}},
      {"list", {}, {"--list", kEvil}},
      {"device", {{"m.obj", square()}}, {"--device", kEvil, "m.obj"}},
  };
}

}  // namespace

TEST_CASE("escapes: whatever way they come in, the terminal does not get them") {
  for (const Way& way : ways()) {
    CAPTURE(way.name);
    const Scratch scratch;
    for (const auto& [name, text] : way.files) spit(scratch / name, text);
    const Outcome outcome = clray(scratch, way.arguments);
    CHECK(outcome.status >= 0);
    CHECK(outcome.status <= 5);
    CHECK(outcome.out.size() + outcome.err.size() > 0);
    CHECK(raw_escape(outcome.out) == "");
    CHECK(raw_escape(outcome.err) == "");
  }
}

TEST_CASE("escapes: a run whose mesh, scene and folder are called like one writes none into its text files") {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / kEvil);
  const std::string folder = kEvil + "/";
  spit(scratch / (folder + "m.obj"), "mtllib m.mtl\n" + square_of(kEvil));
  spit(scratch / (folder + "m.mtl"), "newmtl " + kEvil + "\nKd 2 2 2\n");
  spit(scratch / (folder + kEvil + ".toml"),
       "[[component]]\nshape = \"mesh\"\nfile = \"m.obj\"\n[source]\nkind = \"laser\"\n[station]\nrate_Hz = "
       "10\n[motion]\n"
       "axis = [0, 1, 0]\nperiod_s = 10\nstop_s = 1\nstep_deg = 36\n[[detector]]\nkind = \"delay\"\nbins = 16\n"
       "[[detector]]\nkind = \"rgb\"\nwidth = 8\nheight = 8\nsamples = 1\n[[detector]]\nkind = \"hyperspectral\"\n"
       "width = 4\nheight = 4\nsamples = 1\n");
  const Outcome outcome = clray(scratch, {"--rays", "2^10", "--out", folder + "out" + kEvil, folder + kEvil + ".toml"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(raw_escape(outcome.out) == "");
  CHECK(raw_escape(outcome.err) == "");
  int texts = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scratch / (folder + "out" + kEvil))) {
    const std::string name = entry.path().filename().string(), text = slurp(entry.path().string());
    CAPTURE(name);
    CHECK(raw_escape(name) == "");
    const std::string kind = entry.path().extension().string();
    if (kind == ".csv" || kind == ".json" || kind == ".crd") {
      ++texts;
      CHECK(raw_escape(text) == "");
    }
    // Binary files: what was escaped is there in letters, and the escape itself is not.
    CHECK(text.find("p\x1b[31m") == std::string::npos);
    CHECK(text.find("\xc2\x9br") == std::string::npos);
  }
  CHECK(texts >= 4);
}
