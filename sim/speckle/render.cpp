#include "sim/speckle/render.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/parallel/parallel_for.h"
#include "sim/speckle/render_parts.h"

namespace impactdic::sim::speckle {
namespace {

constexpr int kRowsPerBand = 16;

// Gauss–Hermite rule for a normal deviate of standard deviation 1.
struct NormalNode {
  double at, weight;
};
constexpr std::array<NormalNode, 3> kNormal3{
    {{-1.7320508075688772, 1.0 / 6}, {0, 2.0 / 3}, {1.7320508075688772, 1.0 / 6}}};
constexpr std::array<NormalNode, 5> kNormal5{{{-2.8569700138728056, 0.011257411327720688},
                                              {-1.3556261799742659, 0.2220759220056126},
                                              {0, 8.0 / 15},
                                              {1.3556261799742659, 0.2220759220056126},
                                              {2.8569700138728056, 0.011257411327720688}}};

}  // namespace

int samples_per_pixel(double sigma_px) { return sigma_px >= 0.5 ? 3 : sigma_px >= 0.4 ? 4 : 5; }

BallRenderer::BallRenderer(SpeckleBall ball, const SynthScene& scene)
    : ball_(std::move(ball)),
      scene_((scene.validate(), scene)),
      outline_(ball_.radius_px, scene.psf_sigma_px),
      per_pixel_(samples_per_pixel(scene.psf_sigma_px)),
      pixel_(shared_samples(per_pixel_, per_pixel_ + kExtraTaps)) {
  inks_.reserve(ball_.discs.size());
  for (const InkDisc& disc : ball_.discs) inks_.emplace_back(disc.radius_px, scene.psf_sigma_px);
  backdrop_ = make_backdrop(scene_, pixel_);
}

BallRenderer::Placed BallRenderer::place(const BallPose& pose, double shift_px,
                                         double weight) const {
  const double c = pose.compression;
  if (!(c >= 0 && c <= 0.5)) {
    throw InvalidArgument("the compression is out of range", "pose", "0 … 0.5 of the diameter");
  }
  const Vec axis = direction(pose.compression_axis_deg), turn = direction(pose.angle_deg);
  Placed p;
  p.cx = pose.cx_px + shift_px * axis.x;
  p.cy = pose.cy_px + shift_px * axis.y;
  p.weight = weight;
  const double grow = c / (1 - c);  // A = I − c n nᵀ, A⁻¹ = I + c/(1 − c) n nᵀ
  p.m00 = 1 + grow * axis.x * axis.x;
  p.m01 = grow * axis.x * axis.y;
  p.m11 = 1 + grow * axis.y * axis.y;
  p.kxx = p.m00 * p.m00 + p.m01 * p.m01;
  p.kxy = p.m01 * (p.m00 + p.m11);
  p.kyy = p.m01 * p.m01 + p.m11 * p.m11;
  // Counter-clockwise on the screen with y down: (x, y) -> (x cos + y sin, −x sin + y cos).
  const auto on_screen = [&](double x, double y) -> Vec {
    const Vec turned{x * turn.x - y * turn.y, x * turn.y + y * turn.x};
    const double squeeze = c * (turned.x * axis.x + turned.y * axis.y);
    return {p.cx + turned.x - squeeze * axis.x, p.cy + turned.y - squeeze * axis.y};
  };
  p.discs.reserve(ball_.discs.size());
  for (const InkDisc& disc : ball_.discs) p.discs.push_back(on_screen(disc.x_px, disc.y_px));
  for (const InkLine& line : ball_.lines) {
    p.lines.push_back(
        {on_screen(line.x_px, line.y_px), direction(line.angle_deg + pose.angle_deg)});
  }
  const Vec lamp = direction(scene_.lamp_deg);
  const double fall = scene_.shading / 2 / ball_.radius_px;
  p.shade_x = fall * lamp.x;
  p.shade_y = fall * lamp.y;
  p.shade0 = 1 - scene_.shading / 2 - p.shade_x * p.cx - p.shade_y * p.cy;
  return p;
}

std::vector<BallRenderer::Placed> BallRenderer::instants(const ShutterPath& path) const {
  std::vector<Placed> out;
  for (const auto& [pose, weight] : instants_of(path, ball_.radius_px)) {
    // The ball's blur is squeezed with it to σ (1 − c) along the axis; the lens has σ there.
    const double lost =
        scene_.psf_sigma_px * std::sqrt(std::max(0.0, pose.compression * (2 - pose.compression)));
    if (lost == 0) {
      out.push_back(place(pose, 0, weight));
    } else if (lost < 0.15) {
      for (const auto& n : kNormal3) out.push_back(place(pose, lost * n.at, weight * n.weight));
    } else {
      for (const auto& n : kNormal5) out.push_back(place(pose, lost * n.at, weight * n.weight));
    }
  }
  return out;
}

Image<double> BallRenderer::exact(const BallPose& pose) const {
  return exact(ShutterPath{pose, pose, pose});
}

Image<double> BallRenderer::exact(const ShutterPath& path) const {
  Image<double> out = backdrop_;
  const std::vector<Placed> placed = instants(path);
  const int bands = (out.height() + kRowsPerBand - 1) / kRowsPerBand;
  parallel_for(static_cast<std::size_t>(bands), [&](std::size_t band) {
    const int first = static_cast<int>(band) * kRowsPerBand,
              last = std::min(out.height(), first + kRowsPerBand);
    for (const Placed& one : placed) add_rows(one, first, last, out);
  });
  return out;
}

void BallRenderer::render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const {
  Image<double> grey = exact(path);
  develop(grey, scene_, frame_index, out);
}

}  // namespace impactdic::sim::speckle
