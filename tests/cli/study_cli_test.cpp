// `study` on small balls: files, errors, figures.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

nlohmann::json summary_of(const std::filesystem::path& folder) {
  return nlohmann::json::parse(read_text(folder / "summary.json"));
}

void check_table(const CsvTable& table) {
  ASSERT_EQ(table.rows, 2u * 8 * 3);
  const auto& motion = table.text("motion");
  const auto& estimator = table.text("estimator");
  const auto shift = table.numbers("shift_rms_px"), bound = table.numbers("bound_dx_px");
  const auto mean = table.numbers("dx_mean_px");
  for (std::size_t i = 0; i < table.rows; ++i) {
    if (estimator[i] == "ball") {
      EXPECT_LT(shift[i], 4 * bound[i]) << i;
    }
    // The published method reads 1 px too small by its bias: every window by at least a step.
    if (estimator[i] == "published" && motion[i] == "x") {
      EXPECT_LT(mean[i], -1.0 / 6 + 1e-3);
    }
    if (estimator[i] == "icgn5") {
      EXPECT_LT(std::abs(mean[i]), 0.02) << i;
    }
  }
}

void check_figures(const std::filesystem::path& folder) {
  const std::string python = "/usr/bin/python3";
  if (std::system((python + " -c 'import matplotlib' 2> /dev/null").c_str()) != 0) {
    std::printf("python3-matplotlib is not installed: no figures\n");
    return;
  }
  ASSERT_EQ(std::system((python + " '" IMPACTDIC_SOURCE_DIR "/scripts/study_figures.py' " +
                         quoted(folder) + " > /dev/null")
                            .c_str()),
            0);
  for (const char* name : {"figure_2_4", "figure_2_5", "figure_2_6", "figure_2_7"}) {
    for (const char* kind : {".png", ".svg"}) {
      EXPECT_GT(std::filesystem::file_size(folder / (std::string(name) + kind)), 5000u);
    }
  }
}

// Once for all that is looked at: each test of a program is a process of its own.
TEST(StudyPatterns, TableFindingAndFigures) {
  const ScratchFolder folder;
  const Outcome outcome = run_program(
      "study patterns --patterns e1,a1 --radius-px 60 --pairs 2 "
      "--estimators published,icgn5,ball -o " +
      quoted(folder / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  check_table(CsvTable(folder / "out/patterns.csv"));
  const nlohmann::json summary = summary_of(folder / "out");
  EXPECT_EQ(summary["best_pattern"], "e1");
  EXPECT_NE(summary["finding"].get<std::string>().find("Paint pattern e1"), std::string::npos);
  EXPECT_EQ(summary["estimators"]["ball"]["patterns"]["e1"]["pairs"], 16);
  check_figures(folder / "out");
}

TEST(StudyDensity, LiteralTimeGrowsAndOursGivesTheSameLags) {
  const ScratchFolder folder;
  const Outcome outcome = run_program("study density --radius-px 40 --interp 4 --windows 8 -o " +
                                      quoted(folder / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const CsvTable table(folder / "out/density.csv");
  ASSERT_EQ(table.rows, 5u * 3);
  const nlohmann::json summary = summary_of(folder / "out");
  EXPECT_EQ(summary["same_lag_share"], 1.0);
  EXPECT_GT(summary["literal_slowdown"].get<double>(), 10);
  EXPECT_EQ(CsvTable(folder / "out/window_spline.csv").rows, 85u * 85);
}

TEST(Study, WrongRequestsAreRefused) {
  const ScratchFolder folder;
  const std::string out = " -o " + quoted(folder / "out");
  for (const char* wrong : {"study nothing", "study patterns --patterns z9",
                            "study patterns --estimators hough", "study density --interp 12"}) {
    const Outcome outcome = run_program(wrong + out);
    EXPECT_EQ(outcome.status, 2) << wrong;
    EXPECT_NE(outcome.err.find("impactdic: error: "), std::string::npos) << wrong;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace impactdic::testing
