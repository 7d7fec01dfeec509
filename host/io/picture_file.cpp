// SPDX-License-Identifier: Apache-2.0
// Pictures as PNG and EXR; see picture_file.hpp. libpng reports errors by longjmp: the function that calls it holds no
// object with a destructor.
#include "io/picture_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <png.h>

#include <cerrno>
#include <csetjmp>
#include <cstdio>

#include "clray/error.hpp"
#include "io/output_folder.hpp"
#include "text/text.hpp"

namespace clray::io {

using namespace text;

namespace {

bool encode_png(std::FILE* file, int width, int height, png_bytep rows, char* description) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  if (!png) return false;
  png_infop info = png_create_info_struct(png);
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_user_limits(png, 1 << 20, 1 << 20);
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_RELATIVE);
  char keyword[] = "Description";
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = keyword;
  text.text = description;
  png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  for (int y = 0; y < height; ++y)
    png_write_row(png, rows + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * 4);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const std::string& path, const Pixels& pixels, const std::string& description) {
  errno = 0;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) fail_output("write", path, errno);
  std::string text = ascii(description);
  const bool encoded =
      encode_png(file, pixels.width, pixels.height, const_cast<png_bytep>(pixels.rgba.data()), text.data());
  const int code = errno;
  const bool closed = std::fclose(file) == 0;
  if (!encoded || !closed) fail_output("write", path, encoded ? errno : code);
}

void write_exr(const std::string& path, int width, int height, const std::vector<Channel>& channels,
               const std::string& description) {
  try {
    Imf::Header header(width, height);
    header.insert("comments", Imf::StringAttribute(one_line(description)));
    Imf::FrameBuffer buffer;
    for (const auto& channel : channels) {
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
      buffer.insert(channel.name,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(channel.values.data())),
                               sizeof(float), sizeof(float) * static_cast<std::size_t>(width)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  } catch (const std::exception& error) {
    throw Error(ErrorCode::output, "cannot write " + one_line(path) + ": " + error.what());
  }
}

}  // namespace clray::io
