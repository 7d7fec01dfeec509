// SPDX-License-Identifier: Apache-2.0
// The imaging detectors' files: rgb.png/.exr (with a contact sheet for several orientations) and hyperspectral.fits.
// Radiances are means over whole pixels, per unit irradiance (1/sr); PNG alpha is straight, EXR colour premultiplied.
#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "io/colour.hpp"
#include "io/detector/room.hpp"
#include "io/fits_file.hpp"
#include "io/netcdf/records.hpp"
#include "io/picture_file.hpp"
#include "io/summary_entries.hpp"
#include "text/file_names.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

using Group = std::vector<const ImageResult*>;

/// Linear sRGB in which a white Lambert plate square to the light is 1, premultiplied by coverage.
struct Linear {
  int width = 0, height = 0;
  std::vector<Vec3> rgb;
  std::vector<float> coverage;
};

std::size_t pixel_count(const ImageResult& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

Linear develop(const ImageResult& image, const Source& source, bool& visible) {
  auto weights = rgb_weights(image, source);
  visible = std::any_of(weights.begin(), weights.end(), [](const Vec3& w) { return w != Vec3{0.0}; });
  // Ultraviolet and infrared pictures are shown in grey: mean of the bands, white plate at 1.
  if (!visible)
    weights.assign(weights.size(),
                   Vec3{constants::kPi / static_cast<double>(std::max<std::size_t>(weights.size(), 1))});
  const std::size_t pixels = pixel_count(image);
  Linear linear{image.width, image.height, std::vector<Vec3>(pixels, Vec3{0.0}), image.coverage};
  linear.coverage.resize(pixels, 1.0f);
  for (std::size_t b = 0; b < weights.size(); ++b) {
    for (std::size_t i = 0; i < pixels; ++i) linear.rgb[i] += image.radiance_per_sr[b * pixels + i] * weights[b];
  }
  return linear;
}

/// A thin grey line round the body where it is so bright that it would be lost on a white page.
void outline(Pixels* pixels) {
  constexpr std::uint8_t kBright = 216, kLine = 140;
  const int w = pixels->width, h = pixels->height;
  const auto at = [&](int x, int y) {
    return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x));
  };
  const auto covered = [&](int x, int y) {
    return x >= 0 && x < w && y >= 0 && y < h && pixels->rgba[at(x, y) + 3] >= 128;
  };
  std::vector<std::size_t> edge;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      if (!covered(x, y)) continue;
      if (covered(x - 1, y) && covered(x + 1, y) && covered(x, y - 1) && covered(x, y + 1)) continue;
      const std::uint8_t* p = &pixels->rgba[at(x, y)];
      if (std::min({p[0], p[1], p[2]}) >= kBright) edge.push_back(at(x, y));
    }
  }
  for (const std::size_t p : edge) std::fill_n(pixels->rgba.begin() + static_cast<std::ptrdiff_t>(p), 3, kLine);
}

Pixels encode(const Linear& linear, double exposure) {
  Pixels pixels{linear.width, linear.height, std::vector<std::uint8_t>(linear.rgb.size() * 4)};
  for (std::size_t i = 0; i < linear.rgb.size(); ++i) {
    const double alpha = std::clamp(static_cast<double>(linear.coverage[i]), 0.0, 1.0);
    const double scale = alpha > 0.0 ? exposure / alpha : 0.0;
    for (int c = 0; c < 3; ++c) {
      pixels.rgba[4 * i + static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::lround(255.0 * srgb_encode(linear.rgb[i][c] * scale)));
    }
    pixels.rgba[4 * i + 3] = static_cast<std::uint8_t>(std::lround(255.0 * alpha));
  }
  outline(&pixels);
  return pixels;
}

/// Box-filtered to at most `most` pixels wide.
Linear shrink(const Linear& large, int most) {
  const int factor = std::max(1, (large.width + most - 1) / most);
  Linear small{large.width / factor, std::max(1, large.height / factor), {}, {}};
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      Vec3 sum{0.0};
      double coverage = 0.0;
      int n = 0;
      for (int j = y * factor; j < std::min((y + 1) * factor, large.height); ++j) {
        for (int i = x * factor; i < std::min((x + 1) * factor, large.width); ++i, ++n) {
          const std::size_t at =
              static_cast<std::size_t>(j) * static_cast<std::size_t>(large.width) + static_cast<std::size_t>(i);
          sum += large.rgb[at];
          coverage += static_cast<double>(large.coverage[at]);
        }
      }
      small.rgb.push_back(sum / static_cast<double>(n));
      small.coverage.push_back(static_cast<float>(coverage / n));
    }
  }
  return small;
}

/// All pictures of a group in rows, on a nearly square sheet, with a gap between them.
Linear contact_sheet(const std::vector<Linear>& frames) {
  constexpr int kGap = 4;
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(frames.size()))));
  const int rows = (static_cast<int>(frames.size()) + columns - 1) / columns;
  const int w = frames.front().width, h = frames.front().height;
  Linear sheet{columns * (w + kGap) - kGap, rows * (h + kGap) - kGap, {}, {}};
  const std::size_t pixels = static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height);
  sheet.rgb.assign(pixels, Vec3{0.0});
  sheet.coverage.assign(pixels, 0.0f);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const int left = static_cast<int>(f) % columns * (w + kGap), top = static_cast<int>(f) / columns * (h + kGap);
    for (int y = 0; y < std::min(h, frames[f].height); ++y) {
      for (int x = 0; x < std::min(w, frames[f].width); ++x) {
        const std::size_t to = static_cast<std::size_t>(top + y) * static_cast<std::size_t>(sheet.width) +
                               static_cast<std::size_t>(left + x);
        const std::size_t from =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(frames[f].width) + static_cast<std::size_t>(x);
        sheet.rgb[to] = frames[f].rgb[from];
        sheet.coverage[to] = frames[f].coverage[from];
      }
    }
  }
  return sheet;
}

double exposure_ev(const Writer& writer, const ResultKey& key) {
  const DetectorSpec* detector = writer.detector_of(key);
  if (detector == nullptr) return 0.0;
  const auto found = detector->parameters.find("exposure_ev");
  return found != detector->parameters.end() ? found->second : 0.0;
}

/// Stem with the orientation's number where there are several.
std::string frame_stem(const std::string& stem, const Group& group, std::size_t i) {
  if (group.size() == 1) return stem;
  std::string digits = std::to_string(group[i]->key.orientation);
  return stem + "-" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

/// The picture's pixel size and centre, in words.
std::string framing(const ImageResult& image) {
  return "Pixel " + number(image.pixel_m) + " m; centre " + number(image.centre_right_m) + " m to the right and " +
         number(image.centre_up_m) + " m above the body's reference point";
}

/// `value` with leading zeros, so that names of 0 … count − 1 sort in the order of the numbers.
std::string padded(std::size_t value, std::size_t count) {
  const std::string digits = std::to_string(value);
  return std::string(std::to_string(count - 1).size() - digits.size(), '0') + digits;
}

void exr_file(Writer& writer, const ImageResult& image, const Linear& linear, const std::string& stem) {
  std::vector<Channel> channels{{"R", {}}, {"G", {}}, {"B", {}}, {"A", linear.coverage}};
  for (const auto& rgb : linear.rgb) {
    for (int c = 0; c < 3; ++c) channels[static_cast<std::size_t>(c)].values.push_back(static_cast<float>(rgb[c]));
  }
  const std::size_t pixels = pixel_count(image);
  for (std::size_t b = 0; b < image.bands.size(); ++b) {
    const auto begin = image.radiance_per_sr.begin() + static_cast<std::ptrdiff_t>(b * pixels);
    // Dots would nest layers, and OpenEXR limits names to 255 bytes, so the number tells the bands apart. OpenEXR sorts
    // channels by name; padded numbers keep the bands in their order.
    channels.push_back({"radiance." + padded(b, image.bands.size()) + "_" + file_name_part(image.bands[b].name),
                        std::vector<float>(begin, begin + static_cast<std::ptrdiff_t>(pixels))});
    std::replace(channels.back().name.begin() + 9, channels.back().name.end(), '.', '_');
  }
  write_exr(writer.folder.path(writer.add(stem, "exr")), image.width, image.height, channels,
            "clray " CLRAY_VERSION ", scene " + writer.scene_name() + ", digest " + hex16(writer.result.digest) +
                ". R, G, B: linear sRGB primaries, 1 = white Lambert plate square to the light, premultiplied by A = "
                "coverage; "
                "radiance.*: radiance per unit irradiance, 1/sr, per band. " +
                framing(image));
}

void write_rgb(Writer& writer, const Group& group) {
  const std::string stem = writer.stem("rgb", group.front()->key);
  const double ev = exposure_ev(writer, group.front()->key);
  const std::string description =
      "clray " CLRAY_VERSION ", scene " + writer.scene_name() + ", digest " + hex16(writer.result.digest) +
      ". Exposure: a white Lambert plate square to the light has luminance 1, then " + rounded(ev, 6) + " EV; sRGB";
  bool visible = true;
  std::vector<Linear> frames;
  for (std::size_t i = 0; i < group.size(); ++i) {
    Linear linear = develop(*group[i], writer.scene.source, visible);
    exr_file(writer, *group[i], linear, frame_stem(stem, group, i));
    write_png(writer.folder.path(writer.add(frame_stem(stem, group, i), "png")), encode(linear, std::exp2(ev)),
              description + ". " + framing(*group[i]));
    if (group.size() > 1) frames.push_back(shrink(linear, 320));
  }
  if (!frames.empty()) {
    write_png(writer.folder.path(writer.add(stem, "png")), encode(contact_sheet(frames), std::exp2(ev)), description);
  }
  if (!visible) writer.warnings.push_back("the bands hold no visible light: " + stem + ".png shows their mean in grey");
}

/// The axis of bands: their wavelengths if they are evenly spaced, else their numbers (the table BANDS has the rest).
FitsAxis wavelength_axis(const std::vector<Band>& bands) {
  const auto centre = [&](std::size_t i) { return 0.5 * (bands[i].low_nm + bands[i].high_nm); };
  const double step = bands.size() > 1 ? (centre(bands.size() - 1) - centre(0)) / static_cast<double>(bands.size() - 1)
                                       : bands.front().high_nm - bands.front().low_nm;
  bool even = step != 0.0;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    even = even && std::fabs(centre(0) + step * static_cast<double>(i) - centre(i)) <= 1e-6 * std::fabs(step);
  }
  const long n = static_cast<long>(bands.size());
  return even ? FitsAxis{n, "WAVE", "nm", 1.0, centre(0), step} : FitsAxis{n, "BAND", "", 1.0, 1.0, 1.0};
}

void write_cube(Writer& writer, const Group& group, std::size_t i) {
  const ImageResult& image = *group[i];
  const FitsAxis x{image.width, "X", "m", 0.5 * (image.width + 1), image.centre_right_m, image.pixel_m};
  const FitsAxis y{image.height, "Y", "m", 0.5 * (image.height + 1), image.centre_up_m, image.pixel_m};
  FitsColumn name{"NAME", "", {}, {}}, low{"LOW", "nm", {}, {}}, high{"HIGH", "nm", {}, {}},
      source{"SOURCE", "W m-2", {}, {}};
  for (std::size_t b = 0; b < image.bands.size(); ++b) {
    name.texts.push_back(image.bands[b].name.empty() ? "?" : ascii(image.bands[b].name));
    low.numbers.push_back(image.bands[b].low_nm);
    high.numbers.push_back(image.bands[b].high_nm);
    source.numbers.push_back(b < image.band_source_W_m2.size() ? image.band_source_W_m2[b] : std::nan(""));
  }
  FitsFile file(writer.folder.path(writer.add(frame_stem(writer.stem("hyperspectral", image.key), group, i), "fits")));
  const auto wave = wavelength_axis(image.bands);
  file.image_from_top("RADIANCE", "sr-1", {x, y, wave}, image.radiance_per_sr);
  const auto direction = [&](const char* key, const Vec3& v, const char* comment) {
    const char* const axes[] = {"X", "Y", "Z"};
    for (int c = 0; c < 3; ++c) file.key(std::string(key) + axes[c], v[c], comment);
  };
  direction("RIGHT", image.right, "image x axis, body frame");
  direction("UP", image.up, "image y axis, body frame");
  direction("VIEW", image.toward, "toward the observer, body frame");
  file.history("clray " CLRAY_VERSION ": radiance per unit irradiance, mean over each pixel");
  file.history("X and Y are zero at the reference point of the body");
  file.history("scene " + (writer.scene.path.empty() ? writer.scene.name : writer.scene.path));
  file.history("seed " + std::to_string(writer.result.seed) + ", digest " + hex16(writer.result.digest));
  file.history("time " + number(time_of(writer.result, image.key)) + " s");
  if (!image.standard_error_per_sr.empty()) {
    file.image_from_top("STANDARD_ERROR", "sr-1", {x, y, wave}, image.standard_error_per_sr);
  }
  if (!image.coverage.empty()) {
    file.image_from_top("COVERAGE", "", {x, y}, image.coverage);
  }
  file.table("BANDS", {name, low, high, source});
  file.close();
  if (writer.options.netcdf) cube_netcdf(writer, image, frame_stem(writer.stem("hyperspectral", image.key), group, i));
}

void write_images(Writer& writer) {
  for (const auto& group : groups(writer.result.image)) {
    if (writer.kind_of(group.front()->key) == "rgb") {
      write_rgb(writer, group);
    } else {
      for (std::size_t i = 0; i < group.size(); ++i) write_cube(writer, group, i);
    }
  }
}

Json image_entry(const ImageResult& image) {
  Json bands = Json::array();
  for (std::size_t b = 0; b < image.bands.size(); ++b) {
    bands.push_back(
        {{"name", image.bands[b].name}, {"low_nm", image.bands[b].low_nm}, {"high_nm", image.bands[b].high_nm}});
    if (b < image.band_source_W_m2.size()) bands.back()["source_W_m2"] = image.band_source_W_m2[b];
  }
  return {{"width", image.width},
          {"height", image.height},
          {"pixel_m", image.pixel_m},
          {"centre_right_m", image.centre_right_m},
          {"centre_up_m", image.centre_up_m},
          {"right", vector(image.right)},
          {"up", vector(image.up)},
          {"toward", vector(image.toward)},
          {"unseen_mirrors_m2", image.unseen_mirrors_m2},
          {"unseen_caustics_m2", image.unseen_caustics_m2},
          {"bands", bands}};
}

void image_summary(SummaryEntries& entries) {
  entries.add(entries.writer.result.image, [&](const ImageResult& image) {
    Json entry = image_entry(image);
    if (entries.writer.kind_of(image.key) == "rgb") {
      entry["exposure"] = "a white Lambert plate square to the light has luminance 1, then exposure_ev stops";
      entry["exposure_ev"] = exposure_ev(entries.writer, image.key);
    }
    return entry;
  });
}

}  // namespace

const RecordRoom kPictureRecords{write_images, image_summary};

}  // namespace clray::io
