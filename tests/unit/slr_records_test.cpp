// SPDX-License-Identifier: Apache-2.0
// CRD files: what is written reads back, and what the strict reader refuses.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "clray/error.hpp"
#include "slr/crd.hpp"

using namespace clray;
using namespace clray::slr;

namespace {

/// A file in a folder of this test's own, removed with it.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("clray-slr-{}", static_cast<const void*>(this));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return (path / name).string();
  }
};

}  // namespace

TEST_CASE("CRD: what is written reads back to the last digit") {
  const Folder folder;
  const std::string path = (folder.path / "a.crd").string();
  CrdHeader h;
  h.produced = {60271, 3600 * kPicosecondsPerSecond};
  h.start = {60270, 86399 * kPicosecondsPerSecond};
  h.stop = {60271, 20 * kPicosecondsPerSecond};
  h.station = "GRAZ";
  h.target = "box_wing";
  h.norad = "8820";
  h.rate_Hz = 2000.0;
  h.pulse_energy_mJ = 80.0;
  h.pulse_fwhm_ps = std::nan("");
  h.divergence_arcsec = 10.313;
  std::vector<CrdRange> written = {{0, 1, 0}, {86399999999999999, 6671281903963041, 1}, {1, 999999999999, 2}};
  CrdWriter writer(path, h, {86399 * kPicosecondsPerSecond, -1234.567891});
  for (const CrdRange& r : written) writer.range(r);
  writer.supplement({5, std::nan("")});
  writer.close();
  std::vector<CrdRange> read;
  const CrdFile file = read_crd(path, [&](const CrdRange& r) { read.push_back(r); });
  REQUIRE(read.size() == written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    CHECK(read[i].epoch_ps == written[i].epoch_ps);
    CHECK(read[i].flight_ps == written[i].flight_ps);
    CHECK(read[i].filter_flag == written[i].filter_flag);
  }
  CHECK(file.header.station == "GRAZ");
  CHECK(file.header.target == "box_wing");
  CHECK(file.header.cospar == "na");
  CHECK(file.header.norad == "8820");
  CHECK(file.header.target_class == 0);
  CHECK(file.header.start.mjd == 60270);
  CHECK(file.header.start.ps == h.start.ps);
  CHECK(file.header.stop.ps == h.stop.ps);
  CHECK(file.header.produced.ps == h.produced.ps);
  CHECK(file.header.pulse_energy_mJ == 80.0);
  CHECK(std::isnan(file.header.pulse_fwhm_ps));
  CHECK(file.supplements.size() == 2);
  CHECK(file.supplements[0].range_rate_m_s == -1234.567891);
  CHECK(std::isnan(file.supplements[1].range_rate_m_s));
  for (const char* type : {"C0", "C1", "C2", "C3", "20", "40"}) CHECK(file.records.at(type) == 1);
  CHECK(file.records.count("11") == 0);
  CHECK(file.records.count("50") == 0);
}

TEST_CASE("CRD: numbers stand where programs that read such files know nothing else") {
  // Orekit 13.1 and orbitNP 1.2 refuse "na" in these fields: H2 pad, system, occupancy; H5 all; 20 and 40 all.
  const Folder folder;
  const std::string path = (folder.path / "a.crd").string();
  CrdHeader h;
  h.produced = h.start = h.stop = {59000, 0};
  h.pad = "7840";
  h.system = "35";
  h.occupancy = "1";
  h.network = "ILRS";
  h.pressure_hPa = 963.456;
  h.temperature_K = 281.5;
  h.humidity_percent = 61.0;
  h.prediction_year = "20";
  h.prediction_date = "053123";
  h.prediction_source = "clray";
  h.prediction_sequence = "0";
  CrdWriter writer(path, h, {0, 1.0});
  writer.range({0, 1, 0});
  writer.close();
  std::ifstream in(path);
  std::map<std::string, std::string> record;
  for (std::string line; std::getline(in, line);) record[line.substr(0, line.find(' '))] = line;
  CHECK(record["H2"] == "H2 clray 7840 35 1 7 ILRS");
  CHECK(record["H5"] == "H5 0 20 053123 clray 0");
  CHECK(record["20"] == "20 0.000000000000 963.46 281.50 61 0");
  CHECK(record["40"].find("na") == std::string::npos);
  // Refraction is corrected, for there is none in a vacuum; centre of mass and amplitude are not.
  const std::string h4 = record["H4"];
  CHECK(h4.substr(h4.size() - 16) == " 0 1 0 0 1 0 2 0");
  CHECK(read_crd(path, {}).header.pad == "7840");
}

TEST_CASE("CRD: bad files are refused with their line, good ones of other stations are read") {
  const std::string head =
      "h1 CRD  2 2022  5  1  3\nh2 YARL 7090  5 13  3 ILRS\nh3 lageos2 9207002 5986 22195 0 1  1\n"
      "h4  0 2022  5  1  2 18 58 2022  5  1  2 24  3  0 0 0 0 1 0 2 0\nh5  1 22 043000 HTS 12001\n"
      "C0 0 532.000 std ml1 mcp mt1\n";
  const std::string range = "10  7907.550577400252     0.047960587856 std 2 2 0 0    na    na\n";
  const std::string tail = "20 7907.550 801.80 301.36   39 0\nh8\nh9\n";
  const Folder folder;
  CHECK(read_crd(folder.write("ok.crd", head + range + range + tail), {}).ranges == 2);
  const auto refused = [&](const std::string& text, const char* words) {
    CAPTURE(words);
    CHECK_THROWS_WITH_AS(read_crd(folder.write("bad.crd", text), {}), doctest::Contains(words), Error);
  };
  refused(head + "10 7907.55 0.0479 std 2 2 0 0 na\n" + tail, "bad.crd:7: record 10 has 9 fields; expected 10");
  refused(head + "10 7907.55 0.04x std 2 2 0 0 na na\n" + tail, "bad.crd:7: field 3 (time of flight)");
  refused(head + "10 7907.55 -0.04 std 2 2 0 0 na na\n" + tail, "field 3 (time of flight)");
  refused(head + "10 7907.55 0.0400000000001 std 2 2 0 0 na na\n" + tail, "at most 12 decimals");
  refused(head + "10 99999 0.04 std 2 2 0 0 na na\n" + tail, "less than 86400");
  refused(head + "10 7907.55 0.04 sys 2 2 0 0 na na\n" + tail, "system configuration \"sys\"");
  refused(head + "10 7907.55 0.04 std 2 3 0 0 na na\n" + tail, "filter flag");
  refused(head + "77 1 2\n" + tail, "bad.crd:7: record 77 does not belong here");
  refused(head + range, "ends without H8 and H9");
  refused(head + range + tail + range, "after H9");
  refused(range + head, "record 10; expected H1");
  refused(std::string(head).replace(8, 1, "1") + tail, "format version 1; expected 2");
  refused(std::string(head).replace(head.find("h4  0"), 5, "h4  2") + tail,
          "data type 2; expected 0 (full rate) or 1 (normal points)");
  const std::string points = std::string(head).replace(head.find("h4  0"), 5, "h4  1");
  refused(points + range + tail, "bad.crd:7: record 10 in data of type 1 (H4)");
  const std::string point = "11 7907.55 0.0479 std 2 120.0 37 31.5 -0.1 0.4 na 1.5 0 na\n";
  CHECK(read_crd(folder.write("np.crd", points + point + tail), {}).points.front().ranges == 37);
  refused(head + point + tail, "record 11 in data of type 0 (H4)");
  refused(points + std::string(point).replace(18, 3, "sys") + tail, "system configuration \"sys\"");
  refused(points + std::string(point).replace(24, 5, "0") + tail, "the length of the bin is not above 0");
  refused(points + std::string(point).replace(30, 2, "0") + tail, "number of ranges");
  refused(head + "30 7907.55 361 45 0 1 1 0 0\n" + tail, "azimuth; expected 0 to 360 degrees");
  refused(head + "30 7907.55 36 95 0 1 1 0 0\n" + tail, "elevation; expected -90 to 90 degrees");
  refused(head + "50 std 31.5 x 0.4 na 0\n" + tail, "skewness");
}
