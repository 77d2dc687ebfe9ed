// A frame as OpenCV takes it. Internal to host/advice.
#pragma once

#include <impactdic/image.h>

#include <opencv2/core.hpp>

namespace impactdic::advice {

// Grey levels of a part of it, 32-bit floats.
inline cv::Mat as_floats(const Frame& frame, const cv::Rect& part) {
  const cv::Mat stored(frame.height(), frame.width(),
                       frame.type == PixelType::kU8 ? CV_8UC1 : CV_16UC1,
                       const_cast<void*>(frame.bytes()));
  cv::Mat floats;
  stored(part).convertTo(floats, CV_32F);
  return floats;
}

// The same of all of it.
inline cv::Mat as_floats(const Frame& frame) {
  return as_floats(frame, {0, 0, frame.width(), frame.height()});
}

}  // namespace impactdic::advice
