// From the points that pictures show to the result of a calibration.
#pragma once

#include <impactdic/camera/calibrate.h>
#include <impactdic/image.h>

#include <functional>
#include <opencv2/core.hpp>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

// `pictures`: one a picture, without a point where the target was not found. Throws InvalidArgument
// where no camera can be found, or the plane's picture shows no target.
CalibrateResult calibrate_points(const CalibrateRequest& request, const std::vector<View>& pictures,
                                 int width, int height);

// Grey levels of one of the pictures, by its number; called by several threads at a time.
using PictureOf = std::function<Image<float>(std::size_t picture)>;

// The same, and then every point is found anew by least squares of the picture around it
// (point_fit.h), as the camera that was found shows it, and the camera with these. Throws also what
// `picture` throws, and Error where `control` stops it.
CalibrateResult calibrate_pictures(const CalibrateRequest& request,
                                   const std::vector<View>& pictures, int width, int height,
                                   const PictureOf& picture, const RunControl& control = {});

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
