// Where corners and dots are, below the pixel.
#pragma once

#include <opencv2/core.hpp>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

// `columns`: points in a row of the target, so that the distance to the neighbours is known.
// `clear`: the share of a square about a corner in which nothing but the two edges is seen. Points
// whose window reaches out of the picture, or that move by more than it, are taken out.
void refine_corners(const cv::Mat& picture, int columns, double clear, std::vector<Sighting>& seen);

// Centres of gravity of the dots' ink.
void refine_dots(const cv::Mat& picture, int columns, std::vector<Sighting>& seen);

// Least distance from a point to one of its neighbours in the target's row or column, px; 0 where
// it has none.
double nearest_neighbour_px(const std::vector<Sighting>& seen, std::size_t index, int columns);

}  // namespace impactdic::camera
