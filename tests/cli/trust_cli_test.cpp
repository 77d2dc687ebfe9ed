// From outside: interrupted and competing runs, damaged and hostile files, results that are
// checked.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/data.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

void expect_one_line(const std::string& arguments, int status, const std::string& says) {
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
  EXPECT_EQ(outcome.err.rfind("impactdic: error: ", 0), 0u) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
}

// Several batches of frames of a ball that moves steadily.
class LongClip {
 public:
  LongClip() {
    const Outcome made = run_program(
        "synth --pattern e1 --size 128x128 --radius-px 36 --noise 1 --format mraw --frames 300 "
        "--velocity-px 0.05,0.03 --rotation-deg 0.4 -q -o " +
        quoted(folder_ / "clip"));
    if (made.status != 0) throw std::runtime_error(made.err);
  }
  std::string command(const std::string& what, const std::string& out,
                      const std::string& options = "") const {
    return what + " " + quoted(folder_ / "clip/video.cihx") + " -q --spacing 11 -o " +
           quoted(folder_ / out) + " " + options;
  }
  fs::path path(const std::string& name) const { return folder_ / name; }
  // Of a run that had ended before it was interrupted: it is run again.
  static constexpr int kEnded = 99;
  // Starts the run, waits until it has written where it could be gone on with, and does `then` to
  // its process `$pid`, which stands still meanwhile; what the shell says of it goes to the file
  // `said`.
  int interrupt(const std::string& what, const std::string& out, const std::string& then) const {
    const std::string point = quoted(path(out) / "resume.json");
    // On a busy machine the run may have ended before this shell looks again.
    const std::string at_work =
        "kill -STOP $pid; while kill -0 $pid && ! grep -q '^State:.[TZ]' /proc/$pid/status; do "
        "sleep 0.01; done; grep -q '^State:.T' /proc/$pid/status || exit " +
        std::to_string(kEnded) + "; ";
    const std::string script = std::string(IMPACTDIC_PROGRAM) + " " + command(what, out) + " 2> " +
                               quoted(path("said")) + " & pid=$!; while kill -0 $pid && [ ! -e " +
                               point + " ]; do sleep 0.01; done; " + at_work + then;
    for (int attempt = 0; attempt < 10; ++attempt) {
      fs::remove_all(path(out));
      const int raw = std::system(("exec 2> /dev/null; " + script).c_str());
      const int status = WIFEXITED(raw) ? WEXITSTATUS(raw) : -1;
      if (status != kEnded) return status;
    }
    return kEnded;
  }

 private:
  ScratchFolder folder_;
};

const LongClip& clip() {
  static const LongClip made;
  return made;
}

std::int64_t next_row(const fs::path& folder) {
  return nlohmann::json::parse(read_text(folder / "resume.json"))["next_row"].get<std::int64_t>();
}

TEST(Interrupts, SigtermEndsARunThatCanBeGoneOnWith) {
  ASSERT_EQ(run_program(clip().command("track", "whole")).status, 0);
  // One that has measured its last frame when the signal comes ends as if there were none.
  const std::string ended = std::to_string(LongClip::kEnded);
  ASSERT_EQ(clip().interrupt(
                "track", "term",
                "kill -TERM $pid; kill -CONT $pid; wait $pid && exit " + ended + "; exit $?"),
            128 + 15);
  EXPECT_NE(read_text(clip().path("said")).find("--resume goes on"), std::string::npos);
  const auto summary = nlohmann::json::parse(read_text(clip().path("term/summary.json")));
  // What was on its way when the signal came may have been the rest.
  EXPECT_EQ(summary.value("cancelled", false), summary["frames_analysed"] < 300);
  ASSERT_EQ(run_program(clip().command("track", "term", "--resume")).status, 0);
  for (const char* name : {"track.csv", "pose.csv"}) {
    EXPECT_EQ(read_text(clip().path("whole") / name), read_text(clip().path("term") / name));
  }
}

TEST(Interrupts, CorrelateGoesOnToTheSameBytes) {
  for (const char* options : {"", "--reference previous"}) {
    const std::string what = std::string("correlate ") + options;
    ASSERT_EQ(run_program(clip().command(what, "moved", "--force")).status, 0);
    clip().interrupt(what, "cut", "kill -9 $pid; wait $pid; exit 0");
    const std::int64_t row = next_row(clip().path("cut"));
    EXPECT_GT(row, 0);
    const Outcome outcome = run_program(clip().command(what, "cut", "--resume"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(read_text(clip().path("moved/motion.csv")), read_text(clip().path("cut/motion.csv")));
  }
  expect_one_line(clip().command("correlate --reference previous --window 21", "cut", "--resume"),
                  2, "window");
}

TEST(Resume, WhatIsMeasuredIsNotMeasuredAgain) {
  ASSERT_EQ(run_program(clip().command("track", "again", "--force")).status, 0);
  const std::string before = read_text(clip().path("again/pose.csv"));
  ASSERT_EQ(
      run_program(clip().command("track", "again", "--resume --mm-per-px 0.5 --fps 0.1")).status,
      2);  // the rate says how frames follow each other
  ASSERT_EQ(run_program(clip().command("track", "again", "--resume --surface-angle-deg 20")).status,
            0);
  const auto summary = nlohmann::json::parse(read_text(clip().path("again/summary.json")));
  EXPECT_TRUE(summary["frames_per_s"].is_null());
  EXPECT_EQ(summary["surface_angle_deg"], 20);
  EXPECT_EQ(before, read_text(clip().path("again/pose.csv")));
}

// The tables of a version that did not write the last columns yet.
TEST(Resume, TablesOfAnOlderVersionAreGoneOnWith) {
  ASSERT_EQ(run_program(clip().command("track", "old", "--force --no-field")).status, 0);
  const fs::path table = clip().path("old/track.csv");
  const std::string now = read_text(table);
  std::string old, gone_on;
  for (std::size_t at = 0; at < now.size();) {
    const std::size_t end = now.find('\n', at);
    std::string line = now.substr(at, end - at);
    const auto drop = [&line](int columns) {
      for (int k = 0; k < columns; ++k) line.resize(line.rfind(','));
    };
    drop(4);  // how far the rim lies beside the centre
    const std::string by_hand = line.substr(line.rfind(','));
    drop(5);  // the ellipse, and what was corrected by hand
    gone_on += at == 0 ? now.substr(0, end + 1) : line + ",,,," + by_hand + ",,,,\n";
    old += line + "\n";
    at = end + 1;
  }
  std::ofstream(table) << old;
  const Outcome outcome = run_program(clip().command("track", "old", "--no-field --resume"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_text(table), gone_on);
}

// Frames corrected by hand: the run goes back to before them, and ends as one that knew of them.
TEST(Resume, ACorrectedRunGoesOnFromBeforeTheCorrection) {
  const auto track = [](const std::string& out, const std::string& options) {
    return run_program("track " + quoted(clip().path("clip/video.cihx")) + " --no-field -o " +
                       quoted(clip().path(out)) + " " + options);
  };
  ASSERT_EQ(track("corrected", "").status, 0);
  const auto expect_same = [&](const std::string& balls, const std::string& says) {
    const Outcome outcome = track("corrected", "--resume --ball-at " + balls);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE((outcome.out + outcome.err).find(says), std::string::npos) << outcome.err;
    ASSERT_EQ(track("knew", "--force --ball-at " + balls).status, 0);
    for (const char* name : {"track.csv", "job.toml"}) {
      EXPECT_EQ(read_text(clip().path("corrected") / name), read_text(clip().path("knew") / name))
          << balls << " " << name;
    }
  };
  // Batches are of 64 frames.
  expect_same("290:none", "measured again from frame 255 on");
  expect_same("270:70,65,36/290:none", "measured again from frame 255 on");
  expect_same("270:70,65,36", "measured again from frame 255 on");
  expect_same("3:none/270:70,65,36", "all frames are measured again");
  expect_one_line("track " + quoted(clip().path("clip/video.cihx")) +
                      " --no-field --resume --radius-px 30:40 --ball-at 3:none -o " +
                      quoted(clip().path("corrected")),
                  2, "radius-px");
}

TEST(Resume, ADamagedPointIsRefused) {
  ASSERT_EQ(run_program(clip().command("track", "damaged", "--force")).status, 0);
  const fs::path point = clip().path("damaged/resume.json");
  const std::string good = read_text(point);
  const std::string table = read_text(clip().path("damaged/track.csv"));
  const auto with = [&](const std::string& text) {
    std::ofstream(point) << text;
    std::ofstream(clip().path("damaged/track.csv")) << table.substr(0, table.size() - 100);
    expect_one_line(clip().command("track", "damaged", "--resume"), 1, "resume.json");
  };
  with(good.substr(0, good.size() / 2));
  with("{}");
  auto changed = nlohmann::json::parse(good);
  changed["next_row"] = 3;  // its digest no longer fits
  with(changed.dump());
  changed = nlohmann::json::parse(good);
  changed.erase("sha256");  // as older versions wrote it
  changed["keyframes"]["last"]["x_px"] = 1e300;
  with(changed.dump());
  changed["keyframes"]["last"].erase("x_px");  // what a version has that came later
  with(changed.dump());
  expect_one_line(clip().command("track", "damaged", "--resume"), 1, "another version");
}

TEST(Locks, TheSecondRunSaysWhoHoldsTheFolder) {
  // The second one while the first is at work: it is stopped, so that it does not end before.
  const std::string second =
      std::string(IMPACTDIC_PROGRAM) + " " + clip().command("track", "shared", "--force") + " 2> " +
      quoted(clip().path("second")) + "; said=$?; kill -CONT $pid; wait $pid || exit 1; " +
      // The first one may have been stopped behind its work, the folder given back.
      "[ $said != 0 ] || exit " + std::to_string(LongClip::kEnded) + "; [ $said = 1 ]";
  ASSERT_EQ(clip().interrupt("track", "shared", second), 0);
  EXPECT_NE(read_text(clip().path("second")).find("impactdic: error: process "), std::string::npos)
      << read_text(clip().path("second"));
  ASSERT_EQ(run_program(clip().command("track", "alone")).status, 0);
  EXPECT_EQ(read_text(clip().path("alone/track.csv")), read_text(clip().path("shared/track.csv")));
  EXPECT_FALSE(fs::exists(clip().path("shared/.impactdic.lock")));
}

TEST(Verify, TellsWhetherResultsAreWhatTheirRunWrote) {
  ASSERT_EQ(run_program(clip().command("track", "checked", "--force")).status, 0);
  const std::string command = "verify " + quoted(clip().path("checked"));
  const Outcome good = run_program(command);
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_NE(good.out.find("same     fields.h5"), std::string::npos) << good.out;
  const Outcome again = run_program(command + " -q --again");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.out.find("same     track.csv, measured again"), std::string::npos) << again.out;
  fs::resize_file(clip().path("checked/track.csv"), 1000);
  const Outcome bad = run_program(command);
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.out.find("cut off  track.csv"), std::string::npos) << bad.out;
  EXPECT_NE(bad.err.find("1 files are not"), std::string::npos) << bad.err;
  expect_one_line("verify " + quoted(clip().path("clip")), 1, "no digests");
  expect_one_line(command + " --only rod", 2, "--only");
}

// A table is corrected after its clips were measured: the clips need not be.
TEST(Batch, ACorrectedTableTakesEffectWithoutMeasuring) {
  const ScratchFolder folder;
  fs::create_directories(folder / "clips");
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(run_program("synth --size 160x160 --radius-px 40 --frames 6 --pattern e1 -q -o " +
                          quoted(folder / name))
                  .status,
              0);
    fs::rename(folder / name / "video.tif", folder / "clips" / (std::string(name) + ".tif"));
  }
  const auto batch = [&](const std::string& out, const std::string& angle,
                         const std::string& options) {
    std::ofstream(folder / "table.csv")
        << "file,surface_angle_deg,notes\na.tif," << angle << ",=1+1\n";
    return run_program("batch " + quoted(folder / "clips") + " --fps 10000 --ball-diameter-mm 67 " +
                       "-q --table " + quoted(folder / "table.csv") + " -o " +
                       quoted(folder / out) + " " + options);
  };
  ASSERT_EQ(batch("new", "30", "").status, 0);
  ASSERT_EQ(batch("old", "10", "").status, 0);
  const fs::path other = folder / "old/shots/b/track.csv";
  const auto untouched = fs::last_write_time(other);
  const std::string poses = read_text(folder / "old/shots/a/pose.csv");
  const Outcome outcome = batch("old", "30", "--resume");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name : {"shots.csv", "shots/a/track.csv", "shots/b/track.csv"}) {
    EXPECT_EQ(read_text(folder / "old" / name), read_text(folder / "new" / name)) << name;
  }
  EXPECT_EQ(fs::last_write_time(other), untouched);
  EXPECT_EQ(read_text(folder / "old/shots/a/pose.csv"), poses);
  const auto summary = nlohmann::json::parse(read_text(folder / "old/shots/a/summary.json"));
  EXPECT_TRUE(summary["frames_per_s"].is_null());  // nothing was measured
  EXPECT_NE(read_text(folder / "new/shots.csv").find(",'=1+1,"), std::string::npos);
  EXPECT_EQ(run_program("verify " + quoted(folder / "old")).status, 0);
  // What would have to be measured otherwise is not passed off as this request's.
  EXPECT_EQ(batch("old", "30", "--resume --window 21").status, 2);
}

TEST(Limits, SmallFilesThatAskForMuchAreRefused) {
  const ScratchFolder folder;
  std::string deep = "a";
  for (int i = 0; i < 60000; ++i) deep += ".a";
  std::ofstream(folder / "deep.toml") << deep << " = 1\n";
  const std::string job = quoted(folder / "deep.toml"), out = " -o " + quoted(folder / "out");
  expect_one_line("track --job " + job + out, 2, "nest deeper");
  expect_one_line("simulate " + job + out, 2, "nest deeper");
  expect_one_line("fit " + job + out, 2, "nest deeper");
  std::ofstream(folder / "large.pgm") << "P5 9000 9000 255\n";
  expect_one_line("info " + quoted(folder / "large.pgm"), 1, "--max-megapixels");
  expect_one_line("info " + quoted(folder / "large.pgm") + " --max-megapixels -1", 2, "positive");
  const Outcome raised =
      run_program("info " + quoted(folder / "large.pgm") + " --max-megapixels 100");
  EXPECT_EQ(raised.status, 1);  // its pixels are missing
  EXPECT_EQ(raised.err.find("--max-megapixels"), std::string::npos) << raised.err;
}

TEST(Limits, ACutPictureIsRefusedInOneLine) {
  const ScratchFolder folder;
  const std::string pixels(144, 'x'), grey(48, 'x');
  const std::string bmp = "BM" + std::string(8, '\0') + std::string("\x36\0\0\0\x28\0\0\0", 8) +
                          std::string("\x08\0\0\0\x06\0\0\0\x01\0\x18\0", 12) +
                          std::string(24, '\0') + pixels;
  const std::string pgm = "P5 8 6 255\n" + grey;
  for (const auto& [name, whole] : {std::pair("a.bmp", bmp), std::pair("a.pgm", pgm)}) {
    for (std::size_t left = 2; left < whole.size(); left += 7) {
      std::ofstream(folder / name, std::ios::binary) << whole.substr(0, left);
      expect_one_line("info " + quoted(folder / name), 1, "copied whole");
    }
    std::ofstream(folder / name, std::ios::binary) << whole;
    const Outcome outcome = run_program("info " + quoted(folder / name));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
}

TEST(Limits, FilesThatDidHarmAreRefused) {
  IMPACTDIC_NEED_DATA("faults");
  const auto file = [](const char* name) { return quoted(data_path("faults") / name); };
  expect_one_line("track --job " + file("dotted_keys.toml") + " -o /nowhere", 2, "nest deeper");
  for (const char* picture : {"bomb_10k_1bit.png", "bomb_10k_rgba16_header.png"}) {
    expect_one_line("info " + file(picture), 1, "--max-megapixels");
  }
  expect_one_line("info " + file("absurd_container.mp4"), 1, "how large its pictures are");
  expect_one_line("info " + file("dash_in_a_clip.mp4"), 1, "cannot be read");
}

}  // namespace
}  // namespace impactdic::testing
