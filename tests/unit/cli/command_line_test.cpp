// Names that are nearly right, numbers with units, help in groups.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

#include "host/cli/arguments.h"
#include "host/cli/compile_progress.h"
#include "host/cli/help.h"
#include "host/cli/nearest.h"
#include "host/cli/quantity.h"

namespace impactdic::cli {
namespace {

using Texts = std::vector<std::string>;

// A program with one command of many options.
struct Program {
  CLI::App app{"a program", "impactdic"};
  double diameter = 0, fps = 0, angle = 0;
  bool quiet = false;
  int window = 15;
  std::string output;
  Texts video;

  Program() {
    show_help_in_groups(app);
    CLI::App* track = app.add_subcommand("track", "The main job");
    track->add_option("video", video, "Clip");
    track->add_option("-o,--output", output, "Folder")->required();
    track->add_option("--ball-diameter-mm", diameter, "Diameter");
    track->add_option("--fps", fps, "Rate");
    track->add_option("--surface-angle-deg", angle, "Angle");
    track->add_option("--window", window, "Side");
    track->add_flag("-q,--quiet", quiet, "Errors only");
    for (const char* name : {"--camera", "--interp", "--method", "--max-sd", "--share", "--lag",
                             "--spacing", "--search", "--compress", "--body", "--live"}) {
      track->add_option(name, output, "More");
    }
    arrange(app);
  }
  void parse(const Texts& arguments) {
    Texts joined = join_units(app, arguments);
    std::reverse(joined.begin(), joined.end());
    app.parse(std::move(joined));
  }
};

TEST(Nearest, FindsWhatWasMeant) {
  const Texts known = {"ball-diameter-mm", "ball-diameter-sd-mm", "mm-per-px", "fps", "force",
                       "surface-angle-deg"};
  EXPECT_EQ(nearest("ball-diametre-mm", known), Texts{"ball-diameter-mm"});
  EXPECT_EQ(nearest("fsp", known), Texts{"fps"});  // two letters in each other's place
  EXPECT_EQ(nearest("diameter", known), (Texts{"ball-diameter-mm", "ball-diameter-sd-mm"}));
  EXPECT_EQ(nearest("surface-angle", known), Texts{"surface-angle-deg"});
  EXPECT_EQ(nearest("xyzzy", known), Texts{});
  EXPECT_EQ(did_you_mean({"a", "b", "c"}, "--"), "did you mean --a, --b or --c?");
  EXPECT_EQ(did_you_mean({}, "--"), "");
}

TEST(Arguments, TheMisspeltNameIsToldBeforeTheMissingOne) {
  const Program program;
  EXPECT_EQ(misspelt_name(program.app, {"track", "a.cine", "--ball-diametre-mm", "67"}),
            "there is no option --ball-diametre-mm: did you mean --ball-diameter-mm?");
  EXPECT_EQ(misspelt_name(program.app, {"trakc", "a.cine"}),
            "there is no command 'trakc': did you mean track?");
  EXPECT_EQ(misspelt_name(program.app, {"track", "-z"}), "there is no option -z");
  EXPECT_EQ(misspelt_name(program.app, {"track", "--quux=3"}), "there is no option --quux");
}

TEST(Arguments, ValuesAreNoNames) {
  const Program program;
  EXPECT_EQ(misspelt_name(program.app, {"track", "--surface-angle-deg", "-30", "-ofolder", "-"}),
            "");
  EXPECT_EQ(misspelt_name(program.app, {"track", "-o", "--strange-folder"}), "");
  EXPECT_EQ(misspelt_name(program.app, {"track", "-o", "x", "--", "--a-clip"}), "");
  EXPECT_EQ(misspelt_name(program.app, {}), "");
}

TEST(Quantity, UnitsAreThoseOfTheOption) {
  EXPECT_EQ(in_unit("6.7cm", "mm"), "67");
  EXPECT_EQ(in_unit("67 mm", "mm"), "67");
  EXPECT_EQ(in_unit("6.70", "mm"), "6.70");  // as it was typed
  EXPECT_EQ(in_unit("-2e1deg", "deg"), "-2e1");
  EXPECT_EQ(in_unit("1e3e", "mm"), std::nullopt);
  EXPECT_EQ(in_unit("30 kfps", "fps"), "30000");
  EXPECT_EQ(in_unit("30 mm", "fps"), std::nullopt);
  EXPECT_EQ(in_unit("mm", "mm"), std::nullopt);
  EXPECT_NEAR(std::stod(in_unit("3.14159265358979rad", "deg").value()), 180, 1e-10);
  EXPECT_EQ(unit_of("ball-diameter-mm"), "mm");
  EXPECT_EQ(unit_of("mm-per-px"), "");
  EXPECT_EQ(unit_of("overlay"), "");
}

TEST(Quantity, OptionsTakeThem) {
  Program program;
  program.parse({"track", "a.cine", "--ball-diameter-mm", "6.7cm", "--fps", "30", "kfps",
                 "--surface-angle-deg=-15°", "--window", "21px", "-o", "out"});
  EXPECT_EQ(program.diameter, 67);
  EXPECT_EQ(program.fps, 30000);
  EXPECT_EQ(program.angle, -15);
  EXPECT_EQ(program.window, 21);
  EXPECT_EQ(program.video, Texts{"a.cine"});
}

TEST(Quantity, AWrongUnitIsAnsweredWithTheOneWanted) {
  Program program;
  try {
    program.parse({"track", "a.cine", "--ball-diameter-mm", "67V", "-o", "out"});
    FAIL() << "67 V are no length";
  } catch (const CLI::ParseError& error) {
    EXPECT_NE(std::string(error.what()).find("must be a number in mm, not 67V"), std::string::npos)
        << error.what();
  }
}

TEST(HelpInGroups, ShowsWhatIsNeededEveryDay) {
  const Program program;
  const CLI::App* track = program.app.get_subcommand("track");
  const std::string daily = track->help(), all = track->help("", CLI::AppFormatMode::All);
  for (const char* text :
       {"Scale and axes:", "--ball-diameter-mm", "Results:", "--output", "video"}) {
    EXPECT_NE(daily.find(text), std::string::npos) << text;
    EXPECT_NE(all.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(daily.find("--interp"), std::string::npos);
  EXPECT_NE(all.find("--interp"), std::string::npos);
  EXPECT_NE(daily.find("11 more: impactdic track --help-all"), std::string::npos) << daily;
  EXPECT_EQ(all.find("more:"), std::string::npos);
}

// Two kernels a second, ten in all, into a log that is no terminal.
TEST(CompileProgress, ALogIsToldEveryFewSeconds) {
  std::FILE* log = std::tmpfile();
  ASSERT_NE(log, nullptr);
  std::chrono::steady_clock::time_point now{};
  const CompileFn tell = show_compiling(log, [&now] { return now; });
  for (int done = 0; done <= 10; ++done) {
    tell({"zncc/peak.cl:zncc_subpixel", done, 10});
    now += std::chrono::milliseconds(500);
  }
  std::rewind(log);
  std::string text(1000, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), log));
  std::fclose(log);
  EXPECT_EQ(text,
            "impactdic: compiling kernels, once for this machine\n"
            "impactdic: compiling kernels: 6 of 10\n");
}

}  // namespace
}  // namespace impactdic::cli
