// ArUco markers (Garrido-Jurado et al. 2014) and the corners between them.
#pragma once

#include <impactdic/camera/calibrate.h>

#include <opencv2/core.hpp>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

// Inner corners of a ChArUco board next to markers that are seen, to about a pixel. The top left
// square is black; markers stand in the white squares, numbered row by row. Throws InvalidArgument
// for a dictionary that is not known.
std::vector<Sighting> find_charuco(const cv::Mat& picture, const CalibrateRequest& request);

// Side of a marker over that of a square.
double marker_share(const CalibrateRequest& request);

// One marker as a picture of `side_px`, with its black border.
cv::Mat draw_marker(const std::string& dictionary, int id, int side_px);

}  // namespace impactdic::camera
