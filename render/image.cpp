#include "render/image.h"

#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>

#include "core/error.h"

namespace locsim::render {
namespace {

constexpr int max_side_px = 32768;

int checked_side(int pixels, const char* name) {
  if (pixels < 1 || pixels > max_side_px) {
    throw InputError(std::string("picture: ") + name + " is " + std::to_string(pixels) +
                     " px; give 1 to " + std::to_string(max_side_px));
  }
  return pixels;
}

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Empty when all went well, else the reason.
std::string write_file(const Image& image, const std::filesystem::path& file) {
  std::unique_ptr<std::FILE, FileCloser> stream(std::fopen(file.c_str(), "wb"));
  if (!stream) return std::strerror(errno);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = PNG_FORMAT_RGBA;
  static_assert(sizeof(Color) == 4);
  if (png_image_write_to_stdio(&header, stream.get(), 0, image.pixels().data(), 0, nullptr) == 0) {
    return header.message;
  }
  return std::fclose(stream.release()) == 0 ? "" : std::strerror(errno);
}

}  // namespace

Image::Image(int width, int height, Color fill)
    : width_(checked_side(width, "width")),
      height_(checked_side(height, "height")),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

void Image::paste(const Image& other, int x, int y) {
  const int x_from = std::max(0, -x);
  const int x_to = std::min(other.width_, width_ - x);
  if (x_to <= x_from) return;
  for (int row = std::max(0, -y); row < std::min(other.height_, height_ - y); ++row) {
    const auto source = other.pixels_.begin() + static_cast<std::ptrdiff_t>(other.index(0, row));
    std::copy(source + x_from, source + x_to,
              pixels_.begin() + static_cast<std::ptrdiff_t>(index(x + x_from, y + row)));
  }
}

void write_png(const Image& image, const std::filesystem::path& file) {
  std::filesystem::path partial = file;
  partial += ".partial";
  std::string reason = write_file(image, partial);
  std::error_code error;
  if (reason.empty()) {
    std::filesystem::rename(partial, file, error);
    if (error) reason = error.message();
  }
  if (reason.empty()) return;
  std::filesystem::remove(partial, error);
  throw InputError(file.string() + ": the picture cannot be written (" + reason +
                   "); give a file in a folder that exists and can be written");
}

}  // namespace locsim::render
