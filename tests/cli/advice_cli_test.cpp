// The look at a clip before a long run: each warning on a clip that deserves it, none on a good
// one.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "host/video/frame_sink.h"
#include "host/video/frame_source.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

constexpr const char* kScale = " --fps 10000 --ball-diameter-mm 67 --no-field";

class Clip {
 public:
  explicit Clip(const std::string& synth, const std::string& file = "video.tif") : file_(file) {
    const Outcome outcome = run_program("synth -q --frames 3 " + synth + " -o " + folder());
    if (outcome.status != 0) throw std::runtime_error(outcome.err);
  }
  std::filesystem::path path() const { return scratch_ / ("clip/" + file_); }
  std::string folder() const { return quoted(scratch_ / "clip"); }
  // What `track` (or another command) says of it on stderr, and in summary.json. `status`: 1 where
  // no frame shows a ball.
  std::string warnings(const std::string& options, const std::string& command = "track",
                       int status = 0) const {
    const Outcome outcome = run_program(command + " " + quoted(path()) + options + " --force -o " +
                                        quoted(scratch_ / "out"));
    EXPECT_EQ(outcome.status, status) << outcome.err;
    const auto summary = nlohmann::json::parse(read_text(scratch_ / "out/summary.json"));
    for (const auto& warning : summary["warnings"]) {
      EXPECT_NE(outcome.err.find("impactdic: warning: " + warning.get<std::string>() + "\n"),
                std::string::npos);
    }
    return summary["warnings"].dump();
  }

 private:
  ScratchFolder scratch_;
  std::string file_;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The demo's clip, as the demo runs it.
TEST(Advice, NothingToSayOfAGoodClip) {
  const Clip clip("--velocity-px 1,1 --rotation-deg 3");
  EXPECT_EQ(clip.warnings(" --fps 10000 --ball-diameter-mm 67"), "[]");
}

TEST(Advice, InfoSaysWhatTheTextureLetsBeMeasured) {
  const Clip clip("--noise 2");
  const Outcome outcome = run_program("info " + quoted(clip.path()) + " --error-px 0.003");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.out, " windows of 15 px, 100 % usable, 0.005")) << outcome.out;
  EXPECT_TRUE(has(outcome.out, "31 px reach 0.003 px a window")) << outcome.out;
  EXPECT_TRUE(has(outcome.out, "whole ball")) << outcome.out;
  EXPECT_FALSE(has(outcome.out, "warning")) << outcome.out;
}

// A few frames cannot tell what moves; the windows that ask for coarse texture reach the ball's
// rim.
TEST(Advice, InfoFindsALargeBallInFewFrames) {
  const Clip clip("--size 128x120 --radius-px 36 --velocity-px 2,1");
  const Outcome outcome = run_program("info " + quoted(clip.path()));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.out, "\nball             radius 36.")) << outcome.out;
}

// The one ball is the first candidate, drawn into a picture; there is no second one to ask for.
TEST(Advice, CandidatesAreListedAndDrawn) {
  const Clip clip("--size 160x160 --radius-px 50 --velocity-px 2,0 --pattern a1");
  const std::filesystem::path folder = clip.path().parent_path() / "looked";
  const Outcome seen =
      run_program("info " + quoted(clip.path()) + " --candidates -o " + quoted(folder));
  ASSERT_EQ(seen.status, 0) << seen.err;
  EXPECT_TRUE(has(seen.out, "candidate 1      radius 50.")) << seen.out;
  EXPECT_TRUE(has(seen.out, " in frame ")) << seen.out;
  EXPECT_FALSE(has(seen.out, "candidate 2")) << seen.out;
  std::ifstream png(folder / "key_frames" / "candidates.png", std::ios::binary);
  std::string head(4, ' ');
  png.read(head.data(), 4);
  EXPECT_EQ(head, "\x89PNG");
  const Outcome second = run_program("track " + quoted(clip.path()) + " --no-field --ball 2 -o " +
                                     quoted(clip.path().parent_path() / "second"));
  EXPECT_EQ(second.status, 2);
  EXPECT_TRUE(has(second.err, "only 1 ball is seen (--ball 2)")) << second.err;
}

TEST(Advice, MissingScale) {
  const Clip clip("--size 160x160 --radius-px 50");
  EXPECT_TRUE(has(clip.warnings(" --no-field"), "no scale is given"));
  EXPECT_FALSE(has(clip.warnings(kScale), "no scale is given"));
}

TEST(Advice, ContainerRateIsNotTheRecordings) {
  const Clip clip("--size 160x160 --radius-px 50 --fps 25 --format avi", "video.avi");
  EXPECT_TRUE(has(clip.warnings(" --mm-per-px 1 --no-field"), "25 frames/s"));
  EXPECT_FALSE(has(clip.warnings(kScale), "frames/s"));
}

TEST(Advice, OverExposed) {
  const Clip clip("--size 160x160 --radius-px 50 --white 255 --noise 4");
  EXPECT_TRUE(has(clip.warnings(kScale), "100 % of the frames looked at are over-exposed"));
}

TEST(Advice, Blurred) {
  const Clip clip("--size 160x160 --radius-px 50 --pattern a1 --blur 3");
  EXPECT_TRUE(has(clip.warnings(kScale), "100 % of the frames looked at are blurred"));
}

TEST(Advice, BallLargerThanThePicture) {
  const Clip cut("--size 170x170 --radius-px 95");
  EXPECT_TRUE(has(cut.warnings(kScale), "larger than the picture")) << cut.warnings(kScale);
  const Clip within("--size 120x120 --radius-px 110");
  const std::string said = within.warnings(kScale, "track", 1);
  EXPECT_TRUE(has(said, "is the ball larger than the picture?")) << said;
}

TEST(Advice, TooLittleTextureNamesABetterPattern) {
  const Clip clip("--size 220x220 --radius-px 90 --pattern d1 --noise 2");
  const std::string said = clip.warnings(" --fps 1 --mm-per-px 1");
  EXPECT_TRUE(has(said, "of the 15-px windows have texture enough")) << said;
  EXPECT_TRUE(has(said, "(a2, f1, e1)")) << said;
}

TEST(Advice, TurnBeyondTheSearch) {
  const Clip clip("--size 220x220 --radius-px 90 --rotation-deg 12");
  const std::string scale = " --fps 1 --mm-per-px 1";
  const std::string said = clip.warnings(scale + " --estimator field");
  EXPECT_TRUE(has(said, "turns by about 12.0 deg a frame")) << said;
  EXPECT_TRUE(has(said, "--search 19 would do")) << said;
  // The whole ball's registration finds any turn.
  EXPECT_FALSE(has(clip.warnings(scale), "--search"));
}

TEST(Advice, RegionMovesBeyondTheSearch) {
  const Clip clip("--size 220x220 --radius-px 90 --velocity-px 15,0");
  const std::string said = clip.warnings(" --roi 50,60,120,100", "correlate");
  EXPECT_TRUE(has(said, "moves by about 15 px a frame")) << said;
  EXPECT_TRUE(has(said, "--search 17 would do")) << said;
}

// Rows in turn from this frame and the next one.
TEST(Advice, Interlaced) {
  const Clip clip("--size 160x160 --radius-px 50 --velocity-px 4,0");
  const auto source = video::open_video({clip.path().string()}, {});
  ClipInfo info = source->info();
  const std::string woven = (clip.path().parent_path() / "woven.tif").string();
  info.path = woven;
  const auto sink = video::open_sink(woven, video::SinkFormat::kTiff, info);
  for (int k = 0; k + 1 < source->info().frame_count; ++k) {
    Frame even, odd;
    source->read(k, even);
    source->read(k + 1, odd);
    for (int y = 1; y < even.height(); y += 2) {
      std::copy_n(odd.u8.row(y), odd.width(), even.u8.row(y));
    }
    sink->write(even);
  }
  sink->finish();
  const Outcome outcome = run_program("track " + testing::quoted(woven) + kScale + " -o " +
                                      quoted(clip.path().parent_path() / "out"));
  EXPECT_TRUE(has(outcome.err, "warning: the frames are interlaced")) << outcome.err;
}

}  // namespace
}  // namespace impactdic::testing
