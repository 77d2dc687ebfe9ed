// Time of the host's fits to the displacement field of one frame, with their error beside it.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/dic/field.h"
#include "host/motion/field_motion.h"

namespace impactdic::bench {
namespace {

constexpr double kRadius = 115, kNoise_px = 0.005, kTurn_rad = 0.02;

// The windows of a ball, noisy, one in twenty gone astray.
std::vector<std::vector<dic::PointMotion>> make_fields(int count, double strain) {
  const auto windows = dic::disc_grid(0, 0, kRadius - 3, 15, 8);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, kNoise_px);
  std::uniform_real_distribution<double> chance(0, 1), astray(-5, 5);
  const double c = std::cos(kTurn_rad) - 1, s = std::sin(kTurn_rad);
  std::vector<std::vector<dic::PointMotion>> fields(static_cast<std::size_t>(count));
  for (auto& field : fields) {
    for (const Window& window : windows) {
      const double x = window.x0 + 7, y = window.y0 + 7;
      dic::PointMotion p{x, y, 1.3 + c * x + s * y, 0.4 - s * x + (c + strain) * y, kNoise_px};
      p.u_px += noise(random);
      p.v_px += noise(random);
      if (chance(random) < 0.05) {
        p.u_px += astray(random);
        p.v_px += astray(random);
      }
      field.push_back(p);
    }
  }
  return fields;
}

void rigid(benchmark::State& state, double strain) {
  const auto fields = make_fields(16, strain);
  double squares = 0, turn_squares = 0;
  std::size_t n = 0;
  for (auto _ : state) {
    const dic::RigidMotion motion = dic::fit_rigid_motion(fields[n++ % fields.size()], 0.3, -0.2);
    benchmark::DoNotOptimize(motion);
    const double dx = 1.3 + (std::cos(kTurn_rad) - 1) * 0.3 + std::sin(kTurn_rad) * -0.2;
    squares += std::pow(motion.dx_px - dx, 2);
    turn_squares += std::pow(motion.rot_rad - kTurn_rad, 2);
  }
  state.counters["windows"] = static_cast<double>(fields[0].size());
  state.counters["rms_dx_px"] = std::sqrt(squares / static_cast<double>(n));
  state.counters["rms_rot_rad"] = std::sqrt(turn_squares / static_cast<double>(n));
}

void centre(benchmark::State& state) {
  const auto fields = make_fields(16, 0);
  std::size_t n = 0;
  double squares = 0;
  for (auto _ : state) {
    const motion::CentreMotion motion = motion::interpolate_at(fields[n++ % fields.size()], 0, 0);
    benchmark::DoNotOptimize(motion);
    squares += std::pow(motion.u_px - 1.3, 2);
  }
  state.counters["rms_u_px"] = std::sqrt(squares / static_cast<double>(n));
}

void strain(benchmark::State& state) {
  const auto fields = make_fields(16, -0.01);
  std::size_t n = 0;
  double squares = 0;
  for (auto _ : state) {
    const motion::FieldStrain found = motion::fit_strain(fields[n++ % fields.size()], {}, 0, 0);
    benchmark::DoNotOptimize(found);
    squares += std::pow(found.largest - 0.01, 2);
  }
  state.counters["rms_strain"] = std::sqrt(squares / static_cast<double>(n));
}

BENCHMARK_CAPTURE(rigid, round, 0.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(rigid, squashed, -0.01)->Unit(benchmark::kMicrosecond);
BENCHMARK(centre)->Unit(benchmark::kMicrosecond);
BENCHMARK(strain)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace impactdic::bench

BENCHMARK_MAIN();
