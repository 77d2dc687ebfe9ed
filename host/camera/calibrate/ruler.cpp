// A scale from a ruler: from two marks that a person set, or from its ticks.
#include <impactdic/error.h>

#include <cmath>
#include <cstdio>

#include "host/base/parse.h"
#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/ticks.h"
#include "host/camera/calibrate/verdict.h"

namespace impactdic::camera {

namespace {

// So far away that its rays are parallel: a ruler tells nothing of perspective.
constexpr double kFarFocal_px = 1e7;
// Deviations beyond which the pitch grows along the ruler.
constexpr double kChance = 4;
constexpr double kEven = 0.05;  // scatter of an even row of ticks, of its pitch

// A camera that looks squarely at a plane of this scale.
CalibrateResult of_scale(const CalibrateRequest& request, const Measured& metre_per_px, int width,
                         int height) {
  using P = CameraParameter;
  CalibrateResult result;
  Camera& camera = result.camera;
  camera.width = width;
  camera.height = height;
  camera.from = to_string(request.target);
  camera[P::kFx] = camera[P::kFy] = kFarFocal_px;
  camera[P::kCx] = (width - 1) / 2.0;
  camera[P::kCy] = (height - 1) / 2.0;
  camera[P::kPositionZ] = kFarFocal_px * metre_per_px.value;
  const double sd = kFarFocal_px * metre_per_px.sd;
  camera.covariance.back() = sd * sd;
  result.terms = "none";
  return result;
}

// Of the pitch in px, as a deviation: what the ticks' scatter leaves and, where the pitch grows
// along the ruler, that it is another one where the ball flies.
double pitch_sd(const TickRow& row) {
  const bool grows = std::abs(row.growth) > kChance * row.growth_sd;
  const double uneven = grows ? row.pitch_px * row.growth / std::sqrt(12.0) : 0.0;
  return std::hypot(row.pitch_sd_px, uneven);
}

std::string say_row(const TickRow& row, double pitch_mm) {
  const int span = row.ticks.back().number;
  char text[200];
  std::snprintf(text, sizeof text,
                "%zu ticks, %g mm from the first to the last, are seen from %.0f, %.0f to %.0f, "
                "%.0f: is it what the ruler shows?",
                row.ticks.size(), span * pitch_mm, row.ticks.front().at_px.x(),
                row.ticks.front().at_px.y(), row.ticks.back().at_px.x(),
                row.ticks.back().at_px.y());
  return text;
}

}  // namespace

CalibrateResult calibrate_marks(const CalibrateRequest& request, const std::string& picture,
                                int width, int height) {
  const PointPx &a = request.marks.at(0), &b = request.marks.at(1);
  for (const PointPx& mark : {a, b}) {
    if (mark.x_px < -0.5 || mark.y_px < -0.5 || mark.x_px > width - 0.5 ||
        mark.y_px > height - 0.5) {
      throw InvalidArgument("a mark lies outside of the picture", "--marks");
    }
  }
  const double length_px = std::hypot(b.x_px - a.x_px, b.y_px - a.y_px);
  if (!(length_px > 4 * request.marks_sd_px)) {
    throw InvalidArgument("the two marks are too near to each other", "--marks");
  }
  const double scale = request.pitch_mm * 1e-3 / length_px;
  const double relative = std::hypot(request.pitch_sd_mm / request.pitch_mm,
                                     std::sqrt(2.0) * request.marks_sd_px / length_px);
  CalibrateResult result = of_scale(request, {scale, scale * relative}, width, height);
  result.pictures.push_back({picture, true, "", 2, 0, kNotMeasured, kNotMeasured});
  result.points = {{0, a.x_px, a.y_px, 0, 0, true}, {0, b.x_px, b.y_px, 0, 0, true}};
  result.point_sd_px = request.marks_sd_px;
  judge(request, result);
  return result;
}

CalibrateResult calibrate_ticks(const CalibrateRequest& request, const std::string& picture,
                                const cv::Mat& grey) {
  const std::optional<TickRow> row = find_ticks(grey);
  if (!row || row->scatter_px > kEven * row->pitch_px) {
    throw InvalidArgument("no even row of eight ticks or more is seen", picture,
                          "--marks X1,Y1,X2,Y2 names two marks, --pitch-mm apart");
  }
  const double scale = request.pitch_mm * 1e-3 / row->pitch_px;
  const double relative =
      std::hypot(request.pitch_sd_mm / request.pitch_mm, pitch_sd(*row) / row->pitch_px);
  CalibrateResult result = of_scale(request, {scale, scale * relative}, grey.cols, grey.rows);
  const std::size_t count = row->ticks.size();
  result.pictures.push_back({picture, true, "", count, 0, row->scatter_px, kNotMeasured});
  const Eigen::Vector2d along = (row->ticks.back().at_px - row->ticks.front().at_px).normalized();
  for (const Tick& tick : row->ticks) {
    result.points.push_back({0, tick.at_px.x(), tick.at_px.y(), tick.off_px * along.x(),
                             tick.off_px * along.y(), true});
  }
  result.point_sd_px = row->scatter_px;
  judge(request, result);
  result.verdict.insert(result.verdict.begin(), say_row(*row, request.pitch_mm));
  if (std::abs(row->growth) > kChance * row->growth_sd) {
    result.verdict.push_back("the pitch grows by " +
                             plus_minus(100 * row->growth, 100 * row->growth_sd) +
                             " % along the ruler, which leans or is bent by the lens: the scale "
                             "is no better than that");
  }
  return result;
}

}  // namespace impactdic::camera
