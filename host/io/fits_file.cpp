// SPDX-License-Identifier: Apache-2.0
// FITS files through cfitsio; see fits_file.hpp. No dates are written: equal results make equal files.
#include "io/fits_file.hpp"

#include <fitsio.h>

#include <algorithm>
#include <filesystem>

#include "clray/error.hpp"
#include "text/output_file.hpp"
#include "text/text.hpp"

namespace clray::io {

using namespace text;

namespace {

fitsfile* handle(void* file) {
  return static_cast<fitsfile*>(file);
}

std::string numbered(const char* stem, std::size_t i) {
  return stem + std::to_string(i + 1);
}

}  // namespace

FitsFile::FitsFile(const std::string& path) : path_(path) {
  fitsfile* file = nullptr;
  // The "diskfile" form takes brackets and such in a path as they are.
  fits_create_diskfile(&file, path.c_str(), &status_);
  file_ = file;
  check("make");
}

FitsFile::~FitsFile() {
  if (file_) {
    int ignored = 0;
    fits_close_file(handle(file_), &ignored);
  }
  if (!whole_) discard_output_file(path_);
}

void FitsFile::check(const char* what) {
  if (status_ == 0) return;
  char reason[FLEN_STATUS];
  fits_get_errstatus(status_, reason);
  fits_clear_errmsg();
  throw Error(ErrorCode::output, std::string("cannot ") + what + " " + shown(path_) + ": " + reason);
}

void FitsFile::image(const std::string& name, const std::string& unit, const std::vector<FitsAxis>& axes,
                     const std::vector<double>& pixels) {
  begin_image(name, unit, axes);
  write_numbers(0, pixels);
}

void FitsFile::write_numbers(std::size_t first, const std::vector<double>& numbers) {
  fits_write_img(handle(file_), TDOUBLE, static_cast<LONGLONG>(first) + 1, static_cast<LONGLONG>(numbers.size()),
                 const_cast<double*>(numbers.data()), &status_);
  check("write");
}

void FitsFile::begin_image(const std::string& name, const std::string& unit, const std::vector<FitsAxis>& axes) {
  std::vector<long> lengths;
  for (const auto& axis : axes) lengths.push_back(axis.length);
  fits_create_img(handle(file_), DOUBLE_IMG, static_cast<int>(lengths.size()), lengths.data(), &status_);
  key("EXTNAME", name, "");
  if (!unit.empty()) key("BUNIT", unit, "unit of the values");
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!axes[i].type.empty()) key(numbered("CTYPE", i), axes[i].type, "what runs along the axis");
    if (!axes[i].unit.empty()) key(numbered("CUNIT", i), axes[i].unit, "");
    key(numbered("CRPIX", i), axes[i].reference_pixel, "reference pixel, 1 is the first's centre");
    key(numbered("CRVAL", i), axes[i].reference_value, "value there");
    key(numbered("CDELT", i), axes[i].step, "step of a pixel");
  }
}

void FitsFile::table(const std::string& name, const std::vector<FitsColumn>& columns) {
  std::vector<std::string> forms;
  std::vector<char*> names, types, units;
  std::size_t rows = 0;
  for (const auto& column : columns) {
    std::size_t longest = 1;
    for (const auto& text : column.texts) longest = std::max(longest, text.size());
    forms.push_back(column.texts.empty() ? "1D" : std::to_string(longest) + "A");
    rows = std::max({rows, column.numbers.size(), column.texts.size()});
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    names.push_back(const_cast<char*>(columns[i].name.c_str()));
    types.push_back(forms[i].data());
    units.push_back(const_cast<char*>(columns[i].unit.c_str()));
  }
  fits_create_tbl(handle(file_), BINARY_TBL, static_cast<LONGLONG>(rows), static_cast<int>(columns.size()),
                  names.data(), types.data(), units.data(), name.c_str(), &status_);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    if (!columns[i].texts.empty()) {
      std::vector<std::string> plain;
      for (const auto& text : columns[i].texts) plain.push_back(ascii(text));
      std::vector<char*> cells;
      for (auto& text : plain) cells.push_back(text.data());
      fits_write_col(handle(file_), TSTRING, number, 1, 1, static_cast<LONGLONG>(cells.size()), cells.data(), &status_);
    } else if (!columns[i].numbers.empty()) {
      fits_write_col(handle(file_), TDOUBLE, number, 1, 1, static_cast<LONGLONG>(columns[i].numbers.size()),
                     const_cast<double*>(columns[i].numbers.data()), &status_);
    }
  }
  check("write");
}

void FitsFile::key(const std::string& name, const std::string& value, const std::string& comment) {
  const std::string plain = ascii(value).substr(0, 68);
  fits_update_key_str(handle(file_), name.c_str(), plain.c_str(), comment.empty() ? nullptr : comment.c_str(),
                      &status_);
  check("write");
}

void FitsFile::key(const std::string& name, double value, const std::string& comment) {
  fits_update_key(handle(file_), TDOUBLE, name.c_str(), &value, comment.empty() ? nullptr : comment.c_str(), &status_);
  check("write");
}

void FitsFile::history(const std::string& text) {
  fits_write_history(handle(file_), ascii(text).c_str(), &status_);
  check("write");
}

void FitsFile::close() {
  LONGLONG header = 0, data = 0, end = 0;
  fits_flush_file(handle(file_), &status_);
  fits_get_hduaddrll(handle(file_), &header, &data, &end, &status_);
  fits_close_file(handle(file_), &status_);
  file_ = nullptr;
  check("write");
  // cfitsio does not tell of the last bytes, which the system takes while the file is closed.
  std::error_code error;
  if (std::filesystem::file_size(path_, error) != static_cast<std::uintmax_t>(end) || error)
    fail_output("write", path_, 0);
  whole_ = true;
}

}  // namespace clray::io
