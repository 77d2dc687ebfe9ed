#include "sim/speckle/lens.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/parallel/parallel_for.h"

namespace impactdic::sim::speckle {
namespace {

constexpr int kPoints = 6;
constexpr int kMostSteps = 50;

// Weights of Lagrange's polynomial through six points at -2 … 3, at `t` between 0 and 1.
std::array<double, kPoints> lagrange(double t) {
  std::array<double, kPoints> weights;
  for (int i = 0; i < kPoints; ++i) {
    double weight = 1;
    for (int k = 0; k < kPoints; ++k) {
      if (k != i) weight *= (t - (k - 2)) / (i - k);
    }
    weights[static_cast<std::size_t>(i)] = weight;
  }
  return weights;
}

double fine(double px) { return kFiner * (px + 0.5) - 0.5; }

BallPose fine(BallPose pose) {
  pose.cx_px = fine(pose.cx_px);
  pose.cy_px = fine(pose.cy_px);
  pose.z_px *= kFiner;
  return pose;
}

// The mean of kFiner pixels a side about every pixel; at the border of those that there are.
Image<double> box_mean(const Image<double>& in) {
  const int half = kFiner / 2;
  const auto clamp = [](int at, int size) { return std::clamp(at, 0, size - 1); };
  Image<double> rows(in.width(), in.height()), out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      double sum = 0;
      for (int k = -half; k <= half; ++k) sum += in(clamp(x + k, in.width()), y);
      rows(x, y) = sum / kFiner;
    }
  }
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      double sum = 0;
      for (int k = -half; k <= half; ++k) sum += rows(x, clamp(y + k, in.height()));
      out(x, y) = sum / kFiner;
    }
  }
  return out;
}

double interpolate(const Image<double>& in, const Vec& at) {
  const int x0 = static_cast<int>(std::floor(at.x)), y0 = static_cast<int>(std::floor(at.y));
  const auto across = lagrange(at.x - x0), down = lagrange(at.y - y0);
  double sum = 0;
  for (int j = 0; j < kPoints; ++j) {
    const double* row = in.row(std::clamp(y0 + j - 2, 0, in.height() - 1));
    double line = 0;
    for (int i = 0; i < kPoints; ++i) {
      line += across[static_cast<std::size_t>(i)] * row[std::clamp(x0 + i - 2, 0, in.width() - 1)];
    }
    sum += down[static_cast<std::size_t>(j)] * line;
  }
  return sum;
}

}  // namespace

bool bends(const SynthScene& scene) { return scene.distortion_k1 != 0 || scene.distortion_k2 != 0; }

Vec straightened(const SynthScene& scene, const Vec& point_px) {
  const Vec middle{(scene.width - 1) / 2.0, (scene.height - 1) / 2.0};
  const double half = std::hypot(scene.width, scene.height) / 2;
  const Vec off{point_px.x - middle.x, point_px.y - middle.y};
  const double seen = std::hypot(off.x, off.y) / half;
  if (seen == 0) return point_px;
  double q = seen;
  for (int step = 0; step < kMostSteps; ++step) {
    const double s = q * q, k1 = scene.distortion_k1, k2 = scene.distortion_k2;
    const double change = (seen - q * (1 + s * (k1 + s * k2))) / (1 + s * (3 * k1 + 5 * s * k2));
    q += change;
    if (std::abs(change) < 1e-15) break;
  }
  return {middle.x + off.x * q / seen, middle.y + off.y * q / seen};
}

SynthScene finer(SynthScene scene) {
  scene.width *= kFiner;
  scene.height *= kFiner;
  scene.psf_sigma_px *= kFiner;
  scene.distortion_k1 = scene.distortion_k2 = 0;
  if (scene.bar) {
    scene.bar->x_px = fine(scene.bar->x_px);
    scene.bar->y_px = fine(scene.bar->y_px);
    scene.bar->width_px *= kFiner;
  }
  return scene;
}

SpeckleBall finer(SpeckleBall ball) {
  ball.radius_px *= kFiner;
  for (InkDisc& disc : ball.discs) {
    disc.x_px *= kFiner, disc.y_px *= kFiner, disc.radius_px *= kFiner;
  }
  for (InkLine& line : ball.lines) {
    line.x_px *= kFiner, line.y_px *= kFiner, line.length_px *= kFiner, line.width_px *= kFiner;
  }
  return ball;
}

SpeckleSphere finer(SpeckleSphere sphere) {
  sphere.radius_px *= kFiner;
  for (InkCap& cap : sphere.caps) cap.radius_px *= kFiner;
  for (InkStrip& strip : sphere.strips) strip.length_px *= kFiner, strip.width_px *= kFiner;
  return sphere;
}

BentRenderer::BentRenderer(std::unique_ptr<FrameRenderer> fine_renderer, const SynthScene& scene)
    : fine_(std::move(fine_renderer)), scene_(scene) {
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const Vec at = straightened(scene, {static_cast<double>(x), static_cast<double>(y)});
      places_.push_back({fine(at.x), fine(at.y)});
    }
  }
}

Image<double> BentRenderer::exact(const ShutterPath& path) const {
  const Image<double> smooth =
      box_mean(fine_->exact({fine(path.open), fine(path.middle), fine(path.close)}));
  Image<double> out(scene_.width, scene_.height);
  double* pixels = out.data();
  parallel_for(static_cast<std::size_t>(scene_.height), [&](std::size_t y) {
    const std::size_t row = y * static_cast<std::size_t>(scene_.width);
    for (std::size_t i = row; i < row + static_cast<std::size_t>(scene_.width); ++i) {
      pixels[i] = interpolate(smooth, places_[i]);
    }
  });
  return out;
}

void BentRenderer::render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const {
  Image<double> grey = exact(path);
  develop(grey, scene_, frame_index, out);
}

}  // namespace impactdic::sim::speckle
