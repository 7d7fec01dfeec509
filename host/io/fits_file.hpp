// SPDX-License-Identifier: Apache-2.0
// FITS files through cfitsio: images of doubles with axis keywords, and tables. Source: FITS Standard 4.0 and its WCS
// papers for the keywords.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace clray::io {

/// One axis of an image, as CTYPEn, CUNITn, CRPIXn, CRVALn, CDELTn.
struct FitsAxis {
  long length = 0;
  std::string type, unit;
  double reference_pixel = 1.0, reference_value = 0.0, step = 1.0;
};

/// A column of a FITS table: numbers or texts.
struct FitsColumn {
  std::string name, unit;
  std::vector<double> numbers;
  std::vector<std::string> texts;
};

/// A FITS file being written. All members throw Error(output).
class FitsFile {
 public:
  explicit FitsFile(const std::string& path);
  ~FitsFile();
  FitsFile(const FitsFile&) = delete;
  FitsFile& operator=(const FitsFile&) = delete;

  /// The next image; the first is the primary one. `pixels` runs fastest along the first axis.
  void image(const std::string& name, const std::string& unit, const std::vector<FitsAxis>& axes,
             const std::vector<double>& pixels);
  /// The same of planes whose first row is the topmost: FITS counts rows from the bottom.
  template <class Number>
  void image_from_top(const std::string& name, const std::string& unit, const std::vector<FitsAxis>& axes,
                      const std::vector<Number>& pixels) {
    begin_image(name, unit, axes);
    const auto width = static_cast<std::size_t>(axes[0].length), height = static_cast<std::size_t>(axes[1].length);
    std::vector<double> plane(width * height);
    for (std::size_t first = 0; first < pixels.size(); first += plane.size()) {
      for (std::size_t y = 0; y < height; ++y)
        std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(first + (height - 1 - y) * width), width,
                    plane.begin() + static_cast<std::ptrdiff_t>(y * width));
      write_numbers(first, plane);
    }
  }
  void table(const std::string& name, const std::vector<FitsColumn>& columns);
  void key(const std::string& name, const std::string& value, const std::string& comment);
  void key(const std::string& name, double value, const std::string& comment);
  void history(const std::string& text);
  void close();

 private:
  void begin_image(const std::string& name, const std::string& unit, const std::vector<FitsAxis>& axes);
  /// Numbers of the image from the `first` on, counted from 0.
  void write_numbers(std::size_t first, const std::vector<double>& numbers);
  void check(const char* what);

  std::string path_;
  void* file_ = nullptr;  ///< fitsfile*; cfitsio's header stays out of ours
  int status_ = 0;
  bool whole_ = false;  ///< closed without a fault
};

}  // namespace clray::io
