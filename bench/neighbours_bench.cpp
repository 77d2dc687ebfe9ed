// Time of what the host does about the windows of a batch besides their fits: which of them the rim
// cuts, and those that are sought from their neighbours; with what became of them beside it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>

#include "host/dic/discs.h"
#include "host/dic/neighbours.h"

namespace impactdic::bench {
namespace {

constexpr double kRadius = 115, kMargin = 3, kNoise_px = 0.01, kTurn_rad = 0.02, kInside = 0.55;
constexpr int kPairs = 64, kWindow = 15, kSpacing = 8;
// Together more than a cache holds: results come from the device.
constexpr int kBatches = 16;

constexpr auto kOk = static_cast<idic_int>(WindowStatus::kOk);

// Of this thread: other programs may run beside.
double processor_seconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// A batch of pairs, and what would be found for each of its windows from a good seed.
struct Batch {
  std::vector<Window> windows;
  std::vector<WindowMotion> found;
  dic::Discs discs{kPairs + 1};
};

// Rolls and drifts; noisy, one window in a hundred gone astray, one in a hundred lost.
Batch make_batch(std::span<const Window> grid, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, kNoise_px), gradient_noise(0, kNoise_px / 5);
  std::uniform_real_distribution<float> chance(0, 1), astray(-5, 5);
  const auto c = static_cast<float>(std::cos(kTurn_rad) - 1);
  const auto s = static_cast<float>(std::sin(kTurn_rad));
  Batch batch;
  for (int pair = 0; pair < kPairs; ++pair) {
    const double cx = 128 + 0.3 * pair, cy = 130 - 0.1 * pair;
    batch.discs.set(pair, cx, cy, kRadius - kMargin);
    for (Window window : grid) {
      window.first = pair;
      window.second = pair + 1;
      const auto x = static_cast<float>(window.x0 + 7), y = static_cast<float>(window.y0 + 7);
      window.x0 += static_cast<int>(std::lround(cx));
      window.y0 += static_cast<int>(std::lround(cy));
      batch.windows.push_back(window);
      WindowMotion motion{};
      motion.u = 0.3F + c * x + s * y + noise(random);
      motion.v = -0.1F - s * x + c * y + noise(random);
      motion.u_sd = motion.v_sd = kNoise_px;
      motion.ux = c + gradient_noise(random);
      motion.uy = s + gradient_noise(random);
      motion.vx = -s + gradient_noise(random);
      motion.vy = c + gradient_noise(random);
      motion.correlation = 0.97F;
      motion.status = kOk;
      const float fate = chance(random);
      if (fate < 0.01F) motion.u += astray(random);
      if (fate > 0.99F) motion.status = static_cast<idic_int>(WindowStatus::kLowCorrelation);
      batch.found.push_back(motion);
    }
  }
  return batch;
}

// What a device would answer, with the time that the answers take.
class Device {
 public:
  Device(std::span<const Window> grid, const Batch& batch) : grid_(grid), batch_(batch) {}
  // In order of the batch.
  void search(std::span<const Window> windows, std::span<WindowMotion> found) {
    const double start = processor_seconds();
    std::size_t at = 0;
    for (std::size_t k = 0; k < windows.size(); ++k, ++at) {
      const Window& window = windows[k];
      while (batch_.windows[at].x0 != window.x0 || batch_.windows[at].y0 != window.y0 ||
             batch_.windows[at].first != window.first) {
        ++at;
      }
      found[k] = batch_.found[at];
    }
    seconds += processor_seconds() - start;
  }
  void refine(std::span<const Window> windows, std::span<const WindowMotion> seeds,
              std::span<WindowMotion> found) {
    const double start = processor_seconds();
    for (std::size_t k = 0; k < windows.size(); ++k) {
      const auto pair = static_cast<std::size_t>(windows[k].first) * grid_.size();
      const auto begin = batch_.windows.begin() + static_cast<std::ptrdiff_t>(pair);
      const auto own = std::lower_bound(begin, begin + static_cast<std::ptrdiff_t>(grid_.size()),
                                        windows[k], [](const Window& a, const Window& b) {
                                          return a.y0 != b.y0 ? a.y0 < b.y0 : a.x0 < b.x0;
                                        });
      found[k] = batch_.found[static_cast<std::size_t>(own - batch_.windows.begin())];
      if (std::abs(found[k].u - seeds[k].u) > 1 || std::abs(found[k].v - seeds[k].v) > 1) {
        found[k].status = static_cast<idic_int>(WindowStatus::kNotConverged);
      }
    }
    asked += windows.size();
    ++calls;
    seconds += processor_seconds() - start;
  }
  double seconds = 0;
  std::size_t asked = 0, calls = 0;

 private:
  std::span<const Window> grid_;
  const Batch& batch_;
};

void batch(benchmark::State& state) {
  const auto grid = dic::disc_grid(0, 0, kRadius - kMargin, kWindow, kSpacing, kInside);
  std::vector<Batch> batches;
  for (unsigned i = 0; i < kBatches; ++i) batches.push_back(make_batch(grid, i));
  std::vector<std::vector<WindowMotion>> results(kBatches);
  for (auto& result : results) result.resize(batches[0].windows.size());
  dic::WholeWindows whole;
  dic::Neighbours neighbours;
  std::size_t n = 0, asked = 0, cut = 0, lost = 0, calls = 0;
  for (auto _ : state) {
    const Batch& batch = batches[n % kBatches];
    std::vector<WindowMotion>& motions = results[n++ % kBatches];
    Device device(grid, batch);
    const dic::RefineWindows refine =
        [&](std::span<const Window> windows, std::span<const WindowMotion> seeds,
            std::span<WindowMotion> found) { device.refine(windows, seeds, found); };
    const double start = processor_seconds();
    whole.search(batch.windows, kWindow, batch.discs, WindowStatus::kLowCorrelation, motions,
                 [&](std::span<const Window> windows, std::span<WindowMotion> found) {
                   device.search(windows, found);
                 });
    neighbours.refine_lost(batch.windows, kWindow, refine, motions);
    neighbours.judge_lost(batch.windows, whole.cut(), refine, motions);
    state.SetIterationTime(processor_seconds() - start - device.seconds);
    asked += device.asked;
    calls += device.calls;
    cut += whole.cut().size();
    lost += static_cast<std::size_t>(std::count_if(
        motions.begin(), motions.end(), [](const WindowMotion& m) { return m.status != kOk; }));
  }
  const auto each = [&](std::size_t sum) {
    return static_cast<double>(sum) / static_cast<double>(n * kPairs);
  };
  using benchmark::Counter;
  state.counters["seconds_a_pair"] =
      Counter(kPairs, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["windows"] = static_cast<double>(grid.size());
  state.counters["cut"] = each(cut);
  state.counters["asked"] = each(asked);
  state.counters["lost"] = each(lost);
  state.counters["calls"] = static_cast<double>(calls) / static_cast<double>(n);
}

BENCHMARK(batch)->UseManualTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace impactdic::bench

BENCHMARK_MAIN();
