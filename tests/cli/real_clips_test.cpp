// The main job on real camera files with known truth.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <sstream>

#include "tests/support/data.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

// rms of `values` about the quadratic in their index that fits them best.
double rms_about_quadratic(const std::vector<double>& values) {
  const auto n = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd powers(n, 3);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    powers.row(i) << 1, double(i), double(i * i);
    right(i) = values[static_cast<std::size_t>(i)];
  }
  const Eigen::VectorXd rest = right - powers * powers.colPivHouseholderQr().solve(right);
  return std::sqrt(rest.squaredNorm() / static_cast<double>(n));
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

CsvTable track(const std::string& clip, const std::string& options, const ScratchFolder& folder) {
  const Outcome outcome = run_program("track " + quoted(data_path(clip)) + " -o " +
                                      quoted(folder / "out") + " --force " + options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return CsvTable(folder / "out/track.csv");
}

TEST(RealClips, BallOnPhotronClip) {
  IMPACTDIC_NEED_DATA("mraw/ball_12bit.cihx");
  const ScratchFolder folder;
  const CsvTable table = track("mraw/ball_12bit.cihx", "", folder);
  ASSERT_EQ(table.rows, 15u);
  for (std::size_t i = 0; i < table.rows; ++i) {
    EXPECT_EQ(table.text("status")[i], i + 1 < table.rows ? "ok" : "last_frame") << i;
  }
  // The ball falls freely: its centre follows a quadratic in time.
  EXPECT_LE(rms_about_quadratic(table.numbers("cx_px")), 0.003);
  EXPECT_LE(rms_about_quadratic(table.numbers("cy_px")), 0.005);
  for (double r : table.numbers("r_px")) EXPECT_NEAR(r, 63.47, 0.15);
  const auto cx = table.numbers("cx_px"), cy = table.numbers("cy_px");
  double path = 0;
  for (std::size_t i = 1; i < cx.size(); ++i)
    path += std::hypot(cx[i] - cx[i - 1], cy[i] - cy[i - 1]);
  EXPECT_NEAR(path / 14, 2.647, 0.005);
  // The stored rate: frame 14 is 14/30000 s after frame 0.
  EXPECT_NEAR(table.numbers("time_s").back(), 14.0 / 30000, 1e-12);
}

class EightBitCopies : public ::testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(EightBitCopies, GiveTheSameCentres) {
  const auto [clip, tolerance_px] = GetParam();
  IMPACTDIC_NEED_DATA(clip);
  const ScratchFolder deep, shallow;
  const CsvTable want = track("mraw/ball_12bit.cihx", "--no-field", deep);
  const CsvTable got = track(clip, "--no-field --fps 30000", shallow);
  ASSERT_EQ(got.rows, want.rows);
  for (const char* column : {"cx_px", "cy_px"}) {
    for (std::size_t i = 0; i < got.rows; ++i) {
      EXPECT_NEAR(got.numbers(column)[i], want.numbers(column)[i], tolerance_px) << column << i;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Clips, EightBitCopies,
                         ::testing::Values(std::pair("avi/ball_Y800.avi", 0.02),
                                           std::pair("avi/ball_MJPG.avi", 0.05),
                                           std::pair("avi/ball_DIB8_bottomup_w382.avi", 0.02)));

// Per-window columns of the second frame's field, through h5py.
CsvTable field_of(const ScratchFolder& folder) {
  const std::string script =
      "import h5py,sys\n"
      "f=h5py.File(sys.argv[1])\n"
      "names=['x_px','y_px','u_px','v_px','status']\n"
      "print(','.join(names))\n"
      "for row in zip(*[f[n][1] for n in names]): print(','.join(map(str,row)))\n";
  std::ofstream(folder / "dump.py") << script;
  const std::string command = "/usr/bin/python3 " + quoted(folder / "dump.py") + " " +
                              quoted(folder / "out/fields.h5") + " > " + quoted(folder / "f.csv");
  EXPECT_EQ(std::system(command.c_str()), 0);
  return CsvTable(folder / "f.csv");
}

void correlate(const std::string& arguments, const ScratchFolder& folder) {
  const Outcome outcome = run_program("correlate " + arguments + " -o " + quoted(folder / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

// A phone's film of a green ball that is held, let fall and bounces on a brown floor, blurred where
// it is quick and lost there. Told by eye: the bounces' frames, and where the ball is in some.
// Where the ball of bounceAmeen.avi is in a frame, px, by eye: a hand leads it, it falls and
// bounces, with less than its own height left it bounces on, rolls towards the camera, and a hand
// takes it. NaN where nobody looked.
Eigen::Vector2d green_ball(double frame) {
  struct Flight {
    double first, last, apex, apex_px;
  };
  constexpr double kHalfGravity_px = 6.65;  // a frame²
  constexpr Flight kFlights[] = {{66, 75.9, 64.35, 62},
                                 {77, 91.3, 83.85, 596},
                                 {92, 102.1, 97, 797},
                                 {103, 109.7, 106.1, 891}};
  // Later: on straight lines between these.
  constexpr double kFrame[] = {110, 111, 112, 113, 116, 121, 130, 152, 188};
  constexpr double kX_px[] = {932, 933, 934, 936, 946, 962, 980, 1001, 1015};
  constexpr double kY_px[] = {977, 960, 946, 943, 986, 988, 1015, 1043, 1060};
  if (frame < 66) return {978, std::clamp(5 + 60 * (frame - 20) / 20, 12.0, 62.0)};
  for (const Flight& flight : kFlights) {
    if (frame < flight.first || frame > flight.last) continue;
    const double t = frame - flight.apex;
    const double x_px = frame < 103 ? 986 - 2.05 * (frame - 73) : 918 + 2 * (frame - 103);
    return {x_px, flight.apex_px + kHalfGravity_px * t * t};
  }
  for (std::size_t k = 1; k < std::size(kFrame); ++k) {
    if (frame < kFrame[k - 1] || frame > kFrame[k]) continue;
    const double share = (frame - kFrame[k - 1]) / (kFrame[k] - kFrame[k - 1]);
    return {kX_px[k - 1] + share * (kX_px[k] - kX_px[k - 1]),
            kY_px[k - 1] + share * (kY_px[k] - kY_px[k - 1])};
  }
  return {NAN, NAN};
}

// What is called a ball is the ball, in every row.
void expect_green_ball(const CsvTable& table) {
  const auto cx = table.numbers("cx_px"), cy = table.numbers("cy_px");
  const auto frame = table.numbers("frame");
  const std::vector<std::string> status = table.text("status");
  for (std::size_t k = 0; k < table.rows; ++k) {
    if (!std::isfinite(cx[k]) || status[k] == "no_ball") continue;
    const Eigen::Vector2d ball = green_ball(frame[k]);
    EXPECT_NEAR(cx[k], ball.x(), 25) << frame[k];
    EXPECT_NEAR(cy[k], ball.y(), 25) << frame[k];
  }
}

TEST(RealClips, BouncesOfABallInARoom) {
  IMPACTDIC_NEED_DATA("real/bounceAmeen.avi");
  const ScratchFolder folder;
  const CsvTable table = track("real/bounceAmeen.avi", "", folder);
  ASSERT_EQ(table.rows, 216u);
  const auto cy = table.numbers("cy_px");
  for (const auto& [frame, y_px] :
       {std::pair<std::size_t, double>{84, 596}, {97, 797}, {106, 890}}) {
    EXPECT_NEAR(cy[frame], y_px, 10) << frame;
  }
  expect_green_ball(table);
  EXPECT_GE(std::count_if(cy.begin(), cy.end(), [](double y) { return std::isfinite(y); }), 130);
  const auto summary = nlohmann::json::parse(read_text(folder / "out/summary.json"));
  EXPECT_EQ(summary["warnings"].dump().find("missing there"), std::string::npos);
  // When, and the restitution by the heights from which it falls and to which it rises.
  std::map<double, double> bounces;  // restitution's error over stated
  const auto add = [&](const nlohmann::json& impact, double restitution) {
    const auto& told = impact["restitution"];
    const double error = told["value"].get<double>() - restitution;
    bounces[impact["t_max_compression"]["frame"]] = error / told["sd"].get<double>();
  };
  ASSERT_EQ(summary["more_impacts"].size(), 2u);  // none while a hand leads it
  add(summary["more_impacts"][0], std::sqrt((980 - 596) / (980 - 62.0)));
  add(summary["impact"], std::sqrt((980 - 797) / (980 - 596.0)));
  add(summary["more_impacts"][1], std::sqrt((980 - 891) / (980 - 797.0)));
  auto bounce = bounces.begin();
  for (const double frame : {76.5, 91.6, 102.4}) {
    EXPECT_NEAR(bounce->first, frame, 0.7);
    EXPECT_LT(std::abs(bounce->second), 3) << frame;
    ++bounce;
  }
}

// Before the floor the ball is as grey as that, and not as red.
TEST(RealClips, TheFourthBounceShowsInRed) {
  IMPACTDIC_NEED_DATA("real/bounceAmeen.avi");
  const ScratchFolder folder;
  track("real/bounceAmeen.avi", "--channel red --frames 84:140", folder);
  const auto summary = nlohmann::json::parse(read_text(folder / "out/summary.json"));
  std::set<double> bounces = {summary["impact"]["t_max_compression"]["frame"].get<double>()};
  for (const auto& impact : summary["more_impacts"]) {
    bounces.insert(impact["t_max_compression"]["frame"].get<double>());
  }
  ASSERT_EQ(bounces.size(), 3u);
  auto bounce = bounces.begin();
  for (const double frame : {91.6, 102.4, 110.0}) EXPECT_NEAR(*bounce++, frame, 0.7);
}

// From its seventh frame on, where blurred circles come out elsewhere and the ball is taken for a
// sphere.
TEST(RealClips, BouncesOfThatBallInACutOfTheFilm) {
  IMPACTDIC_NEED_DATA("real/bounceAmeen.avi");
  const ScratchFolder folder;
  expect_green_ball(track("real/bounceAmeen.avi", "--frames 6:216", folder));
  const auto summary = nlohmann::json::parse(read_text(folder / "out/summary.json"));
  ASSERT_EQ(summary["impact"]["status"], "not_resolved");
  EXPECT_NEAR(summary["impact"]["t_max_compression"]["frame"].get<double>(), 91.6, 0.7);
  const auto& restitution = summary["impact"]["restitution"];
  EXPECT_NEAR(restitution["value"].get<double>(), std::sqrt((980 - 797) / (980 - 596.0)),
              3 * restitution["sd"].get<double>());
  ASSERT_GE(summary["more_impacts"].size(), 1u);
}

// Of the programs that have ended.
double processor_time_s() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

class NoBall : public ::testing::TestWithParam<const char*> {};

// Speckle fields, a beam and a wheel hold circles, but no ball. It took 97 s of a core to invent
// some.
TEST_P(NoBall, IsInventedWhereThereIsNone) {
  IMPACTDIC_NEED_DATA(GetParam());
  const double before_s = processor_time_s();
  const Outcome outcome = run_program("info " + quoted(data_path(GetParam())));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("\nball "), std::string::npos) << outcome.out;
  EXPECT_LT(processor_time_s() - before_s, 5);
}

INSTANTIATE_TEST_SUITE_P(RealClips, NoBall,
                         ::testing::Values("speckle/sample14", "mraw/beam.mraw", "wheel"));

TEST(RealClips, TranslationOfAPictureWithZeros) {
  IMPACTDIC_NEED_DATA("speckle/Pattern_1.bmp");
  const ScratchFolder folder;
  correlate(quoted(data_path("speckle/Pattern_1.bmp")) + " " +
                quoted(data_path("speckle/Pattern_1_Translation.bmp")) + " --search 10",
            folder);
  const CsvTable field = field_of(folder);
  ASSERT_GT(field.rows, 3000u);
  for (const std::string& status : field.text("status")) ASSERT_EQ(status, "0");
  for (const char* column : {"u_px", "v_px"}) {
    const auto values = field.numbers(column);
    EXPECT_NEAR(mean(values), 7.084, 0.005) << column;
    for (double value : values) ASSERT_NEAR(value, 7.084, 0.01) << column;
  }
}

TEST(RealClips, Sample14OfTheDicChallenge) {
  IMPACTDIC_NEED_DATA("speckle/sample14/command.csv");
  const ScratchFolder folder;
  correlate(quoted(data_path("speckle/sample14/Sample14 Reference.tif")) + " " +
                quoted(data_path("speckle/sample14/Sample14 L1 Amp0.1b.tif")) + " --window 33",
            folder);
  std::vector<double> truth;
  std::istringstream lines(read_text(data_path("speckle/sample14/command.csv")));
  std::string line;
  while (std::getline(lines, line)) truth.push_back(std::stod(line.substr(line.find(',') + 1)));
  const CsvTable field = field_of(folder);
  ASSERT_GT(field.rows, 3000u);
  const auto x = field.numbers("x_px"), u = field.numbers("u_px");
  double sum = 0;
  for (std::size_t i = 0; i < field.rows; ++i) {
    ASSERT_EQ(field.text("status")[i], "0") << x[i];
    const double error = u[i] - truth[static_cast<std::size_t>(std::lround(x[i]))];
    sum += error * error;
  }
  EXPECT_LE(std::sqrt(sum / static_cast<double>(field.rows)), 0.02);
}

// Nothing is said of the turn: the region is searched at every angle. Published: a turn by
// 170.0000° about (256, 256), which on the screen is counter-clockwise.
TEST(RealClips, HalfATurnWithoutAGuess) {
  IMPACTDIC_NEED_DATA("speckle/rotation_170.tif");
  const ScratchFolder folder;
  correlate(quoted(data_path("speckle/rotation_000.tif")) + " " +
                quoted(data_path("speckle/rotation_170.tif")),
            folder);
  const CsvTable motion(folder / "out/motion.csv");
  EXPECT_NEAR(motion.numbers("rot_deg")[1], 170, 0.002);
  const CsvTable field = field_of(folder);
  double squares = 0;
  std::size_t found = 0;
  const double c = std::cos(170 * M_PI / 180), s = std::sin(170 * M_PI / 180);
  const auto x = field.numbers("x_px"), y = field.numbers("y_px");
  const auto u = field.numbers("u_px"), v = field.numbers("v_px");
  const auto status = field.text("status");
  for (std::size_t i = 0; i < field.rows; ++i) {
    if (status[i] != "0") continue;
    ++found;
    const double dx = x[i] - 256, dy = y[i] - 256;
    squares +=
        std::pow(u[i] - (c * dx + s * dy - dx), 2) + std::pow(v[i] - (-s * dx + c * dy - dy), 2);
  }
  // The corners of the picture turn out of it.
  EXPECT_GT(static_cast<double>(found), 0.9 * static_cast<double>(field.rows));
  EXPECT_LE(std::sqrt(squares / (2.0 * static_cast<double>(found))), 0.008);
}

TEST(RealClips, TurningWheelFrameToFrame) {
  IMPACTDIC_NEED_DATA("wheel/gold_DICe_solution_0.txt");
  const ScratchFolder folder;
  correlate(quoted(data_path("wheel")) + " --reference previous --roi 304,172,81,81", folder);
  const CsvTable gold(data_path("wheel/gold_DICe_solution_0.txt"));
  const CsvTable motion(folder / "out/motion.csv");
  ASSERT_EQ(motion.rows, gold.rows);
  const auto steps = motion.numbers("rot_deg"), turned = gold.numbers("ROTATION_Z");
  double sum = 0;
  for (std::size_t i = 0; i < motion.rows; ++i) {
    EXPECT_EQ(motion.text("status")[i], i == 0 ? "reference" : "ok");
    sum += steps[i];
    // The gold angle is clockwise on the screen, in radians.
    EXPECT_NEAR(sum, -turned[i] * 180 / M_PI, 0.4) << i;
  }
}

// The same region as the other engine's, by its own definition.
TEST(RealClips, TurningWheelAgainstTheFirstFrame) {
  IMPACTDIC_NEED_DATA("wheel/subset_defs.txt");
  std::ifstream definition(data_path("wheel/subset_defs.txt"));
  std::string corners, line;
  bool in_polygon = false;
  while (std::getline(definition, line)) {
    if (line.find("end vertices") != std::string::npos) break;
    if (in_polygon) {
      std::istringstream numbers(line);
      int x = 0, y = 0;
      numbers >> x >> y;
      corners += (corners.empty() ? "" : ",") + std::to_string(x) + "," + std::to_string(y);
    }
    in_polygon = in_polygon || line.find("begin vertices") != std::string::npos;
  }
  const ScratchFolder folder;
  correlate(
      quoted(data_path("wheel")) + " --roi 304,172,81,81 --motion region --polygon " + corners,
      folder);
  const CsvTable gold(data_path("wheel/gold_DICe_solution_0.txt"));
  const CsvTable motion(folder / "out/motion.csv");
  ASSERT_EQ(motion.rows, gold.rows);
  const auto dx = motion.numbers("dx_px"), gold_dx = gold.numbers("DISPLACEMENT_X");
  const auto dy = motion.numbers("dy_px"), gold_dy = gold.numbers("DISPLACEMENT_Y");
  const auto turn = motion.numbers("rot_deg"), gold_turn = gold.numbers("ROTATION_Z");
  for (std::size_t i = 1; i < motion.rows; ++i) {
    EXPECT_EQ(motion.text("status")[i], "ok");
    EXPECT_LE(std::hypot(dx[i] - gold_dx[i], dy[i] - gold_dy[i]), 0.1) << i;
    EXPECT_NEAR(turn[i], -gold_turn[i] * 180 / M_PI, 0.1) << i;
  }
}

}  // namespace
}  // namespace impactdic::testing
