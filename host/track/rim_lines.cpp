// Lines across the rim along pixel rows and columns: profile as shares of the local contrast, and
// what the ball looks like inside.
#include "host/track/rim_lines.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/units.h"
#include "host/track/rim_model.h"

namespace impactdic {
namespace {

constexpr int kSectors = LineTrace::Levels::kSectors;
constexpr int kDeepEvery = 4;  // lines from one that reaches deep to the next, where many are cast
constexpr int kDeep = 8;       // its further samples, 4, 5 … 11 steps inside
constexpr int kBeside = 3;     // lines beside one with an obstacle that the obstacle's blur reaches
constexpr float kLeastContrast = 0.2f;     // of the usual contrast
constexpr float kNothing = 0.15f;          // of the contrast, inside the rim
constexpr float kGroundTolerance = 0.06f;  // of the contrast

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

struct Line {
  float cos, sin;  // direction of its point on the rim
  float outside;   // distance of the rim from the centre
  int sector;      // of kSectors
  int deep;        // index into Lines::deep, or −1
  Profile level;   // grey levels, every ball made bright
};
typedef std::array<float, kDeep> DeepLevels;
struct DeepLine {
  float x, y;  // place of the middle, in radii from the centre
  int line;
  DeepLevels level;
};
struct Lines {
  std::vector<Line> all;
  std::vector<DeepLine> deep;
  std::vector<float> scratch;
  std::array<std::vector<float>, kSectors> ground;
  float deep_step = 1;  // px
};

// Catmull and Rom's cubic through pixels `stride` apart.
template <typename T>
[[gnu::always_inline]] inline float along(const T* pixels, std::ptrdiff_t stride, float at) {
  const int i = static_cast<int>(at);
  const float t = at - static_cast<float>(i);
  const T* p = pixels + i * stride;
  const float a = p[-stride], b = p[0], c = p[stride], d = p[2 * stride];
  return b + 0.5f * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

// The rim as a conic a X² + 2b XY + c Y² = 1 about its centre.
struct Conic {
  double a, b, c;
  explicit Conic(const Rim& rim) {
    const double e = std::hypot(rim.e1, rim.e2);
    const double l = 1 / ((rim.r + e) * (rim.r + e)), s = 1 / ((rim.r - e) * (rim.r - e));
    const double half = 0.5 * (l - s), per_e = e > 0 ? 1 / e : 0;
    a = 0.5 * (l + s) + half * rim.e1 * per_e;
    c = 0.5 * (l + s) - half * rim.e1 * per_e;
    b = half * rim.e2 * per_e;
  }
  Conic(double a_, double b_, double c_) : a(a_), b(b_), c(c_) {}
  Conic transposed() const { return {c, b, a}; }
};

// Casts lines along one axis, v, on one side of the centre; u is the other axis. `pixels` runs
// along v with `along_v` elements from one to the next.
template <typename T>
class Caster {
 public:
  Caster(ImageView<const T> picture, const Rim& rim, float sign, float step, int stride,
         int deep_every, Lines& lines, int& cast)
      : picture_(picture),
        rim_(rim),
        sign_(sign),
        step_(step),
        stride_(stride),
        deep_every_(deep_every),
        lines_(lines),
        cast_(cast) {}

  // Columns: v is y. `side` is the sign of v, `order` that of u from line to line.
  void quarter(bool columns, int side, int order) {
    const Conic conic = columns ? Conic(rim_) : Conic(rim_).transposed();
    const double u0 = columns ? rim_.cx : rim_.cy, v0 = columns ? rim_.cy : rim_.cx;
    const int width = columns ? picture_.width : picture_.height;
    const int height = columns ? picture_.height : picture_.width;
    const std::ptrdiff_t to_u = columns ? 1 : picture_.pitch, to_v = columns ? picture_.pitch : 1;
    const double reach = rim_.r + std::hypot(rim_.e1, rim_.e2);
    const int low = static_cast<int>(std::ceil(u0 - reach));
    const int high = static_cast<int>(std::floor(u0 + reach));
    for (int k = 0; k <= high - low; k += stride_) {
      const int u = order > 0 ? low + k : high - k;
      const double x = u - u0;
      const double root = conic.b * conic.b * x * x - conic.c * (conic.a * x * x - 1);
      if (root <= 0) continue;
      const double y = (-conic.b * x + side * std::sqrt(root)) / conic.c;
      const double fx = conic.a * x + conic.b * y, fy = conic.b * x + conic.c * y;
      if (std::abs(fy) < std::abs(fx) || fy * side <= 0) continue;
      ++cast_;
      if (u < 0 || u >= width) continue;
      const double outside = std::sqrt(x * x + y * y);
      const double slope = outside * fy * side;  // of the excess along v, outwards
      add(picture_.data + u * to_u, to_v, height, v0 + y, side, slope, outside, columns ? x : y,
          columns ? y : x);
    }
  }

 private:
  void add(const T* pixels, std::ptrdiff_t stride, int height, double v, int side, double slope,
           double outside, double x, double y) {
    const float per = static_cast<float>(side / slope);
    const float bend =
        static_cast<float>(side * (1 - slope * slope) / (2 * outside * slope * slope * slope));
    const float at = static_cast<float>(v);
    const auto place = [&](float excess) { return at + excess * (per - excess * bend); };
    const float inner = place(-kInside * step_), outer = place(kOutside * step_);
    const float least = 1, most = static_cast<float>(height) - 2.01f;
    if (std::min(inner, outer) < least || std::max(inner, outer) > most) return;
    Line line;
    line.level = Profile{};
    for (int k = 0; k < kSamples; ++k) {
      line.level[k] = sign_ * along(pixels, stride, place(static_cast<float>(k - kInside) * step_));
    }
    const double per_outside = 1 / outside;
    line.cos = static_cast<float>(x * per_outside);
    line.sin = static_cast<float>(y * per_outside);
    line.outside = static_cast<float>(outside);
    line.deep = -1;
    if (cast_ % deep_every_ == 0) {
      const float deepest = place(-(kInside + kDeep) * lines_.deep_step);
      if (deepest >= least && deepest <= most) {
        line.deep = static_cast<int>(lines_.deep.size());
        DeepLine deep;
        for (int k = 0; k < kDeep; ++k) {
          deep.level[k] =
              sign_ * along(pixels, stride, place(-(kInside + 1 + k) * lines_.deep_step));
        }
        const float middle = static_cast<float>(
            (outside - (kInside + 0.5f * (1 + kDeep)) * lines_.deep_step) / rim_.r);
        deep.x = middle * line.cos;
        deep.y = middle * line.sin;
        deep.line = static_cast<int>(lines_.all.size());
        lines_.deep.push_back(deep);
      }
    }
    lines_.all.push_back(line);
  }

  ImageView<const T> picture_;
  Rim rim_;
  float sign_, step_;
  int stride_, deep_every_;
  Lines& lines_;
  int& cast_;
};

// 0 … 4 − ε around the rim in the order of the angle from −45° on, without an arctangent.
float turn(float c, float s) {
  if (c > std::abs(s)) return 0.5f + 0.5f * s / c;
  if (s >= std::abs(c)) return 1.5f - 0.5f * c / s;
  if (-c > std::abs(s)) return 2.5f + 0.5f * s / c;
  return 3.5f - 0.5f * c / s;
}

// Casts all lines, in the order of the angle from −45° on; returns how many, in the picture or not.
template <typename T>
int cast_lines(ImageView<const T> picture, const Rim& rim, float sign, float step, int most,
               int deep_every, Lines& lines) {
  lines.all.clear();
  lines.deep.clear();
  lines.deep_step = std::min(step, static_cast<float>(rim.r) / 24);
  const int stride = std::max(1, static_cast<int>(std::ceil(4 * std::sqrt(2.0) * rim.r / most)));
  int cast = 0;
  Caster<T> caster(picture, rim, sign, step, stride, deep_every, lines, cast);
  caster.quarter(false, 1, 1);
  caster.quarter(true, 1, -1);
  caster.quarter(false, -1, -1);
  caster.quarter(true, -1, 1);
  const std::size_t n = lines.all.size();
  for (std::size_t i = 0; i < n; ++i) {
    Line& line = lines.all[i];
    int sector =
        std::min(static_cast<int>(turn(line.cos, line.sin) * (kSectors / 4)), kSectors - 1);
    // The first and the last line may lie on the wrong side of −45° by a rounding.
    if (i < n / 2 && sector == kSectors - 1) sector = 0;
    if (i >= n / 2 && sector == 0) sector = kSectors - 1;
    line.sector = sector;
  }
  return cast;
}

// Noise of one sample: from line to line outside the ball, where nothing else changes.
float sample_noise(Lines& lines) {
  lines.scratch.clear();
  for (std::size_t i = 1; i < lines.all.size(); i += 2) {
    lines.scratch.push_back(
        std::abs(lines.all[i].level[kSamples - 1] - lines.all[i - 1].level[kSamples - 1]));
  }
  return 1.4826f / std::sqrt(2.0f) * quantile(lines.scratch, 0.5);
}

// The background's level by sector: the mean of what lies near the median of three sectors.
std::array<float, kSectors> ground_levels(Lines& lines, float noise) {
  std::array<float, kSectors> levels{};
  for (auto& sector : lines.ground) sector.clear();
  for (const Line& line : lines.all) {
    lines.ground[line.sector].push_back(line.level[kSamples - 1]);
  }
  const float window = 3 * noise + 0.5f;
  for (int b = 0; b < kSectors; ++b) {
    lines.scratch.clear();
    for (int d = -1; d <= 1; ++d) {
      const auto& sector = lines.ground[(b + d + kSectors) % kSectors];
      lines.scratch.insert(lines.scratch.end(), sector.begin(), sector.end());
    }
    if (lines.scratch.empty()) continue;
    const float middle = quantile(lines.scratch, 0.5);
    float sum = 0;
    int n = 0;
    for (const float value : lines.scratch) {
      const bool near = std::abs(value - middle) < window;
      sum += near ? value : 0;
      n += near;
    }
    levels[b] = sum / static_cast<float>(n);
  }
  return levels;
}

// Leaves only the deep lines that show the ball: something inside that is brighter than outside.
void drop_deep_in_front(Lines& lines) {
  const auto rise = [](const Line& line) {
    return std::max({line.level[0], line.level[1], line.level[2]}) - line.level[kSamples - 1];
  };
  lines.scratch.clear();
  for (std::size_t i = 0; i < lines.all.size(); i += 2) {
    lines.scratch.push_back(rise(lines.all[i]));
  }
  const float least = kNothing * quantile(lines.scratch, 0.9);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < lines.deep.size(); ++i) {
    Line& line = lines.all[lines.deep[i].line];
    line.deep = rise(line) > least ? static_cast<int>(kept) : -1;
    if (line.deep >= 0) lines.deep[kept++] = lines.deep[i];
  }
  lines.deep.resize(kept);
}

float light_at(const std::array<float, 5>& w, float x, float y) {
  return w[0] + w[1] * x + w[2] * y + w[3] * (x * x - y * y) + w[4] * 2 * x * y;
}

// The ball's own level around the rim (the paint's, not the ink's): the light on the ball as a
// quadratic in the place, w0 + w1 x + w2 y + w3 (x² − y²) + w4 2xy, through the upper crowd of the
// samples inside. It starts from what one sample in twenty exceeds in each sector, since on a
// densely inked ball little more shows the bare paint, and settles on what lies within a window
// about it that shrinks to the noise.
class BallLight {
 public:
  // `ground` is the background's level.
  void fit(Lines& lines, float ground, float noise) {
    struct Bright {
      Vector5 basis;
      double level;
    };
    std::array<Bright, kSectors> bright;
    int sectors = 0;
    std::size_t first = 0;
    const auto& deep = lines.deep;
    const auto sector_of = [&](std::size_t i) { return lines.all[deep[i].line].sector; };
    for (int sector = 0; sector < kSectors; ++sector) {
      lines.scratch.clear();
      const std::size_t begin = first;
      while (first < deep.size() && sector_of(first) == sector) {
        lines.scratch.insert(lines.scratch.end(), deep[first].level.begin(),
                             deep[first].level.end());
        ++first;
      }
      ends_[sector] = first;
      if (lines.scratch.size() < 8) continue;
      const DeepLine& middle = deep[(begin + first) / 2];
      bright[sectors++] = {basis(middle.x, middle.y), quantile(lines.scratch, 0.95)};
    }
    // Upper envelope of the sectors (expectile regression): a bar darkens whole sectors.
    w_.setZero();
    for (int pass = 0; pass < 6; ++pass) {
      Matrix5 a = Matrix5::Identity() * 1e-6;
      for (int m = 1; m < 5; ++m) a(m, m) = m < 3 ? 0.1 : 1;  // no shading unless it shows
      Vector5 b = Vector5::Zero();
      for (int k = 0; k < sectors; ++k) {
        const double off = bright[k].level - w_.dot(bright[k].basis);
        const double weight = pass == 0 || off > -0.02 * (w_[0] - ground) ? 1 : 0.03;
        a.noalias() += weight * bright[k].basis * bright[k].basis.transpose();
        b.noalias() += weight * bright[k].level * bright[k].basis;
      }
      w_ = a.ldlt().solve(b);
    }
    const float contrast = static_cast<float>(w_[0]) - ground;
    const float last = std::max(2.5f * noise, 0.015f * contrast);
    for (const float window :
         {std::max(0.08f * contrast, last), std::max(0.04f * contrast, last), last}) {
      settle(deep, window);
    }
  }
  std::array<float, 5> coefficients() const {
    std::array<float, 5> w;
    for (int m = 0; m < 5; ++m) w[m] = static_cast<float>(w_[m]);
    return w;
  }

 private:
  static Vector5 basis(double x, double y) { return {1, x, y, x * x - y * y, 2 * x * y}; }

  void settle(const std::vector<DeepLine>& deep, float window) {
    // A handful of samples at the present level, so that sectors without bare paint keep theirs.
    const std::array<float, 5> w = coefficients();
    Matrix5 a = Matrix5::Identity() * 5;
    Vector5 b = Vector5::Zero();
    std::size_t i = 0;
    for (int sector = 0; sector < kSectors; ++sector) {
      const std::size_t begin = i;
      float sum = 0;
      int n = 0;
      for (; i < ends_[sector]; ++i) {
        const float expected = light_at(w, deep[i].x, deep[i].y);
        for (int k = 0; k < kDeep; ++k) {
          const float off = deep[i].level[k] - expected;
          const bool near = std::abs(off) <= window;
          sum += near ? off : 0;
          n += near;
        }
      }
      if (n == 0) continue;
      const DeepLine& middle = deep[(begin + i) / 2];
      const Vector5 j = basis(middle.x, middle.y);
      a.noalias() += n * j * j.transpose();
      b.noalias() += sum * j;
    }
    w_ += a.ldlt().solve(b);
  }

  std::array<std::size_t, kSectors> ends_{};
  Vector5 w_ = Vector5::Zero();
};

// The background at a line whose outermost sample reads `seen`: linear between the middles of the
// sectors, or where an obstacle ends between them the nearer of the two.
float ground_at(const std::array<float, kSectors>& levels, const Line& line, float contrast) {
  const float at = turn(line.cos, line.sin) * (kSectors / 4) - 0.5f;
  const int b = static_cast<int>(at + 1) - 1;
  const float t = at - static_cast<float>(b);
  const float a = levels[(b + kSectors) % kSectors], c = levels[(b + 1) % kSectors];
  if (std::abs(a - c) < kGroundTolerance * contrast) return a + t * (c - a);
  const float seen = line.level[kSamples - 1];
  return std::abs(seen - a) < std::abs(seen - c) ? a : c;
}

void find_levels(Lines& lines, LineTrace::Levels& levels) {
  levels.noise = sample_noise(lines);
  levels.ground = ground_levels(lines, levels.noise);
  lines.scratch.assign(levels.ground.begin(), levels.ground.end());
  const float ground = quantile(lines.scratch, 0.5);
  BallLight light;
  light.fit(lines, ground, levels.noise);
  levels.light = light.coefficients();
  levels.usual = std::max(levels.light[0] - ground, 1e-6f);
}

}  // namespace

IMPACTDIC_WIDE void trace_lines(const Frame& frame, const Rim& rim, bool bright, double step_px,
                                int most_lines, const LineWants& wants, LineTrace& trace) {
  thread_local Lines lines;  // memory only
  const float step = static_cast<float>(step_px);
  const float sign = bright ? 1.0f : -1.0f;
  // A texture wants all that it can get, the light a hundred lines or two.
  const int deep_every = wants.texture      ? 1
                         : !wants.levels    ? most_lines
                         : most_lines > 400 ? kDeepEvery
                                            : 1;
  trace.cast = frame.type == PixelType::u8
                   ? cast_lines(frame.u8.view(), rim, sign, step, most_lines, deep_every, lines)
                   : cast_lines(frame.u16.view(), rim, sign, step, most_lines, deep_every, lines);
  trace.lines.clear();
  trace.in_view = static_cast<int>(lines.all.size());
  trace.step_px = step;
  if (lines.all.size() < 16) return;
  if (wants.levels) {
    drop_deep_in_front(lines);
    if (lines.deep.size() < 5) return;
    find_levels(lines, trace.levels);
  }
  const float noise = trace.levels.noise;
  const auto& light = trace.levels.light;
  const float usual = trace.levels.usual;
  trace.noise = std::max(noise / usual, 0.003f);

  const int n = static_cast<int>(lines.all.size());
  int blocked = -kBeside - 1;  // the last line with something else outside
  thread_local std::vector<int> kept;
  kept.clear();
  for (int i = 0; i < n; ++i) {
    const Line& line = lines.all[i];
    const float ball = light_at(light, line.cos, line.sin);
    const float outside = ground_at(trace.levels.ground, line, usual);
    const float contrast = ball - outside;
    const bool seen =
        contrast > kLeastContrast * usual && contrast > 6 * noise &&
        std::abs(line.level[kSamples - 1] - outside) < kGroundTolerance * contrast + 4 * noise;
    if (!seen) {
      blocked = i;
      while (!kept.empty() && kept.back() >= i - kBeside) {
        kept.pop_back();
        trace.lines.pop_back();
      }
      continue;
    }
    if (i - blocked <= kBeside) continue;
    const float per_contrast = 1 / contrast;
    Profile p = (line.level - outside) * per_contrast;
    p[kSamples] = 0;
    // Ink, or an obstacle across the rim.
    if (std::max({p[0], p[1], p[2]}) < std::max(kNothing, 5 * noise * per_contrast)) continue;
    const float relative = contrast / usual;
    kept.push_back(i);
    trace.lines.push_back({p, line.cos, line.sin, relative * relative,
                           std::min(static_cast<int>(turn(line.cos, line.sin) * (kRimSectors / 4)),
                                    kRimSectors - 1)});
    if (line.deep >= 0 && wants.texture) {
      // From the innermost of the deep samples to the innermost of the profile.
      const DeepLine& deep = lines.deep[line.deep];
      const float per = 1 / (light_at(light, deep.x, deep.y) - outside);
      float b[kDeep];
      for (int k = 0; k < kDeep; ++k) b[k] = (deep.level[kDeep - 1 - k] - outside) * per;
      for (int k = 0; k + kTexture <= kDeep; ++k) {
        wants.texture->add(b + k, static_cast<float>(trace.noise) / relative);
      }
    }
  }
}

}  // namespace impactdic
