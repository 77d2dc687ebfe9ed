// Pictures of different sizes as one clip: crops of one thing.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>

#include "tests/support/video.h"

namespace impactdic {
namespace {

using testing::random_frame;
using testing::ScratchFolder;

class PictureSizes : public ::testing::Test {
 protected:
  Frame add(const std::string& name, int width, int height, int bits) {
    const Frame frame = random_frame(width, height, bits, static_cast<std::uint32_t>(width));
    ClipInfo info;
    info.width = width;
    info.height = height;
    info.bits = bits;
    info.frame_count = 1;
    const std::string path = folder_.file(name + ".tif");
    auto sink = video::open_sink(path, video::SinkFormat::kTiff, info);
    sink->write(frame);
    sink->finish();
    return frame;
  }
  std::unique_ptr<FrameSource> open() const { return video::open_video({folder_.string()}); }

  ScratchFolder folder_;
};

template <typename T>
void expect_at_top_left(const Image<T>& canvas, const Image<T>& picture) {
  std::vector<T> border;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const bool inside = x > 0 && y > 0 && x < picture.width() - 1 && y < picture.height() - 1;
      if (!inside) border.push_back(picture(x, y));
    }
  }
  std::sort(border.begin(), border.end());
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      const bool is_picture = x < picture.width() && y < picture.height();
      ASSERT_EQ(canvas(x, y), is_picture ? picture(x, y) : border[border.size() / 2])
          << x << ", " << y;
    }
  }
}

TEST_F(PictureSizes, EachLiesAtTheTopLeftOfTheLargest) {
  const Frame first = add("a1", 30, 22, 8), second = add("a2", 24, 28, 8);
  const auto clip = open();
  EXPECT_EQ(clip->info().width, 30);
  EXPECT_EQ(clip->info().height, 28);
  EXPECT_TRUE(clip->info().sizes_differ);
  ASSERT_EQ(clip->info().warnings.size(), 1u);
  EXPECT_NE(clip->info().warnings[0].find("24 x 22 to 30 x 28"), std::string::npos);
  Frame frame;
  clip->read(1, frame);
  expect_at_top_left<std::uint8_t>(frame.u8, second.u8);
  clip->read(0, frame);
  expect_at_top_left<std::uint8_t>(frame.u8, first.u8);
}

TEST_F(PictureSizes, SixteenBits) {
  const Frame first = add("a1", 30, 22, 16);
  add("a2", 30, 28, 16);
  Frame frame;
  open()->read(0, frame);
  expect_at_top_left<std::uint16_t>(frame.u16, first.u16);
}

TEST_F(PictureSizes, AlikeOnesAreAsTheyWere) {
  const Frame first = add("a1", 30, 22, 8);
  add("a2", 30, 22, 8);
  const auto clip = open();
  EXPECT_FALSE(clip->info().sizes_differ);
  EXPECT_TRUE(clip->info().warnings.empty());
  Frame frame;
  clip->read(0, frame);
  EXPECT_TRUE(testing::same_pixels(frame, first));
}

TEST_F(PictureSizes, OtherDepthsAreRefused) {
  add("a1", 30, 22, 8);
  add("a2", 24, 22, 16);
  const auto clip = open();
  Frame frame;
  clip->read(0, frame);
  EXPECT_THROW(clip->read(1, frame), FormatError);
}

TEST_F(PictureSizes, DamagedOnesAreSaidWhenTheyAreRead) {
  add("a1", 30, 22, 8);
  add("a3", 24, 22, 8);
  testing::write_bytes(folder_ / "a2.tif", "II*", 3);
  const auto clip = open();
  EXPECT_EQ(clip->info().frame_count, 3);
  Frame frame;
  clip->read(0, frame);
  EXPECT_THROW(clip->read(1, frame), Error);
  clip->read(2, frame);
}

TEST_F(PictureSizes, ACanvasIsNoLargerThanAllowed) {
  add("a1", 300, 2, 8);
  add("a2", 2, 300, 8);
  OpenOptions options;
  options.max_megapixels = 0.05;
  EXPECT_THROW(video::open_video({folder_.string()}, options), FormatError);
}

}  // namespace
}  // namespace impactdic
