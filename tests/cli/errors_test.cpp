// A wrong request or a broken file gives one line and the right exit status.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/data.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

void expect_one_line(const std::string& arguments, int status, const std::string& says) {
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
  EXPECT_EQ(outcome.err.rfind("impactdic: error: ", 0), 0u) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
  EXPECT_TRUE(outcome.out.empty()) << outcome.out;
}

// A small 8-bit clip of grey noise as bare pixels.
std::string write_raw(const ScratchFolder& folder, int frames) {
  std::ofstream file(folder / "noise.raw", std::ios::binary);
  unsigned state = 1;
  for (int i = 0; i < frames * 64 * 48; ++i) {
    state = state * 1664525u + 1013904223u;
    file.put(static_cast<char>(state >> 24));
  }
  return quoted(folder / "noise.raw");
}

TEST(Errors, NoBallInAnyFrameExitsOne) {
  const ScratchFolder folder;
  std::ofstream(folder / "grey.raw", std::ios::binary) << std::string(5 * 64 * 48, '\x40');
  const Outcome outcome = run_program("track " + quoted(folder / "grey.raw") +
                                      " --raw 64x48x8 --fps 100 -q -o " + quoted(folder / "out"));
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("no ball was found in any frame"), std::string::npos) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/track.csv"));
}

TEST(Errors, WrongRequestsExitTwo) {
  const ScratchFolder folder;
  const std::string clip = write_raw(folder, 3) + " --raw 64x48x8";
  const std::string out = " -o " + quoted(folder / "out");
  expect_one_line("", 2, "no command given");
  expect_one_line("trak", 2, "trak");
  expect_one_line("track", 2, "--help");
  expect_one_line("track " + clip + out + " --windw 15", 2, "--windw");
  expect_one_line("track " + clip + out + " --window 1000", 2, "--window");
  expect_one_line("track " + clip + out + " --window nine", 2, "--window");
  expect_one_line("track " + clip + out + " --frames 5:9", 2, "0:3");
  expect_one_line("track " + clip + out + " --frames 1", 2, "A:B");
  expect_one_line("track " + clip + out + " --roi 0,0,65,48", 2, "64x48");
  expect_one_line("track " + clip + out + " --radius-px 9:4", 2, "--radius-px");
  expect_one_line("track " + clip + out + " --device 77", 2, "--device");
  expect_one_line("track " + clip + out + " --estimator guess", 2, "--estimator");
  expect_one_line("track " + clip + out + " --method guess", 2, "--method");
  expect_one_line("track " + clip + out + " --method equal", 2, "16 or 32 px");
  expect_one_line("track " + clip + out + " --fps -3", 2, "--fps");
  expect_one_line("track " + clip + out + " --mm-per-px 0.5 --ball-diameter-mm 5 --fps 9", 2,
                  "one of");
  expect_one_line("track " + clip + out + " --mm-per-px 0.5", 2, "--fps");
  expect_one_line("track " + clip + out + " --fps nan", 2, "--fps");
  expect_one_line("track " + clip + out + " --fps 0", 2, "must be positive, not 0");
  expect_one_line("track " + clip + out + " --ball-diameter-mm nan --fps 9", 2, "positive");
  expect_one_line("track " + clip + out + " --surface-angle-deg inf", 2, "--surface-angle-deg");
  expect_one_line("track " + clip + out + " --spacing -1", 2, "--spacing");
  expect_one_line("track " + clip + " -o ''", 2, "--output");
  expect_one_line("correlate " + clip + out + " --fps nan", 2, "--fps");
  expect_one_line("correlate " + clip + out + " --spacing -2", 2, "--spacing");
  expect_one_line("synth --rotation-deg nan" + out, 2, "--rotation-deg");
  expect_one_line("synth --seed -1" + out, 2, "--seed");
  expect_one_line("batch " + quoted(folder / ".") + out + " --window 1", 2, "--window");
  expect_one_line("correlate " + clip + out + " --reference last", 2, "--reference");
  expect_one_line("correlate " + clip + out + " --roi 0,0,10,10", 2, "no interrogation window");
  expect_one_line("track " + quoted(folder / "noise.raw") + out + " --raw 64x48", 2, "64x48");
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Errors, UnreadableFilesExitOne) {
  const ScratchFolder folder;
  const std::string out = " -o " + quoted(folder / "out");
  expect_one_line("info " + quoted(folder / "none.cine"), 1, "none.cine");
  std::ofstream(folder / "empty.cine");
  expect_one_line("info " + quoted(folder / "empty.cine"), 1, "empty.cine");
  std::ofstream(folder / "text.mraw") << "hello";
  expect_one_line("track " + quoted(folder / "text.mraw") + out, 1, "text");
  expect_one_line("track " + write_raw(folder, 2) + " --raw 4000x4000x16" + out, 1, "noise.raw");
  std::ofstream(folder / "a.tif") << "II*";
  expect_one_line("info " + quoted(folder / "a.tif") + " b.tif", 1, "b.tif");
  std::ofstream(folder / "empty.toml");
  expect_one_line("simulate " + quoted(folder / "empty.toml") + out, 2, "empty.toml");
}

// A limit on the size of files fails writes as a full disk does.
TEST(Errors, AFullDiskExitsOne) {
  const ScratchFolder folder;
  ASSERT_EQ(run_program("synth --size 96x96 --radius-px 30 --frames 8 --noise 1 -o " +
                        quoted(folder / "clip"))
                .status,
            0);
  for (const char* command : {"track", "correlate"}) {
    const std::string arguments = std::string(command) + " " + quoted(folder / "clip/video.tif") +
                                  " --force -q -o " + quoted(folder / command);
    ASSERT_EQ(run_program(arguments).status, 0);  // the kernels are compiled
    const std::string script = std::string("trap '' XFSZ; ulimit -f 4000; ") + IMPACTDIC_PROGRAM +
                               " " + arguments + " 2> " + quoted(folder / "err");
    const int raw = std::system(script.c_str());
    ASSERT_TRUE(WIFEXITED(raw)) << command;
    EXPECT_EQ(WEXITSTATUS(raw), 1) << command;
    const std::string said = read_text(folder / "err");
    EXPECT_NE(said.find("is the disk full?"), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
}

// What the system sends a program that looks at lent bytes of a file which became shorter.
TEST(Errors, AFileLostWhileItIsReadExitsOne) {
  const ScratchFolder folder;
  const std::string clip = quoted(folder / "clip/video.mraw"), err = quoted(folder / "err");
  const std::string synth =
      std::string(IMPACTDIC_PROGRAM) +
      " synth --size 64x64 --radius-px 20 --frames 1000000 --format mraw -q -o " +
      quoted(folder / "clip") + " 2> " + err;
  const int raw = std::system((synth + " & program=$!; while kill -0 $program && [ ! -s " + clip +
                               " ]; do sleep 0.05; done; kill -BUS $program; wait $program")
                                  .c_str());
  EXPECT_EQ(WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, 1);
  const std::string says = read_text(folder / "err");
  EXPECT_EQ(says.rfind("impactdic: error: a file could no longer be read", 0), 0u) << says;
  EXPECT_EQ(std::count(says.begin(), says.end(), '\n'), 1) << says;
}

TEST(Errors, OutputFolderWithFilesIsRefusedUnlessForced) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "out");
  std::ofstream(folder / "out/precious.txt") << "mine";
  const std::string request =
      "correlate " + write_raw(folder, 2) + " --raw 64x48x8 -o " + quoted(folder / "out");
  expect_one_line(request, 2, "not empty");
  EXPECT_EQ(run_program(request + " --force").status, 0);
  EXPECT_EQ(read_text(folder / "out/precious.txt"), "mine");
}

TEST(Errors, AnEarlierRunIsKeptUntilTheNextHasItsDevice) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "out");
  std::ofstream(folder / "out/track.csv") << "measured";
  const std::string request =
      "track " + write_raw(folder, 2) + " --raw 64x48x8 --force -o " + quoted(folder / "out");
  expect_one_line(request + " --device 77", 2, "77");
  EXPECT_EQ(read_text(folder / "out/track.csv"), "measured");
}

TEST(Errors, OneProcessForCodecsOrNone) {
  const ScratchFolder folder;
  expect_one_line("info " + write_raw(folder, 2) + " --sandbox --no-sandbox", 2, "--no-sandbox");
}

TEST(Errors, JobFilesAreChecked) {
  const ScratchFolder folder;
  const std::string clip = write_raw(folder, 2) + " --raw 64x48x8 -o " + quoted(folder / "out");
  std::ofstream(folder / "typo.toml") << "windw = 15\n";
  expect_one_line("correlate " + clip + " --job " + quoted(folder / "typo.toml"), 2, "windw");
  std::ofstream(folder / "broken.toml") << "window = = 15\n";
  expect_one_line("correlate " + clip + " --job " + quoted(folder / "broken.toml"), 2, "line 1");
  expect_one_line("correlate " + clip + " --job " + quoted(folder / "none.toml"), 1, "none.toml");
  std::ofstream(folder / "value.toml") << "window = 1000\n";
  expect_one_line("correlate " + clip + " --job " + quoted(folder / "value.toml"), 2, "--window");
}

TEST(Help, EveryCommandHasAnExample) {
  for (const char* command : {"devices", "info", "track", "correlate", "synth"}) {
    const Outcome outcome = run_program(std::string(command) + " --help");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find(std::string("impactdic ") + command), std::string::npos) << command;
    EXPECT_NE(outcome.out.find("Example"), std::string::npos) << command;
  }
}

}  // namespace
}  // namespace impactdic::testing
