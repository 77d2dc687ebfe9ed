// From lines across the rim to profiles: shares of the local contrast.
#include "host/track/rim_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/track/rim_cast.h"
#include "host/track/rim_levels.h"
#include "host/track/rim_model.h"

namespace impactdic {
namespace {

constexpr int kSectors = LineTrace::Levels::kSectors;
constexpr int kDeepEvery = 4;  // lines from one that reaches deep to the next, where many are cast
constexpr int kBeside = 3;     // lines beside one with an obstacle that the obstacle's blur reaches
constexpr float kLeastContrast = 0.2f;  // of the usual contrast

// The background at a line whose outermost sample reads `seen`: linear between the middles of the
// sectors, or where an obstacle ends between them the nearer of the two.
float ground_at(const std::array<float, kSectors>& levels, float turn, float seen, float contrast) {
  const float at = turn * (kSectors / 4) - 0.5f;
  const int b = static_cast<int>(at + 1) - 1;
  const float t = at - static_cast<float>(b);
  const float a = levels[b < 0 ? kSectors - 1 : b], c = levels[b + 1 < kSectors ? b + 1 : 0];
  if (std::abs(a - c) < kGroundTolerance * contrast) return a + t * (c - a);
  return std::abs(seen - a) < std::abs(seen - c) ? a : c;
}

}  // namespace

IMPACTDIC_WIDE void trace_lines(const Frame& frame, const Rim& rim, bool bright, double step_px,
                                int most_lines, const LineWants& wants, LineTrace& trace) {
  thread_local CastLines lines;  // memory only
  // A texture wants all that it can get, the light a hundred lines or two.
  const int deep_every = wants.texture ? 1 : !wants.levels ? 0 : most_lines > 400 ? kDeepEvery : 1;
  cast_lines(frame, rim, bright, {step_px, most_lines, deep_every}, lines);
  trace.lines.clear();
  trace.cast = lines.cast;
  trace.in_view = lines.size();
  trace.step_px = step_px;
  if (lines.size() < 16) return;
  if (wants.levels && !find_levels(lines, trace.levels)) return;
  const float noise = trace.levels.noise;
  const auto& light = trace.levels.light;
  const float usual = trace.levels.usual;
  trace.noise = std::max(noise / usual, 0.003f);

  const int n = lines.size();
  int blocked = -kBeside - 1;  // the last line with something else outside
  std::size_t next_deep = 0;
  thread_local std::vector<int> kept;
  kept.clear();
  for (int i = 0; i < n; ++i) {
    const Profile& level = lines.level[i].v;
    const float seen = level[kSamples - 1];
    const float ball = light_at(light, lines.cos[i], lines.sin[i]);
    const float outside = ground_at(trace.levels.ground, lines.turn[i], seen, usual);
    const float contrast = ball - outside;
    const bool clear = contrast > kLeastContrast * usual && contrast > 6 * noise &&
                       std::abs(seen - outside) < kGroundTolerance * contrast + 4 * noise;
    if (!clear) {
      blocked = i;
      while (!kept.empty() && kept.back() >= i - kBeside) {
        kept.pop_back();
        trace.lines.pop_back();
      }
      continue;
    }
    if (i - blocked <= kBeside) continue;
    const float per_contrast = 1 / contrast;
    Profile p = (level - outside) * per_contrast;
    p[kSamples] = 0;
    // Ink, or an obstacle across the rim.
    if (std::max({p[0], p[1], p[2]}) < std::max(kNothing, 5 * noise * per_contrast)) continue;
    const float relative = contrast / usual;
    kept.push_back(i);
    trace.lines.push_back(
        {p, lines.cos[i], lines.sin[i], relative * relative, lines.sector(i, kRimSectors)});
    if (!wants.texture) continue;
    const std::size_t deeps = lines.deep_line.size();
    while (next_deep < deeps && lines.deep_line[next_deep] < i) ++next_deep;
    if (next_deep < deeps && lines.deep_line[next_deep] == i) {
      // From the innermost of the deep samples to the innermost of the profile.
      const Lanes& deep = lines.deep_level[next_deep].v;
      const float per =
          1 / (light_at(light, lines.deep_x[next_deep], lines.deep_y[next_deep]) - outside);
      float b[kDeep];
      for (int k = 0; k < kDeep; ++k) b[k] = (deep[kDeep - 1 - k] - outside) * per;
      for (int k = 0; k + kTexture <= kDeep; ++k) {
        wants.texture->add(b + k, static_cast<float>(trace.noise) / relative);
      }
    }
  }
}

}  // namespace impactdic
