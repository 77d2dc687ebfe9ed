#include "host/video/codec/grey.h"

#include <impactdic/error.h>

#include <cstdlib>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace impactdic::video {

void to_frame(const cv::Mat& picture, const std::string& path, Channel channel, Frame& frame) {
  const int depth = picture.depth(), channels = picture.channels();
  if ((depth != CV_8U && depth != CV_16U) || (channels != 1 && channels != 3 && channels != 4)) {
    throw FormatError(path, -1, "unsupported pixels", "8 or 16 bits, grey or RGB are read");
  }
  frame.reset(picture.cols, picture.rows, depth == CV_8U ? 8 : 16);
  cv::Mat target(picture.rows, picture.cols, CV_MAKETYPE(depth, 1),
                 const_cast<void*>(frame.bytes()));
  if (channels == 1) {
    picture.copyTo(target);
  } else if (channel != Channel::kLuminance) {
    // OpenCV has blue first.
    const int plane = channel == Channel::kRed ? 2 : channel == Channel::kGreen ? 1 : 0;
    cv::extractChannel(picture, target, plane);
  } else {
    cv::cvtColor(picture, target, channels == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
  }
}

bool is_colored(const cv::Mat& picture) {
  if (picture.channels() < 3) return false;
  std::vector<cv::Mat> planes;
  cv::split(picture, planes);
  return cv::norm(planes[0], planes[1], cv::NORM_INF) > 0 ||
         cv::norm(planes[1], planes[2], cv::NORM_INF) > 0;
}

cv::Mat as_mat(const Frame& frame) {
  return {frame.height(), frame.width(), frame.type == PixelType::kU8 ? CV_8UC1 : CV_16UC1,
          const_cast<void*>(frame.bytes())};
}

void silence_opencv() { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); }

void silence_codecs() {
  static std::once_flag once;
  std::call_once(once, [] {
    silence_opencv();
    // OpenCV's FFmpeg backend takes its level from here; a person's own setting stays.
    ::setenv("OPENCV_FFMPEG_DEBUG", "1", 0);
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  });
}

}  // namespace impactdic::video
