// SPDX-License-Identifier: Apache-2.0
// Pictures as PNG and EXR; see picture_file.hpp. libpng reports errors by longjmp: the function that calls it holds no
// object with a destructor. Both are encoded in memory and then written with every error checked: OpenEXR writes a part
// of its files in a destructor, which must swallow errors.
#include "io/picture_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>

#include "clray/error.hpp"
#include "text/output_file.hpp"
#include "text/text.hpp"

namespace clray::io {

using namespace text;

namespace {

void append(png_structp png, png_bytep bytes, png_size_t count) {
  auto* out = static_cast<std::string*>(png_get_io_ptr(png));
  try {
    out->append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::exception&) {
    png_error(png, "no memory");
  }
}

bool encode_png(std::string* out, int width, int height, png_bytep rows, char* description) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  if (!png) return false;
  png_infop info = png_create_info_struct(png);
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_user_limits(png, 1 << 20, 1 << 20);
  png_set_write_fn(png, out, append, nullptr);
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

/// What OpenEXR writes, in memory.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (at_ + count > bytes.size()) bytes.resize(at_ + count);
    std::copy(c, c + n, bytes.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  std::string bytes;

 private:
  std::size_t at_ = 0;
};

}  // namespace

void write_png(const std::string& path, const Pixels& pixels, const std::string& description) {
  std::string text = ascii(description), bytes;
  if (!encode_png(&bytes, pixels.width, pixels.height, const_cast<png_bytep>(pixels.rgba.data()), text.data()))
    throw Error(ErrorCode::output, "cannot encode " + shown(path) + ": not enough memory");
  write_output_file(path, bytes);
}

void write_exr(const std::string& path, int width, int height, const std::vector<Channel>& channels,
               const std::string& description) {
  try {
    Imf::Header header(width, height);
    header.insert("comments", Imf::StringAttribute(shown(description)));
    Imf::FrameBuffer buffer;
    for (const auto& channel : channels) {
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
      buffer.insert(channel.name,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(channel.values.data())),
                               sizeof(float), sizeof(float) * static_cast<std::size_t>(width)));
    }
    MemoryStream stream(path);
    {
      Imf::OutputFile file(stream, header);
      file.setFrameBuffer(buffer);
      file.writePixels(height);
    }  // writes the table of lines, and would swallow a fault of the disk
    write_output_file(path, stream.bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::output, "cannot write " + shown(path) + ": " + error.what());
  }
}

}  // namespace clray::io
