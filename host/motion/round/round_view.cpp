#include "host/motion/round/round_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace impactdic::motion {
namespace {

// Standard deviations of Gaussians, shares of the radius: what is finer than the first is noise and
// does not lie on the model's surface to a fraction of it, what is coarser than the second light.
// docs/log/accuracy.md has what others give. [measured]
constexpr double kFinest = 1.0 / 30, kSurround = 1.0 / 7;
// Grey levels of 255; what deviates less is noise. As the search for a sphere's turn has it.
constexpr double kLeastContrast = 3;
// The outline's last pixels are mixed with the background.
constexpr int kRim_px = 3;
constexpr int kMargin_px = 8;
// Grey levels of a local deviation, about the middle of 255.
constexpr float kMiddle = 128, kGain = 32;

cv::Mat as_mat(const RoundView& view) {
  return {view.height(), view.width(), CV_32F, const_cast<float*>(view.data())};
}

// The mean of `values` under a Gaussian, of what `weight` has alone.
cv::Mat local_mean(const cv::Mat& values, const cv::Mat& weight, double sigma_px) {
  cv::Mat sum, share;
  cv::GaussianBlur(values.mul(weight), sum, {}, sigma_px);
  cv::GaussianBlur(weight, share, {}, sigma_px);
  return sum / cv::max(share, 1e-3);
}

// Where each pixel of the round picture lies in the frame.
void places(const circle::Silhouette& outline, const RoundFrame& round, cv::Mat& x, cv::Mat& y) {
  const int side = round.side_px();
  x.create(side, side, CV_32F);
  y.create(side, side, CV_32F);
  const Circle& mean = outline.circle;
  const double xx = (mean.r_px + outline.e1_px) / round.radius_px;
  const double yy = (mean.r_px - outline.e1_px) / round.radius_px;
  const double xy = outline.e2_px / round.radius_px;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double u = column - round.centre_px(), v = row - round.centre_px();
      x.at<float>(row, column) = static_cast<float>(mean.cx_px + xx * u + xy * v);
      y.at<float>(row, column) = static_cast<float>(mean.cy_px + xy * u + yy * v);
    }
  }
}

}  // namespace

int RoundFrame::side_px() const {
  return 2 * (static_cast<int>(std::ceil(radius_px)) + kMargin_px) + 1;
}

RoundView round_view(const Frame& frame, const circle::Silhouette& outline,
                     const RoundFrame& round) {
  const Image<float> levels = frame.to_float();
  cv::Mat x, y, picture, inside, weight;
  places(outline, round, x, y);
  cv::remap(as_mat(levels), picture, x, y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const cv::Mat whole(outline.inside.height(), outline.inside.width(), CV_8U,
                      const_cast<std::uint8_t*>(outline.inside.data()));
  cv::Mat mask;
  cv::erode(whole, mask, cv::Mat(), {-1, -1}, kRim_px);
  mask.convertTo(weight, CV_32F, 1 / 255.0);
  cv::remap(weight, inside, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  const double surround_px = kSurround * round.radius_px;
  const double least = kLeastContrast * frame.full_scale() / 255;
  const cv::Mat mean = local_mean(picture, inside, surround_px);
  const cv::Mat off = picture - mean;
  cv::Mat deviation;
  cv::sqrt(local_mean(off.mul(off), inside, surround_px) + cv::Scalar(least * least), deviation);
  RoundView view(round.side_px(), round.side_px());
  cv::Mat texture = as_mat(view);
  const cv::Mat fine = local_mean(picture, inside, kFinest * round.radius_px);
  cv::Mat relative = (fine - mean) / deviation;
  relative.setTo(0, inside < 0.5);
  relative.copyTo(texture);
  return view;
}

Frame as_frame(const RoundView& view) {
  Frame frame;
  frame.reset(view.width(), view.height(), 8);
  for (std::size_t i = 0; i < view.size(); ++i) {
    frame.u8.data()[i] = static_cast<std::uint8_t>(
        std::clamp(std::lround(kMiddle + kGain * view.data()[i]), long{0}, long{255}));
  }
  return frame;
}

}  // namespace impactdic::motion
