// Real fruits that turn, none of them a sphere, and points that a person marked in two views each
// (Albiol, Albiol and Sanchez de Meras 2021).
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/data.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

constexpr double kRadPerDeg = 0.017453292519943295;

// What track.csv says of the views: outlines, and the turns from view to view.
class Fruit {
 public:
  explicit Fruit(const CsvTable& table) {
    const auto column = [&](const char* name) { return table.numbers(name); };
    const auto cx = column("cx_px"), cy = column("cy_px"), r = column("r_px");
    const auto e1 = column("e1_px"), e2 = column("e2_px");
    const auto x = column("rot_x_deg"), y = column("rot_y_deg"), z = column("rot_deg");
    for (std::size_t i = 0; i < table.rows; ++i) {
      Eigen::Matrix2d stretch;
      stretch << r[i] + e1[i], e2[i], e2[i], r[i] - e1[i];
      views_.push_back({{cx[i], cy[i]}, stretch, kRadPerDeg * Eigen::Vector3d(x[i], y[i], z[i])});
    }
  }

  // Where a point of one view is in the next one, or in the one before.
  Eigen::Vector2d carried(const Eigen::Vector2d& point, std::size_t from, std::size_t to) const {
    const View &first = views_.at(from), &second = views_.at(to);
    const Eigen::Vector2d on = first.stretch.inverse() * (point - first.centre);
    const double depth = std::sqrt(std::max(0.0, 1 - on.squaredNorm()));
    const Eigen::Vector3d place = Eigen::Vector3d(on.x(), -on.y(), depth).normalized();
    const Eigen::Vector3d& turn = views_[std::min(from, to)].turn;
    const double angle = from < to ? turn.norm() : -turn.norm();
    const Eigen::Vector3d led = Eigen::AngleAxisd(angle, turn.normalized()) * place;
    return second.centre + second.stretch * Eigen::Vector2d(led.x(), -led.y());
  }

 private:
  struct View {
    Eigen::Vector2d centre;
    Eigen::Matrix2d stretch;
    Eigen::Vector3d turn;
  };
  std::vector<View> views_;
};

// Of the marked points, px; infinite where there is no turn between the views.
std::vector<double> distances(const Fruit& fruit, const std::string& marks) {
  std::ifstream lines(marks);
  std::vector<double> distances;
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string name;
    std::size_t from = 0, to = 0;
    Eigen::Vector2d point, marked;
    if (!(words >> name >> from >> to >> point.x() >> point.y() >> marked.x() >> marked.y())) {
      continue;
    }
    const double off = (fruit.carried(point, from, to) - marked).norm();
    distances.push_back(std::isfinite(off) ? off : INFINITY);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

// Of a fruit's name, the number of its marks and the body that is asked for.
class Fruits : public ::testing::TestWithParam<std::tuple<const char*, std::size_t, const char*>> {
};

TEST_P(Fruits, MarkedPointsAreCarriedFromViewToView) {
  const auto [name, marks, body] = GetParam();
  const std::string folder = std::string("sphere/fruit/") + name;
  IMPACTDIC_NEED_DATA(folder);
  const ScratchFolder scratch;
  const Outcome outcome = run_program("track " + quoted(data_path(folder + "/obj0000")) + " -o " +
                                      quoted(scratch / "out") + " --body " + body);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("body: spheroid, no sphere"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: no sphere"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("pictures of different sizes"), std::string::npos) << outcome.err;
  const auto summary = nlohmann::json::parse(read_text(scratch / "out/summary.json"));
  EXPECT_EQ(summary["body"]["kind"], "spheroid");
  EXPECT_EQ(summary["body"]["asked"], body);
  const CsvTable table(scratch / "out/track.csv");
  const std::vector<double> off =
      distances(Fruit(table), data_path(folder + "/ground_truth.txt").string());
  ASSERT_EQ(off.size(), marks);
  EXPECT_LE(off[marks / 2], 4) << "median of the marked points, px";
  // No turn is stated to be known better than the shape is.
  for (std::size_t i = 0; i + 1 < table.rows; ++i) {
    EXPECT_EQ(table.text("status")[i], "ok") << i;
    EXPECT_EQ(table.text("dx_px")[i], "") << "crops have no common origin";
    EXPECT_GT(table.numbers("rot_x_sd_deg")[i], 0.05 * std::abs(table.numbers("rot_x_deg")[i]));
  }
}
INSTANTIATE_TEST_SUITE_P(Views, Fruits,
                         ::testing::Values(std::tuple("mandarins", 9, "auto"),
                                           std::tuple("mandarins", 9, "sphere"),
                                           std::tuple("tomatoes", 19, "auto")));

}  // namespace
}  // namespace impactdic::testing
