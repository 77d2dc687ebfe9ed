// The rim of a ball in a picture: what measure_circle's three steps share. Internal to host/circle.
//
//   search_rim  rays over a wide range, strong edges, a robust first rim      (rim_search.cpp)
//   trace_rim   rays close to that rim, the sub-pixel edge of each            (rim_edge.cpp)
//   fit_rim     robust circle or ellipse through those edges                  (rim_fit.cpp)
#pragma once

#include <impactdic/image.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/circle.h"

namespace impactdic::circle {

// An ellipse about (cx, cy) with semi-axes r ± |e| (see CircleFit); all in px, image axes.
struct Rim {
  double cx = 0, cy = 0, r = 0, e1 = 0, e2 = 0;

  // Distance of the rim from the centre in the direction φ, from cos 2φ and sin 2φ; exact.
  double radius_at(double cos2, double sin2) const {
    const double e_sq = e1 * e1 + e2 * e2;
    return (r * r - e_sq) / std::sqrt(r * r + e_sq - 2 * r * (e1 * cos2 + e2 * sin2));
  }
};

inline Rim rim_of(const CirclePrior& prior) {
  const Circle& c = prior.predicted;
  return {c.cx_px, c.cy_px, c.r_px, prior.e1_px, prior.e2_px};
}

inline Rim rim_of(const CircleFit& fit) {
  const Circle& c = fit.circle;
  return {c.cx_px, c.cy_px, c.r_px, fit.e1_px, fit.e2_px};
}

// What may be fitted, and what is.
enum class Shapes { kCircle, kCircleOrEllipse };
enum class Shape { kCircle, kEllipse };

// Of the ball against what lies behind it.
enum class Polarity { kBright, kDark };
inline Polarity polarity_of(bool bright) { return bright ? Polarity::kBright : Polarity::kDark; }
inline Polarity opposite(Polarity p) {
  return p == Polarity::kBright ? Polarity::kDark : Polarity::kBright;
}
// Of grey levels, so that every ball is bright.
inline float sign_of(Polarity p) { return p == Polarity::kBright ? 1.0f : -1.0f; }

// A cubic kernel over 4×4 pixels. Smooth: the B-spline itself, a blur of σ² = 1/3 px² that makes an
// edge's place independent of the pixels' phase. Sharp: the cubic of Mitchell and Netravali (1988),
// B = C = 1/3, which errs with the phase but mixes less of the neighbourhood into an edge.
enum class Kernel { kSmooth, kSharp };

// A picture between its pixels, bilinear and bicubic. The point must lie inside by one pixel
// (bilinear) or two (bicubic).
template <typename T>
class Sampler {
 public:
  explicit Sampler(ImageView<const T> picture) : picture_(picture) {}

  float bilinear(float x, float y) const {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const T* a = picture_.data + iy * picture_.pitch + ix;
    const T* b = a + picture_.pitch;
    const float top = a[0] + fx * (static_cast<float>(a[1]) - a[0]);
    const float bottom = b[0] + fx * (static_cast<float>(b[1]) - b[0]);
    return top + fy * (bottom - top);
  }

  template <Kernel kKernel>
  float bicubic(float x, float y) const {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const Float4 wx = weights<kKernel>(x - static_cast<float>(ix));
    const Float4 wy = weights<kKernel>(y - static_cast<float>(iy));
    const T* row = picture_.data + (iy - 1) * picture_.pitch + (ix - 1);
    Float4 column = wy[0] * four(row);
    column += wy[1] * four(row + picture_.pitch);
    column += wy[2] * four(row + 2 * picture_.pitch);
    column += wy[3] * four(row + 3 * picture_.pitch);
    column *= wx;
    return (column[0] + column[1]) + (column[2] + column[3]);
  }

  // How far from (x, y) in the direction (dx, dy) the picture reaches, `margin` pixels kept free.
  float reach(float x, float y, float dx, float dy, float margin) const {
    const float right = static_cast<float>(picture_.width - 1) - margin;
    const float bottom = static_cast<float>(picture_.height - 1) - margin;
    const float far_x = dx > 0 ? (right - x) / dx : dx < 0 ? (margin - x) / dx : 1e9f;
    const float far_y = dy > 0 ? (bottom - y) / dy : dy < 0 ? (margin - y) / dy : 1e9f;
    return far_x < far_y ? far_x : far_y;
  }
  bool inside(float x, float y, float margin) const {
    return x >= margin && y >= margin && x <= static_cast<float>(picture_.width - 1) - margin &&
           y <= static_cast<float>(picture_.height - 1) - margin;
  }

 private:
  // Four lanes of a vector unit: GCC's and Clang's extension, so that one source serves all of
  // them.
  typedef float Float4 __attribute__((vector_size(16)));
  typedef T Pixel4 __attribute__((vector_size(4 * sizeof(T))));

  static Float4 four(const T* pixels) {
    Pixel4 p;
    std::memcpy(&p, pixels, sizeof(p));
    return __builtin_convertvector(p, Float4);
  }
  template <Kernel kKernel>
  static Float4 weights(float t) {
    constexpr float k = 1.0f / 18;
    if constexpr (kKernel == Kernel::kSharp) {
      return ((Float4{-7, 21, -21, 7} * k * t + Float4{15, -36, 27, -6} * k) * t +
              Float4{-9, 0, 9, 0} * k) *
                 t +
             Float4{1, 16, 1, 0} * k;
    }
    return ((Float4{-3, 9, -9, 3} * k * t + Float4{9, -18, 9, 0} * k) * t +
            Float4{-9, 0, 9, 0} * k) *
               t +
           Float4{3, 12, 3, 0} * k;
  }
  ImageView<const T> picture_;
};

// Sectors of the rim in which levels are found, and in which its points and lines are counted.
inline constexpr int kLevelSectors = 24, kRimSectors = 48;

// The robust first rim.
struct RimSearch {
  bool found = false;
  Rim rim;
  Polarity polarity = Polarity::kBright;
  double support = 0;   // share of the rays in view that have a strong edge within 1 px of the rim
  double strength = 0;  // grey levels that a fifth of the rays' strongest edges exceed
  double in_view = 0;   // share of the full rim whose rays lie in the picture
  double blur_px = 1;   // scale of the edge: contrast / steepest slope / √(2π)
};
RimSearch search_rim(const Frame& frame, const CirclePrior& prior, const CircleOptions& options);
// Where a ball leaves the background: by single rays that leave it clearly; or, before an even
// background, by rays pooled with their neighbours, less than the noise of a sample.
enum class Departures { kClear, kPooled };
// The same by where the rays leave the background, whether to the brighter or to the darker.
// `found` where most rays agree.
RimSearch search_outline(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                         Departures departures);

// One sub-pixel edge: direction from the rim's centre and distance beyond the rim.
struct RimPoint {
  float cos, sin;
  float excess;  // px, positive outside `rim`
  float weight;  // usual error over this point's, from the contrast
  int sector;    // 0 … kRimSectors − 1, by the angle
};
// By how much the background's level rises to the right and downwards over the radius, of the
// contrast.
struct GroundRise {
  double x = 0, y = 0;
};

struct RimTrace {
  std::vector<RimPoint> points;  // accepted only, in the order of the angle
  int rays_in_view = 0;
  double noise_px = 0;       // what the camera noise alone would scatter a crossing
  double edge_sigma_px = 0;  // width of the edge as a Gaussian's σ
  double brightest = 0;  // grey level of a bright ball's paint, or of what lies behind a dark one
  GroundRise rise;
};
struct RayRequest {
  Polarity polarity = Polarity::kBright;
  double blur_px = 1;  // of the edge, as in RimSearch
  Kernel kernel = Kernel::kSmooth;
  int rays = 720;  // all around the rim
  // The background may change from pixel to pixel: its level is told at each edge. What hides the
  // ball looks like such a background.
  bool textured = false;
};
// Casts rays across `rim` and keeps the clean edges: ball inside, background outside,
// and the usual shape between them. `trace` keeps its memory from call to call.
void trace_rim(const Frame& frame, const Rim& rim, const RayRequest& request, RimTrace& trace);

// The same for a rim without a polarity: where each ray leaves the background, to either side.
void trace_outline(const Frame& frame, const Rim& rim, double blur_px, int count, RimTrace& trace);
// Before an even background by rays pooled with their neighbours; false where it is not even.
bool trace_pooled_outline(const Frame& frame, const Rim& rim, double blur_px, int count,
                          RimTrace& trace);

// The fit through traced points.
// Of a fit that was told the radius of other frames.
struct RadiusOfFrame {
  double follows[5] = {};        // by how much cx, cy, r, e1, e2 follow an error of it
  double r_px = 0, r_sd_px = 0;  // what the fit would say without it; `r_px` is the rim's
  double misplaced = 0;          // variance of that radius, as LineFit::misplaced
};
struct RimFit {
  bool ok = false;
  Rim rim;
  bool ellipse = false;
  double sd[5] = {};           // cx, cy, r, e1, e2
  double with_radius[2] = {};  // CircleFit::cx_with_r, cy_with_r
  RadiusOfFrame own;
  double residual_px = 0;  // scatter of the clean points
  double inked = 0;        // share of the points into which ink or an obstacle reaches
  int points = 0;          // with a weight of at least one half
  double arc = 0;          // share of the rim's kRimSectors sectors that hold such points
};
RimFit fit_rim(const RimTrace& trace, const Rim& rim, const CirclePrior& prior, Shapes shapes);
// A circle through an outline, whose points scatter evenly; to a tenth of a pixel or two.
RimFit fit_outline(const RimTrace& trace, const Rim& rim);

}  // namespace impactdic::circle
