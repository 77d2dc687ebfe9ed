// A camera from pictures of a flat target, or a scale from one picture of a ruler.
//
// Image axes: x right, y down, pixel centres at integers.
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/clip.h>
#include <impactdic/control.h>
#include <impactdic/export.h>
#include <impactdic/measured.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

enum class CalibrationTarget {
  kCheckerboard,  // black and white squares; all of it must be seen
  kCharuco,       // the same with ArUco markers in its white squares; parts are enough
  kDots,          // round dots on a square grid; a part of 12 dots or more is enough
  kRuler,         // a straight scale in the plane of motion: one picture, no distortion
};
const char* to_string(CalibrationTarget target);
CalibrationTarget parse_calibration_target(const std::string& word);  // throws InvalidArgument

struct CalibrateRequest {
  std::vector<std::string> pictures;  // files, folders, quoted globs or clips: every frame counts
  CalibrationTarget target = CalibrationTarget::kCheckerboard;
  // Squares of the checkerboard or ChArUco target along a row and a column; dots of a dot target.
  int columns = 0, rows = 0;
  // Side of a square; from centre to centre of two dots; between two marks of a ruler.
  double pitch_mm = 0;
  double pitch_sd_mm = 0;  // standard deviation of the pitch, which all of the target shares
  // Side of a ChArUco marker; 0: three quarters of the pitch.
  double marker_mm = 0;
  // Diameter of a dot; 0: a third of the pitch is taken. Seen from a slant a dot's centre of
  // gravity is not its centre.
  double dot_mm = 0;
  std::string dictionary = "4x4_50";  // of ChArUco: 4x4_50 … 7x7_1000, original
  std::string plane;                  // the picture whose target lies in the plane of motion; "":
                                      // the first
  // Of a ruler: its two marks, `pitch_mm` apart. Without them its ticks are looked for, `pitch_mm`
  // from one to the next.
  std::vector<PointPx> marks;
  double marks_sd_px = 0.5;  // of a mark along one axis, as a person sets it
  OpenOptions open;
  // Throws InvalidArgument naming the setting, by its name on the command line.
  void validate() const;
};

// One picture of the target.
struct CalibrationPicture {
  std::string name;
  bool used = false;
  std::string reason;              // why it is not used
  std::size_t points = 0;          // of the target that were found
  std::size_t rejected = 0;        // of these, that do not fit and are left out
  double rms_px = kNotMeasured;    // of the residuals of the others
  double tilt_deg = kNotMeasured;  // between the line of sight and the target's normal
};

// A point of the target in one picture.
struct CalibrationPoint {
  std::size_t picture = 0;            // of CalibrateResult::pictures
  double x_px = 0, y_px = 0;          // where it was found
  double off_x_px = 0, off_y_px = 0;  // from where the camera would show it
  bool used = true;
};

struct CalibrateResult {
  Camera camera;
  std::vector<CalibrationPicture> pictures;
  std::vector<CalibrationPoint> points;
  std::string terms;  // of the distortion that the evidence speaks for: "k1 k2", "none"
  double point_sd_px = kNotMeasured;  // scatter of a point along one axis
  Measured metre_per_px;              // in the plane of motion, at the picture's middle
  Measured tilt_deg;                  // of the camera against the plane of motion
  double distortion_px = 0;           // the largest in the picture: what it moves a point by
  // Deviation of a place in the plane by the camera alone, against the picture's middle, at its
  // worst within the picture, px.
  double worst_place_sd_px = kNotMeasured;
  bool good = false;                 // nothing is missing
  std::vector<std::string> verdict;  // one line each: what is missing, or that nothing is
};

// Finds the target in every picture and the camera that shows it so: Zhang's method (2000) with
// Brown's distortion (1971), docs/camera.md. Throws InvalidArgument where the request is wrong or
// the pictures do not do; FileError, FormatError of a picture; Error where this build cannot.
CalibrateResult calibrate(const CalibrateRequest& request, const RunControl& control = {});

// The same, writes camera.toml to `path` and, beside it, a drawing of the residuals with the ending
// .svg. Throws also InvalidArgument where a file is there and `force` is not set.
CalibrateResult calibrate_to_file(const CalibrateRequest& request, const std::string& path,
                                  bool force, const RunControl& control = {});

}  // namespace impactdic
