// A frame as OpenCV takes it. Internal to host/advice.
#pragma once

#include <impactdic/image.h>

#include <opencv2/core.hpp>

namespace impactdic::advice {

// Its grey levels, 32-bit floats.
inline cv::Mat as_floats(const Frame& frame) {
  const cv::Mat stored(frame.height(), frame.width(),
                       frame.type == PixelType::kU8 ? CV_8UC1 : CV_16UC1,
                       const_cast<void*>(frame.bytes()));
  cv::Mat floats;
  stored.convertTo(floats, CV_32F);
  return floats;
}

}  // namespace impactdic::advice
