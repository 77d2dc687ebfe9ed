// The same results wherever the program runs: languages, time zones, homes, caches, processors,
// memory, names.
#include <gtest/gtest.h>

#include "host/base/address_sanitizer.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

class Plain {
 public:
  Plain() {
    run("",
        "synth --pattern e1 --size 96x96 --radius-px 28 --noise 1 --frames 12 "
        "--velocity-px 0.3,0.2 --rotation-deg 0.7 --fps 10000 -q -o " +
            quoted(folder_ / "made"));
    track("", folder_ / "made/video.tif", folder_ / "plain");
  }
  // In a shell, behind `before`. Throws where the program says no.
  static void run(const std::string& before, const std::string& arguments) {
    const ScratchFolder scratch;
    const std::string said = quoted(scratch / "said");
    const std::string command = before + " " + IMPACTDIC_PROGRAM + " " + arguments;
    const int raw = std::system(("( " + command + " ) > " + said + " 2>&1").c_str());
    if (raw != 0) throw std::runtime_error(command + ": " + read_text(scratch / "said"));
  }
  static void track(const std::string& before, const fs::path& video, const fs::path& out) {
    run(before, "track " + in_quotes(video) +
                    " --spacing 13 --fps 10000 --ball-diameter-mm 67.5 "
                    "--no-checksum -q -o " +
                    in_quotes(out));
  }
  // For a shell, whatever the name.
  static std::string in_quotes(const fs::path& path) {
    std::string text = "'";
    for (const char c : path.string()) text += c == '\'' ? "'\\''" : std::string(1, c);
    return text + "'";
  }
  void expect_same(const std::string& before, const std::string& out) const {
    ASSERT_NO_THROW(track(before, path("made/video.tif"), path(out)));
    expect_same_tables(path(out));
  }
  void expect_same_tables(const fs::path& out) const {
    for (const char* name : {"track.csv", "pose.csv"}) {
      const std::string table = read_text(out / name);
      EXPECT_FALSE(table.empty()) << name;
      EXPECT_EQ(table, read_text(path("plain") / name)) << out;
    }
  }
  fs::path path(const std::string& name) const { return folder_ / name; }

 private:
  ScratchFolder folder_;
};

const Plain& plain() {
  static const Plain made;
  return made;
}

// Numbers have points and times no zone. Where the language is not installed it is made; where it
// cannot be, the setting alone is tried.
TEST(Environments, ALanguageWithCommas) {
  const fs::path languages = plain().path("languages");
  fs::create_directories(languages);
  const std::string make =
      "localedef -i de_DE -f UTF-8 " + quoted(languages / "de_DE.UTF-8") + " > /dev/null 2>&1";
  const bool made = std::system(make.c_str()) == 0;
  const std::string language = "LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 TZ=Asia/Kathmandu ";
  const std::string before = language + (made ? "LOCPATH=" + quoted(languages) : "");
  plain().expect_same(before, "german");
  const std::string job = quoted(fs::path(IMPACTDIC_SOURCE_DIR) / "sim/jobs/racket_15.toml");
  for (const std::string& one : {std::string("LC_ALL=C"), before}) {
    const std::string out = one == before ? "by_german" : "by_plain";
    ASSERT_NO_THROW(Plain::run(one, "simulate " + job + " -q -o " + quoted(plain().path(out))));
  }
  EXPECT_EQ(read_text(plain().path("by_german") / "trajectory.csv"),
            read_text(plain().path("by_plain") / "trajectory.csv"));
}

// Neither a home nor a cache that can be written.
TEST(Environments, NoHomeAndAReadOnlyCache) {
  plain().expect_same("env -u HOME -u XDG_CACHE_HOME -u IMPACTDIC_CACHE_DIR", "homeless");
  plain().expect_same("IMPACTDIC_CACHE_DIR=/proc/impactdic", "read_only");
}

TEST(Environments, OneProcessor) { plain().expect_same("taskset -c 0", "one_processor"); }

TEST(Environments, FourGigabytes) {
  if (kAddressSanitizer) GTEST_SKIP() << "AddressSanitizer takes 16 TB of addresses for itself";
  plain().expect_same("ulimit -v 4000000;", "four_gigabytes");
}

TEST(Environments, NamesOfAnyKind) {
  const std::string longest(246, 'n');
  for (const std::string& name :
       {std::string("two words  and 'both \"quotes"), std::string("ünïcødé ✓ 球"), longest,
        std::string("-x=$(touch pwned);*?[a]"), std::string("of another age \xfc\xe4")}) {
    const fs::path clip = plain().path(name + ".tif"),
                   out = plain().path(name.substr(0, 200) + " out");
    fs::copy_file(plain().path("made/video.tif"), clip, fs::copy_options::overwrite_existing);
    ASSERT_NO_THROW(Plain::track("", clip, out)) << name;
    plain().expect_same_tables(out);
  }
  EXPECT_FALSE(fs::exists("pwned"));
}

}  // namespace
}  // namespace impactdic::testing
