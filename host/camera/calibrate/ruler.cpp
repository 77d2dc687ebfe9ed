// A scale from two marks of a ruler.
#include <impactdic/error.h>

#include <cmath>

#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/verdict.h"

namespace impactdic::camera {

namespace {
// So far away that its rays are parallel: a ruler tells nothing of perspective.
constexpr double kFarFocal_px = 1e7;
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
  using P = CameraParameter;
  const double scale = request.pitch_mm * 1e-3 / length_px;
  const double relative = std::hypot(request.pitch_sd_mm / request.pitch_mm,
                                     std::sqrt(2.0) * request.marks_sd_px / length_px);
  CalibrateResult result;
  Camera& camera = result.camera;
  camera.width = width;
  camera.height = height;
  camera.from = to_string(request.target);
  camera[P::kFx] = camera[P::kFy] = kFarFocal_px;
  camera[P::kCx] = (width - 1) / 2.0;
  camera[P::kCy] = (height - 1) / 2.0;
  camera[P::kPositionZ] = kFarFocal_px * scale;
  const double sd = relative * camera[P::kPositionZ];
  camera.covariance.back() = sd * sd;
  result.terms = "none";
  result.pictures.push_back({picture, true, "", 2, 0, kNotMeasured, kNotMeasured});
  result.points = {{0, a.x_px, a.y_px, 0, 0, true}, {0, b.x_px, b.y_px, 0, 0, true}};
  result.point_sd_px = request.marks_sd_px;
  judge(request, result);
  return result;
}

}  // namespace impactdic::camera
