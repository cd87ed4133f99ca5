#include "render/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"

namespace locsim::render {
namespace {

/// A folder of this test's own, removed with it.
class ImageFile : public testing::Test {
 protected:
  ImageFile()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("locsim_image_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ImageFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

Image checked_pattern() {
  Image image(37, 23);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      image.at(x, y) = {static_cast<std::uint8_t>(7 * x), static_cast<std::uint8_t>(11 * y),
                        static_cast<std::uint8_t>(x * y), static_cast<std::uint8_t>(255 - x)};
    }
  }
  return image;
}

Image read_png(const std::filesystem::path& file) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&header, file.c_str()), 0) << header.message;
  header.format = PNG_FORMAT_RGBA;
  std::vector<Color> pixels(std::size_t{header.width} * header.height);
  EXPECT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
  Image image(static_cast<int>(header.width), static_cast<int>(header.height));
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      image.at(x, y) =
          pixels[static_cast<std::size_t>(y) * header.width + static_cast<std::size_t>(x)];
    }
  }
  return image;
}

TEST_F(ImageFile, PngReadBackEqualsWhatWasWritten) {
  const Image image = checked_pattern();
  write_png(image, folder_ / "a.png");
  EXPECT_TRUE(read_png(folder_ / "a.png") == image);
}

TEST_F(ImageFile, WritingReplacesAnOlderPictureAndLeavesNothingElse) {
  write_png(Image(3, 3), folder_ / "a.png");
  write_png(checked_pattern(), folder_ / "a.png");
  EXPECT_TRUE(read_png(folder_ / "a.png") == checked_pattern());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_),
                          std::filesystem::directory_iterator()),
            1);
}

TEST_F(ImageFile, MissingFolderIsAnInputErrorThatNamesTheFile) {
  const std::filesystem::path file = folder_ / "absent" / "a.png";
  try {
    write_png(Image(3, 3), file);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(file.string()));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "absent"));
}

TEST_F(ImageFile, AFolderInTheFilesPlaceIsAnInputErrorAndLeavesNoPartialFile) {
  std::filesystem::create_directories(folder_ / "a.png" / "inside");
  EXPECT_THROW(write_png(Image(3, 3), folder_ / "a.png"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png.partial"));
}

TEST(Image, SizesThatMakeNoPictureAreInputErrors) {
  EXPECT_THROW(Image(0, 10), InputError);
  EXPECT_THROW(Image(10, 100000), InputError);
}

TEST(Image, PasteCutsOffWhatLiesOutside) {
  const Color red{255, 0, 0};
  Image image(4, 4);
  image.paste(Image(4, 4, red), 2, -3);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      EXPECT_EQ(image.at(x, y) == red, x >= 2 && y == 0) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace locsim::render
