// OpenCV pictures to frames and back. Only for the sources of this folder.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/image.h>

#include <opencv2/core.hpp>
#include <string>

namespace impactdic::video {

// Grey or colour, 8 or 16 bits, to a grey frame.
// Throws FormatError for other kinds.
void to_frame(const cv::Mat& picture, const std::string& path, Channel channel, Frame& frame);
// True where red, green and blue differ somewhere.
bool is_colored(const cv::Mat& picture);
// The frame's own memory as a picture; valid as long as the frame.
cv::Mat as_mat(const Frame& frame);
// OpenCV and FFmpeg report to stderr unless told once that the library does not print. FFmpeg is
// told through the environment, which other threads must not read meanwhile, as drivers of devices
// do that are opened beside: pictures do without.
void silence_opencv();
void silence_codecs();  // both

}  // namespace impactdic::video
