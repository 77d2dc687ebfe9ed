// Which frames and which part of the picture: --frames and --roi.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include "host/clip/frame_range.h"
#include "host/clip/roi.h"

namespace impactdic {
namespace {

TEST(FrameRange, PartsMayBeLeftOut) {
  EXPECT_EQ(parse_frame_range("", 20).count(), 20);
  EXPECT_EQ(parse_frame_range("5:", 20).first, 5);
  EXPECT_EQ(parse_frame_range(":5", 20).count(), 5);
  const FrameRange range = parse_frame_range("3:100:4", 20);
  EXPECT_EQ(range.count(), 5);  // 3 7 11 15 19
  EXPECT_EQ(range.at(4), 19);
}

TEST(FrameRange, EmptyAndWrongOnesAreRefused) {
  for (const char* text : {"20:", "5:5", "7:3", "-1:5", "1:5:0", "1", "1:2:3:4", "a:b"}) {
    EXPECT_THROW(parse_frame_range(text, 20), InvalidArgument) << text;
  }
}

TEST(Roi, MustLieInThePicture) {
  const Roi whole = parse_roi("", 64, 48);
  EXPECT_EQ(whole.width, 64);
  EXPECT_EQ(parse_roi("1,2,63,46", 64, 48).y, 2);
  for (const char* text : {"0,0,65,48", "1,0,64,48", "-1,0,5,5", "0,0,0,5", "0,0,5", "0,0,5,x",
                           "9223372036854775807,0,5,5"}) {
    EXPECT_THROW(parse_roi(text, 64, 48), InvalidArgument) << text;
  }
}

TEST(Roi, CropKeepsDepthAndPlace) {
  Frame frame;
  frame.reset(5, 4, 12);
  for (std::size_t i = 0; i < frame.u16.size(); ++i) {
    frame.u16.data()[i] = static_cast<std::uint16_t>(100 * i);
  }
  Frame cut;
  crop(frame, {1, 2, 3, 2}, cut);
  EXPECT_EQ(cut.bits, 12);
  EXPECT_EQ(cut.u16(0, 0), frame.u16(1, 2));
  EXPECT_EQ(cut.u16(2, 1), frame.u16(3, 3));
}

TEST(Polygon, HoldsThePixelsWhoseCentresLieInside) {
  // An L: the rectangle 10 … 29 × 5 … 24 without its right upper quarter.
  const Image<std::uint8_t> mask =
      parse_polygon("9.5,4.5,19.5,4.5,19.5,14.5,29.5,14.5,29.5,24.5,9.5,24.5", 64, 48);
  int count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) count += mask.data()[i];
  EXPECT_EQ(count, 300);
  EXPECT_EQ(mask(10, 5), 1);
  EXPECT_EQ(mask(20, 5), 0);
  EXPECT_EQ(mask(20, 15), 1);
  const Roi box = extent(mask);
  EXPECT_EQ(box.x, 10);
  EXPECT_EQ(box.y, 5);
  EXPECT_EQ(box.width, 20);
  EXPECT_EQ(box.height, 20);
  for (const char* text : {"", "1,2,3,4", "1,2,3,4,5,6,7", "a,b,c,d,e,f", "70,1,90,1,80,9"}) {
    EXPECT_THROW(parse_polygon(text, 64, 48), InvalidArgument) << text;
  }
}

}  // namespace
}  // namespace impactdic
