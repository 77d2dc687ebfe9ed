// From the points that pictures show to the result of a calibration.
#pragma once

#include <impactdic/camera/calibrate.h>

#include <opencv2/core.hpp>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

// `pictures`: one a picture, without a point where the target was not found. Throws InvalidArgument
// where no camera can be found, or the plane's picture shows no target.
CalibrateResult calibrate_points(const CalibrateRequest& request, const std::vector<View>& pictures,
                                 int width, int height);

// A scale from two marks of a ruler, request.pitch_mm apart.
CalibrateResult calibrate_marks(const CalibrateRequest& request, const std::string& picture,
                                int width, int height);

// The same from the ruler's ticks, request.pitch_mm from one to the next. `grey`: 8 bits. Throws
// InvalidArgument where they are not found.
CalibrateResult calibrate_ticks(const CalibrateRequest& request, const std::string& picture,
                                const cv::Mat& grey);

// A drawing of the result, SVG: where points lie, how far each is off, what the lens does.
std::string draw_residuals(const CalibrateResult& result);

}  // namespace impactdic::camera
