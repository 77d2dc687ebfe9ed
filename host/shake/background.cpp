#include "host/shake/background.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "host/base/statistics.h"
#include "host/dic/frame_noise.h"

namespace impactdic::shake {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSide = 32, kPixels = kSide * kSide;
constexpr int kTaps = 6, kBefore = 2;  // of the interpolation, and those left of the point
constexpr double kSmooth_px = 1;
// Variance of a slope of noise of deviation 1 that was smoothed so (a derivative of a Gaussian's).
constexpr double kSlopeOfNoise = 0.04;
constexpr double kOverNoise = 4;  // a square with texture has so much more
constexpr std::size_t kMost = 96, kLeast = 8;
// The ball's blur, its glare and its contact's shadow lie within so much of its radius, and so far.
constexpr double kBallShare = 1.1, kBallMargin_px = 6;
constexpr int kSteps = 12;
constexpr double kSettled_px = 3e-4;
constexpr double kTukey = 5;         // deviations of a square's two displacements
constexpr double kRoll_rad = 0.003;  // that a camera shakes by where nothing tells it
// Of the variance of what two pictures differ by, the picture's own; the reference's noise
// displaces all alike.
constexpr double kOwnPart = 0.5;
constexpr double kAgree = 0.5, kMostSd_px = 0.1;

cv::Mat smoothed(const Frame& frame) {
  const int depth = frame.type == PixelType::kU8 ? CV_8U : CV_16U;
  const cv::Mat whole(frame.height(), frame.width(), depth, const_cast<void*>(frame.bytes()));
  cv::Mat picture;
  whole.convertTo(picture, CV_32F);
  cv::GaussianBlur(picture, picture, {}, kSmooth_px);
  return picture;
}

// What a picture shows but for the ball and for light that varies slowly, at half the size.
cv::Mat outlined(const cv::Mat& picture, const Disc& ball) {
  constexpr double kSlow_px = 8;
  cv::Mat half, slow, window;
  cv::resize(picture, half, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::GaussianBlur(half, slow, {}, kSlow_px);
  half -= slow;
  if (ball.r_px > 0) {
    const cv::Point middle(cvRound(ball.x_px / 2), cvRound(ball.y_px / 2));
    const int radius = cvRound((kBallShare * ball.r_px + kBallMargin_px) / 2);
    cv::circle(half, middle, radius, cv::Scalar(0), cv::FILLED);
  }
  cv::createHanningWindow(window, half.size(), CV_32F);
  return half.mul(window);
}

// By the highest value of the two pictures' correlation, to two pixels.
PictureShift shift_of(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat a, b, product, correlation;
  cv::dft(from, a);
  cv::dft(to, b);
  cv::mulSpectrums(b, a, product, 0, true);
  cv::idft(product, correlation, cv::DFT_SCALE);
  cv::Point at;
  cv::minMaxLoc(correlation, nullptr, nullptr, nullptr, &at);
  PictureShift shift;
  shift.x_px = 2.0 * (at.x > correlation.cols / 2 ? at.x - correlation.cols : at.x);
  shift.y_px = 2.0 * (at.y > correlation.rows / 2 ? at.y - correlation.rows : at.y);
  return shift;
}

// A square of the reference, its levels and slopes about their means.
struct Square {
  int x = 0, y = 0;  // of its first pixel
  std::vector<float> level, slope_x, slope_y;
  double level_sq = 0;
  Matrix2d slopes_sq = Matrix2d::Zero();
};

// What a square says of where it lies: slopes_sq * (where it lies beyond where it was thought to)
// is `pull`, with an error of covariance slopes_sq times a variance that all squares share.
struct Says {
  Matrix2d slopes_sq;
  Vector2d pull;
  Vector2d beside;  // of its middle, from the picture's
};

Eigen::Matrix<double, 2, 3> displacements(const Vector2d& beside) {
  Eigen::Matrix<double, 2, 3> by;
  by << 1, 0, -beside.y(), 0, 1, beside.x();
  return by;
}

void about_mean(std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += value;
  const auto mean = static_cast<float>(sum / static_cast<double>(values.size()));
  for (float& value : values) value -= mean;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i] * b[i]);
  return sum;
}

// Weights of the pixels about a point that lies so far behind the third of six: the polynomial
// through them (Lagrange).
std::array<float, kTaps> taps(double part) {
  std::array<float, kTaps> weights{};
  for (int k = 0; k < kTaps; ++k) {
    double weight = 1;
    for (int m = 0; m < kTaps; ++m) {
      if (m != k) weight *= (part + kBefore - m) / (k - m);
    }
    weights[static_cast<std::size_t>(k)] = static_cast<float>(weight);
  }
  return weights;
}

// The picture's levels in a square whose first pixel lies at (x, y); false where that leaves it.
bool levels_at(const cv::Mat& picture, double x, double y, std::vector<float>& out) {
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  constexpr int kBehind = kTaps - 1 - kBefore;
  if (left < kBefore || top < kBefore || left + kSide + kBehind > picture.cols ||
      top + kSide + kBehind > picture.rows) {
    return false;
  }
  const auto along_x = taps(x - left), along_y = taps(y - top);
  constexpr int kRows = kSide + kTaps - 1;
  thread_local std::vector<float> rows(kRows * kSide);  // memory only
  for (int r = 0; r < kRows; ++r) {
    const float* from = picture.ptr<float>(top - kBefore + r) + left - kBefore;
    float* to = rows.data() + r * kSide;
    for (int i = 0; i < kSide; ++i) {
      float sum = 0;
      for (int k = 0; k < kTaps; ++k) sum += along_x[static_cast<std::size_t>(k)] * from[i + k];
      to[i] = sum;
    }
  }
  out.resize(kPixels);
  for (int r = 0; r < kSide; ++r) {
    for (int i = 0; i < kSide; ++i) {
      float sum = 0;
      for (int k = 0; k < kTaps; ++k) {
        sum += along_y[static_cast<std::size_t>(k)] *
               rows[static_cast<std::size_t>((r + k) * kSide + i)];
      }
      out[static_cast<std::size_t>(r * kSide + i)] = sum;
    }
  }
  return true;
}

bool overlaps(const Vector2d& middle, const Disc& ball) {
  if (!(ball.r_px > 0)) return false;
  constexpr double kCorner = 0.5 * kSide * 1.4142;
  return std::hypot(middle.x() - ball.x_px, middle.y() - ball.y_px) <
         kBallShare * ball.r_px + kBallMargin_px + kCorner;
}

// The shift by which squares differ least from what they say, with Tukey's weights.
struct Solution {
  Vector3d step = Vector3d::Zero();  // along x and y, roll
  Matrix3d covariance = Matrix3d::Zero();
  double kept = 0;  // Σ of the weights
};

Solution solve(const std::vector<Says>& squares) {
  constexpr int kRounds = 8;
  Solution found;
  std::vector<double> weights(squares.size(), 1), far(squares.size());
  double variance = 0;
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d sum = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const auto by = displacements(squares[i].beside);
      sum += weights[i] * by.transpose() * squares[i].slopes_sq * by;
      pull += weights[i] * by.transpose() * squares[i].pull;
    }
    sum(2, 2) += variance / (kRoll_rad * kRoll_rad);
    const Eigen::LDLT<Matrix3d> solver(sum);
    found.step = solver.solve(pull);
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const Says& s = squares[i];
      const Vector2d off = s.pull - s.slopes_sq * displacements(s.beside) * found.step;
      const Matrix2d known = s.slopes_sq + 1e-3 * s.slopes_sq.trace() * Matrix2d::Identity();
      far[i] = off.dot(known.ldlt().solve(off));
    }
    constexpr double kMedianOfTwo = 1.386;  // of χ² with two degrees of freedom
    const double typical = upper_median(std::vector<double>(far)) / kMedianOfTwo;
    double scatter = 0;
    found.kept = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const double u = far[i] / (kTukey * kTukey * std::max(typical, 1e-30));
      weights[i] = u < 1 ? (1 - u) * (1 - u) : 0;
      found.kept += weights[i];
      scatter += weights[i] * far[i];
    }
    variance = std::max(typical, scatter / std::max(2 * found.kept - 3, 1.0));
    found.covariance = solver.solve(Matrix3d::Identity()) * variance;
  }
  return found;
}

}  // namespace

struct Background::Impl {
  cv::Mat reference;  // smoothed
  cv::Mat outline;    // the same as `outlined` makes it
  std::vector<Square> squares;
  Vector2d middle;

  Vector2d beside(const Square& square) const {
    constexpr double kHalf = 0.5 * (kSide - 1);
    return Vector2d(square.x + kHalf, square.y + kHalf) - middle;
  }
  Square square_at(int x, int y) const;
  std::optional<Says> ask(const Square& square, const cv::Mat& picture,
                          const PictureShift& at) const;
  PictureShift refine(const cv::Mat& picture, const Disc& ball, PictureShift at) const;
};

Square Background::Impl::square_at(int x, int y) const {
  Square square;
  square.x = x, square.y = y;
  for (int r = y; r < y + kSide; ++r) {
    const float *above = reference.ptr<float>(r - 1), *row = reference.ptr<float>(r),
                *below = reference.ptr<float>(r + 1);
    for (int i = x; i < x + kSide; ++i) {
      square.level.push_back(row[i]);
      square.slope_x.push_back(0.5f * (row[i + 1] - row[i - 1]));
      square.slope_y.push_back(0.5f * (below[i] - above[i]));
    }
  }
  for (auto* values : {&square.level, &square.slope_x, &square.slope_y}) about_mean(*values);
  square.level_sq = dot(square.level, square.level);
  const double xy = dot(square.slope_x, square.slope_y);
  square.slopes_sq << dot(square.slope_x, square.slope_x), xy, xy,
      dot(square.slope_y, square.slope_y);
  return square;
}

std::optional<Says> Background::Impl::ask(const Square& square, const cv::Mat& picture,
                                          const PictureShift& at) const {
  thread_local std::vector<float> levels;  // memory only
  const Vector2d from = beside(square);
  const Vector2d to =
      displacements(from) * Vector3d(at.x_px, at.y_px, at.roll_rad) + Vector2d(square.x, square.y);
  if (!levels_at(picture, to.x(), to.y(), levels)) return std::nullopt;
  about_mean(levels);
  const double contrast = dot(levels, square.level) / square.level_sq;
  if (!(contrast > 0.3)) return Says{square.slopes_sq, Vector2d::Constant(1e9), from};
  const auto per = static_cast<float>(1 / contrast);
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = square.level[i] - levels[i] * per;
  return Says{square.slopes_sq, {dot(levels, square.slope_x), dot(levels, square.slope_y)}, from};
}

PictureShift Background::Impl::refine(const cv::Mat& picture, const Disc& ball,
                                      PictureShift at) const {
  for (int step = 0; step < kSteps; ++step) {
    std::vector<Says> says;
    for (const Square& square : squares) {
      const Vector2d shift(at.x_px, at.y_px);
      if (overlaps(middle + beside(square) + shift, ball)) continue;
      if (const auto one = ask(square, picture, at)) says.push_back(*one);
    }
    if (says.size() < kLeast) return {};
    const Solution found = solve(says);
    if (!found.step.allFinite() || found.step.head<2>().norm() > kSide) return {};
    at.x_px += found.step.x(), at.y_px += found.step.y(), at.roll_rad += found.step.z();
    const bool settled = found.step.head<2>().norm() < kSettled_px;
    if (!settled) continue;
    at.x_sd_px = std::sqrt(kOwnPart * found.covariance(0, 0));
    at.y_sd_px = std::sqrt(kOwnPart * found.covariance(1, 1));
    at.roll_sd_rad = std::sqrt(kOwnPart * found.covariance(2, 2));
    at.known = found.kept > kAgree * static_cast<double>(says.size()) &&
               std::hypot(at.x_sd_px, at.y_sd_px) < kMostSd_px;
    return at.known ? at : PictureShift{};
  }
  return {};
}

Background::Background(const Frame& reference, const Disc& ball) {
  auto impl = std::make_unique<Impl>();
  impl->reference = smoothed(reference);
  impl->outline = outlined(impl->reference, ball);
  const int width = reference.width(), height = reference.height();
  impl->middle = {0.5 * (width - 1), 0.5 * (height - 1)};
  const Image<float> levels = reference.to_float();
  const double noise = dic::estimate_noise(levels.view(), reference.full_scale());
  const double least = kOverNoise * 2 * kSlopeOfNoise * noise * noise * kPixels;
  for (int y = 4; y + kSide + 4 <= height; y += kSide) {
    for (int x = 4; x + kSide + 4 <= width; x += kSide) {
      Square square = impl->square_at(x, y);
      const bool textured = square.slopes_sq.trace() > least && square.level_sq > 0;
      if (!textured || overlaps(impl->middle + impl->beside(square), ball)) continue;
      impl->squares.push_back(std::move(square));
    }
  }
  // What tells of both directions comes first.
  const auto tells = [](const Square& s) {
    return s.slopes_sq.determinant() / s.slopes_sq.trace();
  };
  std::stable_sort(impl->squares.begin(), impl->squares.end(),
                   [&](const Square& a, const Square& b) { return tells(a) > tells(b); });
  if (impl->squares.size() > kMost) {
    impl->squares.erase(impl->squares.begin() + kMost, impl->squares.end());
  }
  impl_ = std::move(impl);
}

Background::~Background() = default;

bool Background::shows_texture() const { return impl_->squares.size() >= kLeast; }

PictureShift Background::locate(const Frame& frame, const Disc& ball,
                                const PictureShift& guess) const {
  const cv::Mat picture = smoothed(frame);
  PictureShift found = impl_->refine(picture, ball, guess);
  if (found.known) return found;
  const PictureShift start = shift_of(impl_->outline, outlined(picture, ball));
  return impl_->refine(picture, ball, start);
}

}  // namespace impactdic::shake
