// Points of a calibration target in one picture.
#pragma once

#include <impactdic/camera/calibrate.h>

#include <opencv2/core.hpp>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

// Points of the target, m: inner corners of a checkerboard or ChArUco board, centres of dots; row
// by row, x along the rows.
BoardPoints board_points(const CalibrateRequest& request);

// Diameter of a dot, as told or as dots usually are.
double dot_diameter_mm(const CalibrateRequest& request);

// The picture in 8 bits, from its darkest to its brightest grey level but for a few pixels.
cv::Mat to_grey(const Frame& frame);

// What of the target is seen, refined below the pixel; empty where it is not found, or only a
// part of a checkerboard. Throws InvalidArgument for a dictionary that is not known.
std::vector<Sighting> find_target(const cv::Mat& picture, const CalibrateRequest& request);

}  // namespace impactdic::camera
