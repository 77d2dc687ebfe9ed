#include <impactdic/camera/calibrate.h>
#include <impactdic/error.h>

#include <array>
#include <cmath>

#include "host/base/parse.h"

namespace impactdic {
namespace {

constexpr std::array kTargets = {"checkerboard", "charuco", "dots", "ruler"};

void check(bool good, const std::string& must, double value, const char* setting) {
  if (!good || !std::isfinite(value)) {
    throw InvalidArgument("must be " + must + ", not " + shortest(value), setting);
  }
}

}  // namespace

const char* to_string(CalibrationTarget target) {
  return kTargets[static_cast<std::size_t>(target)];
}

CalibrationTarget parse_calibration_target(const std::string& word) {
  for (std::size_t i = 0; i < kTargets.size(); ++i) {
    if (word == kTargets[i]) return static_cast<CalibrationTarget>(i);
  }
  throw InvalidArgument("'" + word + "' is no target", "--target",
                        "there are checkerboard, charuco, dots and ruler");
}

void CalibrateRequest::validate() const {
  if (pictures.empty()) throw InvalidArgument("no picture is named", "PICTURES");
  check(pitch_mm > 0, "positive", pitch_mm, "--pitch-mm");
  check(pitch_sd_mm >= 0 && pitch_sd_mm < pitch_mm, "0 or more and less than --pitch-mm",
        pitch_sd_mm, "--pitch-sd-mm");
  if (target == CalibrationTarget::kRuler) {
    if (!marks.empty() && marks.size() != 2) {
      throw InvalidArgument("a ruler has two marks", "--marks",
                            "X1,Y1,X2,Y2 in px, --pitch-mm apart");
    }
    for (const PointPx& mark : marks) {
      check(std::isfinite(mark.x_px), "finite numbers", mark.y_px, "--marks");
    }
    check(marks_sd_px > 0, "positive", marks_sd_px, "--marks-sd-px");
    return;
  }
  if (!marks.empty()) throw InvalidArgument("only a ruler has marks", "--marks");
  constexpr int kFewest = 3, kMost = 100;
  for (const int cells : {columns, rows}) {
    if (cells < kFewest || cells > kMost) {
      throw InvalidArgument("the target must have 3 to 100 cells along a side", "--cells",
                            "CxR: squares along a row and a column, or dots");
    }
  }
  if (target == CalibrationTarget::kCheckerboard && (columns < 4 || rows < 4)) {
    throw InvalidArgument("a checkerboard must have 4 squares or more along a side", "--cells");
  }
  check(marker_mm >= 0 && marker_mm < pitch_mm, "0 or more and less than --pitch-mm", marker_mm,
        "--marker-mm");
  check(dot_mm >= 0 && dot_mm < pitch_mm, "0 or more and less than --pitch-mm", dot_mm, "--dot-mm");
}

}  // namespace impactdic
