#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/random.hpp>
#include <io/picture/image.hpp>
#include <io/picture/stroke_font.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

namespace supple {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct ImageTest : testing::Test {
  ~ImageTest() override { fs::remove(path); }
  const fs::path path = fs::temp_directory_path() / ("supple-image-" + std::to_string(::getpid()) + ".png");
};

/// The columns and rows that differ from white: left, right (inclusive), top, bottom; left > right if there
/// are none.
struct InkBox {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  double ink = 0;  // darkness summed over the pixels
};
InkBox find_ink(const Image& image) {
  InkBox box;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (const double dark = 1 - image.at(x, y).g; dark > 0) {
        box.left = std::min(box.left, x), box.right = std::max(box.right, x);
        box.top = std::min(box.top, y), box.bottom = std::max(box.bottom, y);
        box.ink += dark;
      }
  return box;
}

Image written(std::string_view text, double size = 20, TextAlign align = TextAlign::Left, double x = 100) {
  Image image(400, 80);
  draw_text(image, x, 50, text, size, {0, 0, 0}, align);
  return image;
}

TEST_F(ImageTest, PngKeepsEveryPixel) {
  Random random(1);
  Image image(37, 23);
  for (std::uint8_t& byte : image.pixels) byte = static_cast<std::uint8_t>(random.below(256));
  write_png(path, image);
  const Image back = read_png(path);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 23);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST_F(ImageTest, RefusesWhatIsNoPngFile) {
  write_file(path, "not a picture");
  EXPECT_THAT([&] { read_png(path); }, ThrowsMessage<InputError>(HasSubstr("not a readable PNG file")));
  write_png(path, Image(50, 50));
  const std::string bytes = read_file(path);
  write_file(path, bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(read_png(path), InputError);
  EXPECT_THROW(write_png(path, Image()), std::invalid_argument);
  EXPECT_THROW(write_png(fs::temp_directory_path() / "no" / "such" / "folder.png", Image(1, 1)), InputError);
}

TEST_F(ImageTest, CapitalsAreAsHighAsAskedAndStandOnTheBaseline) {
  for (const double size : {10.0, 20.0, 37.0}) {
    const InkBox box = find_ink(written("HEX", size));
    const double half = 0.5 * stroke_thickness * size;
    EXPECT_NEAR(box.bottom + 1, 50 + half, 1) << size;
    EXPECT_NEAR(box.top, 50 - size - half, 1) << size;
    EXPECT_NEAR(box.right + 1 - box.left, text_width("HEX", size) + 2 * half, 2) << size;
    EXPECT_NEAR(box.left, 100 - half, 1) << size;
  }
}

TEST_F(ImageTest, TextIsAlignedLeftCentredOrRight) {
  const double width = text_width("caption", 20);
  const InkBox left = find_ink(written("caption", 20, TextAlign::Left, 200)),
               centre = find_ink(written("caption", 20, TextAlign::Centre, 200)),
               right = find_ink(written("caption", 20, TextAlign::Right, 200));
  EXPECT_NEAR(left.left - centre.left, width / 2, 1.5);
  EXPECT_NEAR(left.left - right.left, width, 1.5);
}

TEST_F(ImageTest, EveryPrintableCharacterLooksDifferent) {
  std::vector<Image> seen;
  for (char c = '!'; c <= '~'; ++c) {
    const Image image = written(std::string(1, c));
    EXPECT_GT(find_ink(image).ink, 3) << c;
    for (std::size_t k = 0; k < seen.size(); ++k)
      EXPECT_NE(image.pixels, seen[k].pixels) << c << " and " << static_cast<char>('!' + k);
    seen.push_back(image);
  }
  const std::vector<std::uint8_t> box = written("\x01").pixels;
  EXPECT_NE(written("ω").pixels, box);
  EXPECT_NE(written("‖").pixels, box);
  EXPECT_EQ(written("漢").pixels, box);  // not in the alphabet: one box, not three
}

TEST_F(ImageTest, DigitsAreEquallyWide) {
  for (const char* digits : {"00", "11", "47", "83"}) EXPECT_FLOAT_EQ(lay_out(digits).width, lay_out("22").width);
}

TEST_F(ImageTest, BrokenUtf8AndTextBeyondTheEdgesAreHarmless) {
  for (const char* text : {"\xff\xfe", "a\xc3", "\x80\x80\x80", ""}) written(text);
  Image image(30, 30);
  draw_text(image, -500, 10, "far to the left of the image", 20, {0, 0, 0});
  draw_text(image, 20, 1e5, "below", 20, {0, 0, 0});
  EXPECT_EQ(find_ink(image).ink, 0);
  draw_text(image, 20, 25, "WWWW", 40, {0, 0, 0});
  EXPECT_GT(find_ink(image).ink, 0);
}

TEST_F(ImageTest, BlackTextOnBlackStaysBlack) {
  Image image(60, 40, {0, 0, 0});
  draw_text(image, 5, 30, "ink", 20, {0, 0, 0});
  EXPECT_EQ(image.pixels, Image(60, 40, {0, 0, 0}).pixels);
}

}  // namespace
}  // namespace supple
