// The levels about a rim, from lines across it.
#include "host/circle/rim/rim_levels.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/light_by_means.h"

namespace impactdic::circle {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// Room for values in whole blocks of lanes, and a few more.
void make_room(std::vector<float>& values, std::size_t n) { values.resize(n + kLanes); }

[[gnu::always_inline]] inline Lanes eight_at(const float* values) {
  Lanes v;
  load(values, v);
  return v;
}

// The value below which the share `q` of `n` values lies, one at least, to half of `tolerance`.
// There is room for kLanes more values behind them. Not the `quantile` of host/base/statistics.h,
// which is exact and takes three times as long: grey levels are noisy by more than the tolerance.
IMPACTDIC_WIDE float near_quantile(float* values, std::size_t n, float q, float tolerance) {
  // Whole blocks, filled up with the first value.
  const std::size_t blocks = (n + kLanes - 1) / kLanes;
  const float filled = static_cast<float>(blocks * kLanes - n);
  std::fill(values + n, values + blocks * kLanes, values[0]);
  Lanes least = eight_at(values), most = least;
  for (std::size_t i = 1; i < blocks; ++i) {
    const Lanes v = eight_at(values + i * kLanes);
    least = v < least ? v : least;
    most = v > most ? v : most;
  }
  float low = least[0], high = most[0];
  for (std::size_t lane = 1; lane < kLanes; ++lane) {
    low = std::min(low, least[lane]);
    high = std::max(high, most[lane]);
  }
  const float rank = q * static_cast<float>(n);
  while (high - low > tolerance) {
    const float pivot = 0.5f * (low + high);
    if (!(pivot > low && pivot < high)) break;
    Lanes up_to{};
    for (std::size_t i = 0; i < blocks; ++i) {
      up_to += eight_at(values + i * kLanes) <= pivot ? Lanes{} + 1 : Lanes{};
    }
    const float n_up_to = total_of(up_to) - (values[0] <= pivot ? filled : 0);
    (n_up_to > rank ? high : low) = pivot;
  }
  return 0.5f * (low + high);
}

// Noise of one sample: from one line to another, so many farther, outside the ball.
float noise_between(const std::vector<float>& outermost, std::size_t lines_apart) {
  thread_local std::vector<float> steps;  // memory only
  steps.clear();
  for (std::size_t i = lines_apart; i < outermost.size(); i += 2) {
    steps.push_back(std::abs(outermost[i] - outermost[i - lines_apart]));
  }
  return noise_of_steps(steps);
}

// Of lines side by side, where nothing else changes. Some cameras and recorders make noise that is
// alike in pixels that touch: there it is that of lines some pixels apart, if those farther apart
// differ by no more, as what lies behind the ball does.
float sample_noise(const std::vector<float>& outermost) {
  const float near = noise_between(outermost, 1);
  const float far = noise_between(outermost, kLineLevels.noise_apart);
  if (!(far > kLineLevels.noise_alike * near)) return near;
  const float farther = noise_between(outermost, 2 * kLineLevels.noise_apart);
  return farther < kLineLevels.noise_even * far ? far : near;
}

// Sum and number of the values near a middle.
IMPACTDIC_WIDE void sum_near(const float* values, int n, float middle, float window, float& sum,
                             float& count) {
  Lanes off_sum{}, near_count{};
  for (int i = 0; i < n; i += kLanes) {
    const Lanes off = eight_at(values + i) - middle;
    const auto near = (off < window) & (off > -window) & (kCount < static_cast<float>(n - i));
    off_sum += near ? off : Lanes{};
    near_count += near ? Lanes{} + 1 : Lanes{};
  }
  count = total_of(near_count);
  sum = total_of(off_sum);
}

// The background's level by sector: the mean of what lies near the middle of its own median and
// the neighbours'.
std::array<float, kLevelSectors> ground_levels(const CastLines& lines,
                                               const std::vector<float>& outermost, float noise) {
  // Lines of each sector, with the last one before the first, and the first after the last.
  std::array<int, kLevelSectors> count{};
  for (int i = 0; i < lines.size(); ++i) ++count[lines.sector(i, kLevelSectors)];
  const int n = lines.size(), before = count[kLevelSectors - 1], after = count[0];
  thread_local std::vector<float> around, own;  // memory only
  make_room(around, static_cast<std::size_t>(before + n + after));
  std::copy(outermost.end() - before, outermost.end(), around.begin());
  std::copy(outermost.begin(), outermost.end(), around.begin() + before);
  std::copy(outermost.begin(), outermost.begin() + after, around.begin() + before + n);

  const float window = kLineLevels.ground_noise * noise + kLineLevels.ground_least;
  std::array<float, kLevelSectors> medians{};
  for (int b = 0, from = before; b < kLevelSectors; from += count[b++]) {
    if (count[b] == 0) continue;
    make_room(own, static_cast<std::size_t>(count[b]));
    std::copy_n(around.begin() + from, count[b], own.begin());
    medians[b] = near_quantile(own.data(), static_cast<std::size_t>(count[b]), 0.5f,
                               kLineLevels.ground_tolerance * window);
  }
  std::array<float, kLevelSectors> levels{};
  for (int b = 0, from = 0; b < kLevelSectors; ++b) {
    float values[3] = {};
    int known = 0, among = 0;
    for (const int sector : {(b + kLevelSectors - 1) % kLevelSectors, b, (b + 1) % kLevelSectors}) {
      if (count[sector] > 0) values[known++] = medians[sector];
      among += count[sector];
    }
    if (known > 0) {
      const float low = std::min(values[0], values[1]), high = std::max(values[0], values[1]);
      const float middle = known == 3   ? std::max(low, std::min(high, values[2]))
                           : known == 2 ? high
                                        : values[0];
      float sum, near;
      sum_near(around.data() + from, among, middle, window, sum, near);
      levels[b] = middle + sum / std::max(near, 1.0f);
    }
    from += b == 0 ? before : count[b - 1];
  }
  return levels;
}

// Leaves only the deep lines that show the ball: something inside that is brighter than outside.
void drop_hidden_deep_lines(CastLines& lines) {
  const auto rise = [](const Profile& p) { return std::max({p[0], p[1], p[2]}) - p[kSamples - 1]; };
  thread_local std::vector<float> rises;  // memory only
  const auto n = static_cast<std::size_t>(lines.size() + 1) / 2;
  make_room(rises, n);
  float most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    rises[i] = rise(lines.level[2 * i].v);
    most = std::max(most, rises[i]);
  }
  const float least = kClear.nothing * near_quantile(rises.data(), n, kLineLevels.rise_rank,
                                                     kLineLevels.rise_tolerance * most);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < lines.deep_line.size(); ++i) {
    if (!(rise(lines.level[lines.deep_line[i]].v) > least)) continue;
    lines.deep_line[kept] = lines.deep_line[i];
    lines.deep_x[kept] = lines.deep_x[i];
    lines.deep_y[kept] = lines.deep_y[i];
    lines.deep_level[kept] = lines.deep_level[i];
    ++kept;
  }
  lines.deep_line.resize(kept);
  lines.deep_x.resize(kept);
  lines.deep_y.resize(kept);
  lines.deep_level.resize(kept);
}

// How many of the deep samples of lines `begin` to `end` lie within a window about the paint's
// level, and how far off they lie, added up.
IMPACTDIC_WIDE void sum_near_light(const CastLines& lines, int begin, int end,
                                   const std::array<float, 5>& light, float window, float& n,
                                   float& sum) {
  Lanes off_sum{}, count{};
  for (int i = begin; i < end; ++i) {
    const Lanes off = lines.deep_level[i].v - light_at(light, lines.deep_x[i], lines.deep_y[i]);
    const auto near = (off <= window) & (off >= -window);
    off_sum += near ? off : Lanes{};
    count += near ? Lanes{} + 1 : Lanes{};
  }
  n = total_of(count);
  sum = total_of(off_sum);
}

// The paint's level (see rim_levels.h) through the upper crowd of the deep samples. It starts from
// what one sample in twenty exceeds in each sector, and settles on what lies within a window about
// it that shrinks to the noise.
class LineLight {
 public:
  // `ground` is the background's level.
  void fit(const CastLines& lines, float ground, float noise) {
    const int n = static_cast<int>(lines.deep_line.size());
    sectors_ = 0;
    for (int begin = 0; begin < n;) {
      const int sector = lines.sector(lines.deep_line[begin], kLevelSectors);
      int end = begin;
      while (end < n && lines.sector(lines.deep_line[end], kLevelSectors) == sector) ++end;
      const double x = lines.deep_x[(begin + end) / 2], y = lines.deep_y[(begin + end) / 2];
      const auto samples = static_cast<std::size_t>((end - begin) * kDeep);
      make_room(samples_, samples);
      std::memcpy(samples_.data(), &lines.deep_level[begin], samples * sizeof(float));
      const float bright =
          near_quantile(samples_.data(), samples, static_cast<float>(kLevels.bright),
                        kLineLevels.bright_noise * noise + kLineLevels.bright_least);
      parts_[sectors_++] = {begin, end, {1, x, y, x * x - y * y, 2 * x * y}, bright};
      begin = end;
    }
    find_envelope(ground);
    const float contrast = static_cast<float>(w_[0]) - ground;
    for (const float window : settling_windows(contrast, noise)) settle(lines, window);
  }
  std::array<float, 5> coefficients() const {
    std::array<float, 5> w;
    for (int m = 0; m < 5; ++m) w[m] = static_cast<float>(w_[m]);
    return w;
  }

 private:
  struct Part {
    int begin, end;  // its deep lines
    std::array<double, 5> basis;
    double level;  // that one sample in twenty exceeds
  };
  struct Normal {
    Matrix5 a = Matrix5::Zero();  // its lower triangle
    Vector5 b = Vector5::Zero();
    void add(const std::array<double, 5>& j, double weight, double weighted) {
      for (int m = 0; m < 5; ++m) {
        for (int n = 0; n <= m; ++n) a(m, n) += weight * j[m] * j[n];
        b[m] += weighted * j[m];
      }
    }
    Vector5 solution() const { return a.llt().solve(b); }
  };

  // Upper envelope of the sectors.
  void find_envelope(float ground) {
    w_.setZero();
    std::array<bool, kLevelSectors> below{};
    for (int pass = 0; pass < kLevels.envelope_passes; ++pass) {
      Normal normal;
      for (int m = 0; m < 5; ++m) normal.a(m, m) = no_shading(m);
      bool same = pass > 0;
      for (int k = 0; k < sectors_; ++k) {
        const Part& part = parts_[k];
        double off = part.level;
        for (int m = 0; m < 5; ++m) off -= w_[m] * part.basis[m];
        const bool is_below = pass > 0 && off <= -kLevels.below * (w_[0] - ground);
        same = same && is_below == below[k];
        below[k] = is_below;
        const double weight = is_below ? kLevels.below_weight : 1;
        normal.add(part.basis, weight, weight * part.level);
      }
      if (same) return;
      w_ = normal.solution();
    }
  }

  void settle(const CastLines& lines, float window) {
    const std::array<float, 5> w = coefficients();
    Normal normal;
    normal.a.diagonal().setConstant(kLevels.held);
    for (int k = 0; k < sectors_; ++k) {
      const Part& part = parts_[k];
      float n, sum;
      sum_near_light(lines, part.begin, part.end, w, window, n, sum);
      if (n > 0) normal.add(part.basis, n, sum);
    }
    w_ += normal.solution();
  }

  std::array<Part, kLevelSectors> parts_;
  int sectors_ = 0;
  std::vector<float> samples_;  // memory only
  Vector5 w_ = Vector5::Zero();
};

}  // namespace

bool find_sphere_levels(const Frame& frame, const Rim& rim, const LineRequest& request,
                        const CastLines& lines, LineTrace::Levels& levels) {
  thread_local std::vector<float> outermost;  // memory only
  thread_local SphereSamples samples;         // memory only
  outermost.clear();
  for (const Eight& level : lines.level) outermost.push_back(level.v[kSamples - 1]);
  levels.noise = noise_between(outermost, 1);
  levels.ground = ground_levels(lines, outermost, levels.noise);
  const float ground = quantile(levels.ground, 0.5);
  if (request.surface == Surface::kOutline && request.light) {
    levels.sphere = *request.light;
  } else {
    sample_sphere(frame, rim, request.polarity, request.step_px, levels.noise,
                  request.surface == Surface::kOutline ? kSphere.layers : 1, samples);
    const auto light = fit_sphere_light(samples, ground, levels.noise, request.light);
    if (!light) return false;
    levels.sphere = *light;
    if (request.surface == Surface::kSphere && !request.light && hides_paint(samples, *light)) {
      sample_sphere(frame, rim, request.polarity, request.step_px, levels.noise, kSphere.layers,
                    samples);
      levels.sphere = checked_by_means(samples, ground, *light);
    }
  }
  levels.usual = kLineLevels.least_contrast;
  for (int k = 0; k < kLevelSectors; ++k) {
    const double angle = (k + 0.5) * 2 * kPi / kLevelSectors;
    const double level = levels.sphere.at(std::cos(angle), std::sin(angle), kSphere.rim_z);
    levels.usual = std::max(levels.usual, static_cast<float>(level) - ground);
  }
  return true;
}

double middle_of_rays(int sector) { return (sector + 0.5) * 2 * kPi / kLevelSectors; }

double middle_of_lines(int sector) {
  constexpr int kOfQuarter = kLevelSectors / 4;
  const int quarter = sector / kOfQuarter;
  const double tangent = 2 * (sector % kOfQuarter + 0.5) / kOfQuarter - 1;
  return std::atan(tangent) + quarter * (kPi / 2);
}

GroundRise rise_of_ground(const std::array<float, kLevelSectors>& ground, float contrast,
                          double (*middle)(int sector)) {
  double x = 0, y = 0, mean = 0, squares = 0;
  for (int k = 0; k < kLevelSectors; ++k) {
    const double angle = middle(k);
    const auto level = static_cast<double>(ground[static_cast<std::size_t>(k)]);
    x += level * std::cos(angle) * 2 / kLevelSectors;
    y += level * std::sin(angle) * 2 / kLevelSectors;
    mean += level / kLevelSectors, squares += level * level / kLevelSectors;
  }
  const double evenly = (x * x + y * y) / 2, variance = squares - mean * mean;
  if (!(evenly > kLevels.rises_evenly * variance)) return {};
  return {x / static_cast<double>(contrast), y / static_cast<double>(contrast)};
}

std::array<double, kLevelSectors> levels_at_rim(const SphereLight& light) {
  std::array<double, kLevelSectors> levels;
  for (int k = 0; k < kLevelSectors; ++k) {
    const double angle = 2 * kPi * k / kLevelSectors;
    levels[k] = light.at(std::cos(angle), std::sin(angle), kSphere.rim_z);
  }
  return levels;
}

bool fades(const LineTrace::Levels& levels) {
  const double ground = quantile(levels.ground, 0.5);
  const auto at_rim = levels_at_rim(levels.sphere);
  const double least = *std::min_element(at_rim.begin(), at_rim.end());
  return least - ground < static_cast<double>(kSphere.least_contrast * levels.usual);
}

IMPACTDIC_WIDE bool find_levels(CastLines& lines, LineTrace::Levels& levels) {
  drop_hidden_deep_lines(lines);
  if (lines.deep_line.size() < kLineLevels.least_deep) return false;
  thread_local std::vector<float> outermost;  // memory only
  outermost.clear();
  for (const Eight& level : lines.level) outermost.push_back(level.v[kSamples - 1]);
  levels.noise = sample_noise(outermost);
  levels.ground = ground_levels(lines, outermost, levels.noise);
  const float ground = quantile(levels.ground, 0.5);
  thread_local LineLight light;  // memory only
  light.fit(lines, ground, levels.noise);
  levels.light = light.coefficients();
  levels.usual = std::max(levels.light[0] - ground, kLineLevels.least_contrast);
  return true;
}

}  // namespace impactdic::circle
