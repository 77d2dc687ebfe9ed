// The parts of the page's server that need no socket: who may ask, pictures as bytes,
// settings as a job.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <nlohmann/json.hpp>

#include "host/view/address_check.h"
#include "host/view/shot.h"
#include "host/view/track_job.h"

namespace impactdic::view {
namespace {

TEST(View, TokensAreLongAndNeverTheSame) {
  const std::string one = random_token(), other = random_token();
  EXPECT_EQ(one.size(), 32u);
  EXPECT_EQ(one.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(one, other);
}

TEST(View, OnlyThisMachinesNamesAreHosts) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "localhost", "localhost:1"}) {
    EXPECT_TRUE(is_own_host(host)) << host;
  }
  for (const char* host : {"", ":80", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:123456", "127.0.0.10",
                           "localhost.evil.example", "evil.example", "LOCALHOST", "[::1]:80",
                           "127.0.0.1 ", "127.0.0.1:80:80"}) {
    EXPECT_FALSE(is_own_host(host)) << host;
  }
  EXPECT_TRUE(is_own_origin("http://127.0.0.1:8080"));
  for (const char* origin : {"", "null", "https://127.0.0.1", "http://evil.example", "127.0.0.1"}) {
    EXPECT_FALSE(is_own_origin(origin)) << origin;
  }
}

TEST(View, APathHasTheWholeToken) {
  EXPECT_EQ(behind_token("/abcd/", "abcd"), "");
  EXPECT_EQ(behind_token("/abcd/api/state", "abcd"), "api/state");
  EXPECT_EQ(behind_token("/abcd//x", "abcd"), "/x");
  for (const char* path :
       {"", "/", "/abcd", "/abc/", "/abce/", "/abcde/", "//abcd/", "abcd/", "/ABCD/"}) {
    EXPECT_FALSE(behind_token(path, "abcd")) << path;
  }
  EXPECT_FALSE(behind_token("//x", ""));
}

Frame ramp(int width, int height, int bits) {
  Frame frame;
  frame.reset(width, height, bits);
  for (int i = 0; i < width * height; ++i) {
    if (bits <= 8) {
      frame.u8.data()[i] = static_cast<std::uint8_t>(i);
    } else {
      frame.u16.data()[i] = static_cast<std::uint16_t>(16 * i);
    }
  }
  return frame;
}

TEST(View, PicturesAreStretchedBetweenTheirLevels) {
  const Frame deep = ramp(16, 16, 12);  // 0, 16, …, 4080
  const std::string bytes = bytes_of_picture(deep, {1600, 3200}, 1);
  ASSERT_EQ(bytes.size(), 256u);
  EXPECT_EQ(static_cast<unsigned char>(bytes[0]), 0);
  EXPECT_EQ(static_cast<unsigned char>(bytes[100]), 0);
  EXPECT_EQ(static_cast<unsigned char>(bytes[150]), 128);  // (2400 - 1600) / 1600 of 255, rounded
  EXPECT_EQ(static_cast<unsigned char>(bytes[200]), 255);
  EXPECT_EQ(static_cast<unsigned char>(bytes[255]), 255);
}

TEST(View, ShrunkPicturesAreMeansOfWholeBlocks) {
  const Frame small = ramp(5, 5, 8);
  const std::string bytes = bytes_of_picture(small, {0, 255}, 2);
  ASSERT_EQ(bytes.size(), 4u);
  EXPECT_EQ(bytes[0], (0 + 1 + 5 + 6) / 4);
  EXPECT_EQ(bytes[3], (12 + 13 + 17 + 18) / 4);
}

TEST(View, ContrastLeavesOutTheDarkestAndTheBrightestPixels) {
  Frame frame;
  frame.reset(100, 100, 8);
  for (int i = 0; i < 10000; ++i) frame.u8.data()[i] = static_cast<std::uint8_t>(50 + i % 100);
  for (int i = 0; i < 10; ++i) frame.u8.data()[i] = 0, frame.u8.data()[9999 - i] = 255;
  const Contrast contrast = stretched_contrast(frame);
  EXPECT_EQ(contrast.black, 50);
  EXPECT_EQ(contrast.white, 149);
  frame.reset(4, 4, 8);
  std::fill_n(frame.u8.data(), 16, std::uint8_t{7});  // nothing to stretch
  EXPECT_GT(stretched_contrast(frame).white, stretched_contrast(frame).black);
}

ClipRequest clip_named(const std::string& name) {
  ClipRequest clip;
  clip.paths = {name};
  return clip;
}

TEST(View, SettingsBecomeARequest) {
  const nlohmann::json settings = {{"ball-diameter-mm", "67"}, {"surface-angle-deg", 15.5},
                                   {"roi", "1,2,30,40"},       {"no-field", true},
                                   {"estimator", "field"},     {"window", ""},
                                   {"spacing", nullptr}};
  const TrackJob job = read_job(settings, clip_named("shot.cine"));
  EXPECT_EQ(job.request.ball_diameter_mm, 67);
  EXPECT_EQ(job.request.surface_angle_deg, 15.5);
  ASSERT_TRUE(job.request.roi);
  EXPECT_EQ(job.request.roi->height, 40);
  EXPECT_FALSE(job.request.with_field);
  EXPECT_EQ(job.request.estimator, Estimator::kField);
  EXPECT_EQ(job.request.field.window_px, FieldOptions().window_px);
}

TEST(View, WrongSettingsAreRefused) {
  for (const char* text :
       {R"({"unknown": 1})", R"({"video": "x"})", R"({"window": "wide"})", R"({"window": [15]})",
        R"({"no-field": "perhaps"})", R"({"roi": "1,2,3"})", R"({"ball-diameter-mm": -1})",
        R"({"device": "cpu"})", "[]", "7"}) {
    EXPECT_THROW(read_job(nlohmann::json::parse(text), clip_named("shot.cine")), InvalidArgument)
        << text;
  }
}

TEST(View, TheCommandHoldsWhatIsGivenAndQuotesIt) {
  TrackJob job = read_job({{"window", 21}, {"no-field", true}, {"body", "auto"}},
                          clip_named("it's a `clip`.cine"));
  job.folder.folder = "$HOME";
  EXPECT_EQ(command_line(job),
            "impactdic track 'it'\\''s a `clip`.cine' -o '$HOME' --no-field --window 21");
  EXPECT_EQ(given_settings(job).size(), 2u);
}

TEST(View, EverySettingIsDescribed) {
  const nlohmann::json all = describe_settings();
  EXPECT_GT(all.size(), 25u);
  for (const nlohmann::json& setting : all) {
    EXPECT_FALSE(setting["help"].get<std::string>().empty()) << setting["key"];
  }
}

}  // namespace
}  // namespace impactdic::view
