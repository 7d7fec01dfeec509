// SPDX-License-Identifier: Apache-2.0
// Pictures and cubes read back: FITS through cfitsio to the same doubles, EXR to float rounding, PNG to the sRGB code
// value of a grey Lambert plate computed here from the standards.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <doctest/doctest.h>
#include <fitsio.h>
#include <png.h>

#include "clray/write.hpp"
#include "io/colour.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;

namespace {

constexpr double kPi = 3.14159265358979323846;

WriteOptions no_plots() {
  WriteOptions options;
  options.plots = false;
  return options;
}

/// A picture of a Lambert plate of reflectance rho, square to the light; the right column is empty sky.
ImageResult plate(double rho, const std::vector<Band>& bands, const std::string& detector = "rgb") {
  ImageResult image;
  image.key.detector = detector;
  image.width = 3;
  image.height = 2;
  image.pixel_m = 0.25;
  image.centre_right_m = -2.375;
  image.centre_up_m = 0.5;
  image.bands = bands;
  image.coverage = {1, 1, 0, 1, 0.5f, 0};
  for (std::size_t b = 0; b < bands.size(); ++b) {
    image.band_source_W_m2.push_back(100.0 + 10.0 * static_cast<double>(b));
    for (const float share : image.coverage) image.radiance_per_sr.push_back(rho / kPi * static_cast<double>(share));
  }
  return image;
}

std::vector<std::uint8_t> read_png(const std::string& file, int& width, int& height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&image, file.c_str()));
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  REQUIRE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  width = static_cast<int>(image.width);
  height = static_cast<int>(image.height);
  return pixels;
}

std::vector<double> read_fits(fitsfile* file, int hdu, std::vector<long>& axes) {
  int status = 0, kind = 0, count = 0, type = 0;
  fits_movabs_hdu(file, hdu, &kind, &status);
  axes.assign(4, 1);
  fits_get_img_param(file, 4, &type, &count, axes.data(), &status);
  axes.resize(static_cast<std::size_t>(count));
  long n = 1;
  for (const long length : axes) n *= length;
  std::vector<double> values(static_cast<std::size_t>(n));
  fits_read_img(file, TDOUBLE, 1, n, nullptr, values.data(), nullptr, &status);
  REQUIRE(status == 0);
  return values;
}

}  // namespace

TEST_CASE("a grey Lambert plate under white light has the computed sRGB value") {
  // Equal power per nm seen over 380-780 nm: XYZ of the equal-energy white. A plate of reflectance 0.5 gives Y = 0.5;
  // chromaticity (x, y) of that white follows from the fit, so its linear RGB is computed here by integration of the
  // fit and the matrix of IEC 61966-2-1 (four decimals), good to 5e-4 and thus to one code value.
  double x = 0.0, y = 0.0, z = 0.0;
  const auto g = [](double l, double m, double a, double b) {
    return std::exp(-0.5 * std::pow((l - m) / (l < m ? a : b), 2));
  };
  for (double l = 380.05; l < 780.0; l += 0.1) {
    x += 1.056 * g(l, 599.8, 37.9, 31.0) + 0.362 * g(l, 442.0, 16.0, 26.7) - 0.065 * g(l, 501.1, 20.4, 26.2);
    y += 0.821 * g(l, 568.8, 46.9, 40.5) + 0.286 * g(l, 530.9, 16.3, 31.1);
    z += 1.217 * g(l, 437.0, 11.8, 36.0) + 0.681 * g(l, 459.0, 26.0, 13.8);
  }
  x *= 0.5 / y;
  z *= 0.5 / y;
  const double linear[3] = {3.2406 * x - 1.5372 * 0.5 - 0.4986 * z, -0.9689 * x + 1.8758 * 0.5 + 0.0415 * z,
                            0.0557 * x - 0.2040 * 0.5 + 1.0570 * z};
  Scene scene = io_test::scene("rgb");
  scene.source.kind = Source::Kind::sun;
  scene.source.spectrum = Spectrum{{200, 900}, {1, 1}};
  Scratch scratch;
  Result result = io_test::result();
  result.image.push_back(plate(0.5, {{"all", 380, 780}}));
  write_result(result, scene, scratch / "out", no_plots());
  int width = 0, height = 0;
  const auto pixels = read_png(scratch / "out/rgb.png", width, height);
  REQUIRE(width == 3);
  REQUIRE(height == 2);
  for (int c = 0; c < 3; ++c) {
    const double code = 255.0 * (1.055 * std::pow(linear[c], 1.0 / 2.4) - 0.055);
    CAPTURE(c);
    CHECK(pixels[static_cast<std::size_t>(c)] == doctest::Approx(code).epsilon(1.0 / code));
    // Straight alpha: a half covered pixel has the plate's colour.
    CHECK(pixels[static_cast<std::size_t>(4 * 4 + c)] == pixels[static_cast<std::size_t>(c)]);
  }
  CHECK(pixels[3] == 255);
  CHECK(pixels[4 * 2 + 3] == 0);
  CHECK(pixels[4 * 4 + 3] == 128);
}

TEST_CASE("colour is that of the light that there is: none is invented beyond a source's or a filter's table") {
  // The mean of the fit over [low, high] in flat light, by the midpoint rule with steps of 0.01 nm: good to 1e-6.
  const auto flat = [](double low, double high) {
    Vec3 sum{0.0};
    const int n = static_cast<int>(std::lround((high - low) / 0.01));
    for (int i = 0; i < n; ++i) sum += io::colour_matching(low + (i + 0.5) * (high - low) / n);
    return sum / static_cast<double>(n);
  };
  const auto near = [](const Vec3& found, const Vec3& expected) {
    for (int c = 0; c < 3; ++c) CHECK(std::fabs(found[c] - expected[c]) <= 1e-5);
  };
  Source red;
  red.kind = Source::Kind::sun;
  red.spectrum = Spectrum{{610, 640}, {1, 1}};
  near(io::band_colour({"all", 400, 700}, red), flat(610, 640));
  near(io::band_colour({"all", 200, 10000}, red), flat(610, 640));
  near(io::band_colour({"half", 400, 625}, red), flat(610, 625));
  near(io::band_colour({"blue", 400, 500}, red), Vec3{0.0});
  // A line far narrower than the band, which samples a nm apart would miss.
  Source line = red;
  line.spectrum = Spectrum{{588.99, 589.01}, {5, 5}};
  near(io::band_colour({"all", 380, 780}, line), io::colour_matching(589.0));
  // A filter that opens from 500 to 520 nm only, in a band that claims more.
  Source white = red;
  white.spectrum = Spectrum{{200, 1200}, {3, 3}};
  const auto filter = std::make_shared<const Spectrum>(Spectrum{{500, 520}, {0.2, 0.2}});
  near(io::band_colour({"filter", 400, 700, filter}, white), flat(500, 520));
  // A band that reaches into the infrared keeps its visible share: 330-880 nm has all of the fit.
  near(io::band_colour({"wide", 330, 1200}, white), flat(330, 880) * (550.0 / 870.0));
  // 610-640 nm is red: sRGB is far beyond its green and blue there.
  ImageResult image = plate(0.5, {{"all", 400, 700}});
  const Vec3 rgb = io::rgb_weights(image, red).at(0);
  CHECK(rgb.x > 1.0);
  CHECK(rgb.y < 0.2 * rgb.x);
  CHECK(rgb.z < 0.0);
}

TEST_CASE("white of D65 is white, and the transfer curve has its fixed points") {
  // x = 0.3127, y = 0.3290 of ITU-R BT.709.
  const Vec3 white = io::xyz_to_linear_srgb({0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290});
  for (int c = 0; c < 3; ++c) CHECK(white[c] == doctest::Approx(1.0).epsilon(1e-12));
  CHECK(io::srgb_encode(0.0) == 0.0);
  CHECK(io::srgb_encode(std::nan("")) == 0.0);
  CHECK(io::srgb_encode(7.0) == 1.0);
  CHECK(std::lround(255.0 * io::srgb_encode(0.5)) == 188);
  // The matching functions peak where the eye does, near 555 nm with about 1.
  CHECK(io::colour_matching(555.0).y == doctest::Approx(1.0).epsilon(0.01));
}

TEST_CASE("exposure is stops, and invisible bands give a warning and grey") {
  Scratch scratch;
  Result result = io_test::result();
  result.image.push_back(plate(0.25, {{"infrared", 1500, 1600}}));
  Scene scene = io_test::scene("rgb");
  scene.detectors.front().parameters["exposure_ev"] = 1.0;
  std::vector<std::string> warnings;
  WriteOptions options = no_plots();
  options.warnings = &warnings;
  write_result(result, scene, scratch / "out", options);
  int width = 0, height = 0;
  const auto pixels = read_png(scratch / "out/rgb.png", width, height);
  // 0.25 at one stop more is 0.5, whose code value is 188.
  for (int c = 0; c < 3; ++c) CHECK(pixels[static_cast<std::size_t>(c)] == 188);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings.front().find("no visible light") != std::string::npos);
}

TEST_CASE("a face as bright as white paper has a thin grey line round it in the PNG, a darker one has none") {
  for (const double rho : {1.0, 0.5}) {
    Scratch scratch;
    Scene scene = io_test::scene("rgb");
    scene.source.kind = Source::Kind::sun;
    scene.source.spectrum = Spectrum{{200, 900}, {1, 1}};
    ImageResult image = plate(rho, {{"all", 380, 780}});
    image.width = 5;
    image.height = 4;
    image.coverage.assign(20, 1.0f);
    for (const int sky : {4, 9, 14, 19}) image.coverage[static_cast<std::size_t>(sky)] = 0.0f;  // the right column
    image.radiance_per_sr.clear();
    for (const float share : image.coverage) image.radiance_per_sr.push_back(rho / kPi * static_cast<double>(share));
    Result result = io_test::result();
    result.image.push_back(image);
    write_result(result, scene, scratch / "out", no_plots());
    int width = 0, height = 0;
    const auto pixels = read_png(scratch / "out/rgb.png", width, height);
    REQUIRE(width == 5);
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 4; ++x) {
        CAPTURE(x);
        CAPTURE(y);
        const bool edge = x == 0 || x == 3 || y == 0 || y == 3;
        const std::uint8_t red = pixels[static_cast<std::size_t>(4 * (5 * y + x))];
        if (rho == 1.0) CHECK((red == 140) == edge);
        if (rho == 0.5) CHECK(red == pixels[0]);
        CHECK(pixels[static_cast<std::size_t>(4 * (5 * y + x) + 3)] == 255);
      }
    }
  }
}

TEST_CASE("EXR holds the linear radiance of every band") {
  Scratch scratch;
  Result result = io_test::result();
  result.image.push_back(plate(0.3, {{"400-500", 400, 500}, {"500.5-600", 500.5, 600}}));
  for (std::size_t i = 0; i < 12; ++i) result.image.front().radiance_per_sr[i] *= 1.0 + 0.01 * static_cast<double>(i);
  write_result(result, io_test::scene("rgb"), scratch / "out", no_plots());
  Imf::InputFile file((scratch / "out/rgb.exr").c_str());
  for (std::size_t b = 0; b < 2; ++b) {
    const std::string name = b == 0 ? "radiance.0_400-500" : "radiance.1_500_5-600";
    REQUIRE(file.header().channels().findChannel(name) != nullptr);
    std::vector<float> values(6);
    Imf::FrameBuffer buffer;
    buffer.insert(name,
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float), 3 * sizeof(float)));
    file.setFrameBuffer(buffer);
    file.readPixels(0, 1);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(static_cast<double>(values[i]) ==
            doctest::Approx(result.image.front().radiance_per_sr[6 * b + i]).epsilon(1e-6));
    }
  }
}

TEST_CASE("EXR channels come in the order of the bands, also from ten on") {
  Scratch scratch;
  Result result = io_test::result();
  std::vector<Band> bands;
  for (int b = 0; b < 12; ++b) bands.push_back({"band", 400.0 + b, 401.0 + b});
  result.image.push_back(plate(0.3, bands));
  write_result(result, io_test::scene("rgb"), scratch / "out", no_plots());
  Imf::InputFile file((scratch / "out/rgb.exr").c_str());
  std::vector<std::string> names;
  const Imf::ChannelList& channels = file.header().channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    if (std::string(channel.name()).rfind("radiance.", 0) == 0) names.push_back(channel.name());
  }
  REQUIRE(names.size() == 12);
  for (std::size_t b = 0; b < names.size(); ++b) CHECK(std::stoul(names[b].substr(9)) == b);
}

TEST_CASE("several orientations: a picture each and a contact sheet") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(5, {});
  for (std::size_t i = 0; i < 5; ++i) {
    result.image.push_back(plate(0.5, {{"all", 380, 780}}));
    result.image.back().key.orientation = i;
  }
  const auto files = write_result(result, io_test::scene("rgb"), scratch / "out", no_plots());
  CHECK(std::filesystem::exists(scratch / "out/rgb-0004.png"));
  int width = 0, height = 0;
  read_png(scratch / "out/rgb.png", width, height);
  // Three columns and two rows of 3 x 2 pixels with gaps of 4.
  CHECK(width == 17);
  CHECK(height == 8);
}

TEST_CASE("hyperspectral.fits: values, axes and history read back through cfitsio") {
  Scratch scratch;
  Result result = io_test::result();
  result.image.push_back(plate(0.3, {{"a", 400, 450}, {"b", 450, 500}, {"c", 500, 550}}, "hyperspectral"));
  auto& image = result.image.front();
  for (std::size_t i = 0; i < image.radiance_per_sr.size(); ++i)
    image.radiance_per_sr[i] = std::sqrt(static_cast<double>(i)) / 3.0;
  image.standard_error_per_sr.assign(18, 0.125);
  Scene scene = io_test::scene("hyperspectral");
  scene.path = "meshes/plät'e.toml";
  write_result(result, scene, scratch / "o[1]!(x)", no_plots());
  fitsfile* file = nullptr;
  int status = 0;
  fits_open_diskfile(&file, (scratch / "o[1]!(x)/hyperspectral.fits").c_str(), READONLY, &status);
  REQUIRE(status == 0);
  std::vector<long> axes;
  const auto values = read_fits(file, 1, axes);
  CHECK(axes == std::vector<long>{3, 2, 3});
  for (std::size_t b = 0; b < 3; ++b) {
    for (std::size_t y = 0; y < 2; ++y) {
      // FITS rows run upward.
      for (std::size_t x = 0; x < 3; ++x)
        CHECK(values[b * 6 + (1 - y) * 3 + x] == image.radiance_per_sr[b * 6 + y * 3 + x]);
    }
  }
  char text[FLEN_VALUE];
  const auto keyword = [&](const char* name) {
    fits_read_key(file, TSTRING, name, text, nullptr, &status);
    REQUIRE(status == 0);
    return std::string(text);
  };
  double number = 0.0;
  CHECK(keyword("BUNIT") == "sr-1");
  CHECK(keyword("CTYPE3") == "WAVE");
  CHECK(keyword("CUNIT3") == "nm");
  fits_read_key(file, TDOUBLE, "CRVAL3", &number, nullptr, &status);
  CHECK(number == 425.0);
  fits_read_key(file, TDOUBLE, "CDELT3", &number, nullptr, &status);
  CHECK(number == 50.0);
  fits_read_key(file, TDOUBLE, "CDELT1", &number, nullptr, &status);
  CHECK(number == 0.25);
  // The middle of 3 x 2 pixels, 1 being the first's centre, and where it lies from the reference point.
  const double middle[][2] = {{2.0, -2.375}, {1.5, 0.5}};
  for (int axis = 0; axis < 2; ++axis) {
    fits_read_key(file, TDOUBLE, axis == 0 ? "CRPIX1" : "CRPIX2", &number, nullptr, &status);
    CHECK(number == middle[axis][0]);
    fits_read_key(file, TDOUBLE, axis == 0 ? "CRVAL1" : "CRVAL2", &number, nullptr, &status);
    CHECK(number == middle[axis][1]);
  }
  char* header = nullptr;
  int keys = 0;
  fits_hdr2str(file, 0, nullptr, 0, &header, &keys, &status);
  REQUIRE(status == 0);
  const std::string cards = header;
  fits_free_memory(header, &status);
  CHECK(cards.find("digest 00000000deadbeef") != std::string::npos);
  CHECK(cards.find("HISTORY scene meshes/pl?t'e.toml") != std::string::npos);
  CHECK(read_fits(file, 2, axes) == std::vector<double>(18, 0.125));
  fits_close_file(file, &status);
  CHECK(status == 0);
}

TEST_CASE("delay.fits: orientation x bin, the same densities as the table") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(2, {});
  for (std::size_t i = 0; i < 2; ++i) result.delay.push_back(io_test::delay(4, i));
  write_result(result, io_test::scene(), scratch / "out", no_plots());
  fitsfile* file = nullptr;
  int status = 0;
  fits_open_diskfile(&file, (scratch / "out/delay.fits").c_str(), READONLY, &status);
  REQUIRE(status == 0);
  std::vector<long> axes;
  const auto values = read_fits(file, 1, axes);
  CHECK(axes == std::vector<long>{4, 2});
  const double width_ns = result.delay[0].bin_width_s * 1e9;
  for (std::size_t o = 0; o < 2; ++o) {
    for (std::size_t i = 0; i < 4; ++i) CHECK(values[o * 4 + i] == result.delay[o].bin_m2_per_sr[i] / width_ns);
  }
  fits_close_file(file, &status);
}

TEST_CASE("radiation force in several bands: a table for each, and no map of a single direction") {
  Scratch scratch;
  Result result = io_test::result();
  for (const char* band : {"400-500", "V"}) {
    PressureResult p;
    p.key.detector = "pressure";
    p.key.band = band;
    result.pressure.push_back(p);
  }
  write_result(result, io_test::scene("pressure"), scratch / "out");
  CHECK(std::filesystem::exists(scratch / "out/pressure-400-500.csv"));
  CHECK(std::filesystem::exists(scratch / "out/pressure-V.csv"));
  CHECK_FALSE(std::filesystem::exists(scratch / "out/pressure-V.png"));
  CHECK_FALSE(std::filesystem::exists(scratch / "out/pressure.png"));
}
