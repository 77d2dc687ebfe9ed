// What is drawn on a frame: where it lies, how long it is, that it shows over black and white.
#include "host/report/picture/overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace impactdic::report {
namespace {

struct Pixel {
  int b, g, r;
  int brightness() const { return (b + g + r) / 3; }
};

Pixel at(const ColourPicture& picture, int x, int y) {
  const std::size_t k = 3 * (static_cast<std::size_t>(y) * picture.width + x);
  return {picture.bgr[k], picture.bgr[k + 1], picture.bgr[k + 2]};
}

ColourPicture plain(int side, int grey) {
  return {side, side,
          std::vector<std::uint8_t>(static_cast<std::size_t>(3) * side * side,
                                    static_cast<std::uint8_t>(grey))};
}

Frame frame_of(int side, int grey) {
  Frame frame;
  frame.type = PixelType::kU8;
  frame.u8 = Image<std::uint8_t>(side, side);
  std::fill(frame.u8.data(), frame.u8.data() + frame.u8.size(), static_cast<std::uint8_t>(grey));
  return frame;
}

TrackRow ball(double cx, double cy, double r) {
  TrackRow row;
  row.status = TrackStatus::kOk;
  row.circle_ok = true;
  row.cx_px = cx;
  row.cy_px = cy;
  row.r_px = r;
  return row;
}

// Darkest and brightest of the pixels about the rim's rightmost point.
std::pair<int, int> extremes(const ColourPicture& picture, int x, int y) {
  int low = 255, high = 0;
  for (int dx = -6; dx <= 6; ++dx) {
    const Pixel p = at(picture, x + dx, y);
    low = std::min(low, p.brightness());
    high = std::max(high, std::max({p.b, p.g, p.r}));
  }
  return {low, high};
}

TEST(Overlay, CircleShowsOverBlackAndWhiteAtAnySize) {
  for (const int side : {280, 2000}) {
    for (const int grey : {0, 255}) {
      OverlayPainter painter(5, 0, 0);
      const double centre = side / 2.0, r = side / 4.0;
      const ColourPicture made =
          painter.paint(frame_of(side, grey), ball(centre, centre, r), {}, {}, 15);
      const auto [low, high] = extremes(made, static_cast<int>(centre + r), side / 2);
      EXPECT_LT(low, 60) << side << " over " << grey;
      EXPECT_GT(high, 200) << side << " over " << grey;
    }
  }
}

TEST(Overlay, AnEllipseIsDrawnWhereOneWasFitted) {
  TrackRow row = ball(100, 100, 50);
  // Long along the diagonal that goes down to the right: 60 px there and 40 px across.
  row.e1_px = 0;
  row.e2_px = 10;
  const ColourPicture made = OverlayPainter(5, 0, 0).paint(frame_of(200, 0), row, {}, {}, 15);
  const auto coloured_at = [&](double radius, double x, double y) {
    int most = 0;
    for (double r = radius - 1; r <= radius + 1; r += 0.5) {
      const Pixel p = at(made, static_cast<int>(std::lround(100 + r * x)),
                         static_cast<int>(std::lround(100 + r * y)));
      most = std::max({most, p.b, p.g, p.r});
    }
    return most > 80;  // of 255, shared among neighbours where it passes between them
  };
  const double s = std::sqrt(0.5);
  EXPECT_TRUE(coloured_at(60, s, s) && coloured_at(60, -s, -s));
  EXPECT_TRUE(coloured_at(40, s, -s) && coloured_at(40, -s, s));
  EXPECT_FALSE(coloured_at(50, s, s) || coloured_at(50, s, -s));
}

TEST(Overlay, ArrowsAreAsLongAsTheyAreScaled) {
  TrackRow row = ball(100, 100, 60);
  row.motion_ok = true;
  row.dx_px = 8;
  row.dy_px = 0;
  OverlayPainter painter(5, 0, 0);
  const ColourPicture made = painter.paint(frame_of(200, 0), row, {}, {}, 15);
  // The head ends at 100 + 5 · 8: coloured up to there, black behind.
  EXPECT_GT(at(made, 137, 100).brightness(), 60);
  EXPECT_LT(at(made, 145, 100).brightness(), 40);
}

TEST(Overlay, TheFirstMotionSetsTheScaleOfArrows) {
  TrackRow row = ball(100, 100, 60);
  OverlayPainter painter(0, 0, 0);
  painter.paint(frame_of(200, 0), row, {}, {}, 15);  // no motion yet
  row.motion_ok = true;
  row.dx_px = 1.7;
  row.dy_px = 0;
  const ColourPicture made = painter.paint(frame_of(200, 0), row, {}, {}, 15);
  EXPECT_EQ(painter.arrow_scale(), 10);  // 0.3 · 60 px over 1.7 px, rounded to 1, 2 or 5
  EXPECT_GT(at(made, 115, 100).brightness(), 60);
  EXPECT_LT(at(made, 121, 100).brightness(), 40);
  row.dx_px = 0.1;
  painter.paint(frame_of(200, 0), row, {}, {}, 15);
  EXPECT_EQ(painter.arrow_scale(), 10);  // once and for all
  const std::vector<TrackRow> earlier = {row};
  EXPECT_EQ(OverlayPainter(0, 0, 0, earlier).arrow_scale(), 20);  // a ball at rest: no more
}

TEST(Overlay, ManyWindowsAreThinned) {
  std::vector<Window> windows;
  std::vector<WindowMotion> field;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      Window window{};
      window.x0 = 20 + 6 * x;
      window.y0 = 20 + 6 * y;
      windows.push_back(window);
      WindowMotion motion{};
      motion.u = 1;
      motion.status = static_cast<idic_int>(WindowStatus::kOk);
      field.push_back(motion);
    }
  }
  TrackRow row;
  OverlayPainter painter(4, 0, 0);
  const ColourPicture made = painter.paint(frame_of(400, 0), row, windows, field, 15);
  int coloured = 0;
  for (int y = 40; y < 380; ++y) {
    for (int x = 10; x < 390; ++x) coloured += at(made, x, y).brightness() > 60;
  }
  EXPECT_GT(coloured, 100);
  EXPECT_LT(coloured, 200 * 20);  // 3600 arrows would have covered all of it
}

TEST(Overlay, ScaleBarIsAsLongAsItSays) {
  ColourPicture picture = plain(400, 128);
  write_scale(picture, {0.5, 0, 1});  // at most 64 px, 32 mm: 20 mm, which are 40 px
  int longest = 0;
  for (int y = 0; y < 20; ++y) {
    int run = 0;
    for (int x = 0; x < 400; ++x) {
      run = at(picture, x, y).brightness() > 200 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_NEAR(longest, 41, 2);
  EXPECT_EQ(at(picture, 398, 1).brightness(), 20);   // on a ground of its own
  EXPECT_EQ(at(picture, 10, 10).brightness(), 128);  // and nowhere else
}

TEST(Overlay, TextGrowsWithThePicture) {
  const auto ground = [](int side) {
    ColourPicture picture = plain(side, 128);
    write_label(picture, {"1.00 ms", "vt"});
    int height = 0;
    while (height < side && at(picture, 1, side - 1 - height).brightness() < 60) ++height;
    return height;
  };
  EXPECT_GE(ground(280), 24);       // two lines of at least 10 px
  EXPECT_GE(ground(2000), 2 * 35);  // of at least 35
  EXPECT_LE(ground(2000), 2000 / 10);
}

}  // namespace
}  // namespace impactdic::report
