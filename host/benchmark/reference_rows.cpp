// Straightforward references at the same precision beside the kernels on a CPU: FFTW for equal
// windows, the double-precision reference for IC-GN.
#include <fftw3.h>
#include <tbb/enumerable_thread_specific.h>

#include <cmath>
#include <complex>

#include "host/base/parallel/parallel_for.h"
#include "host/benchmark/measure.h"
#include "host/dic/correlator.h"

namespace impactdic::benchmark {
namespace {

constexpr int kWindow = 32, kPoints = kWindow * kWindow;
constexpr int kBins = kWindow * (kWindow / 2 + 1);

// FFTW's plans for one thread and the memory that they work in.
struct Transforms {
  float* f = fftwf_alloc_real(kPoints);
  float* g = fftwf_alloc_real(kPoints);
  fftwf_complex* f_hat = fftwf_alloc_complex(kBins);
  fftwf_complex* g_hat = fftwf_alloc_complex(kBins);
  Transforms() = default;
  Transforms(const Transforms&) = delete;
  Transforms& operator=(const Transforms&) = delete;
  ~Transforms() {
    fftwf_free(f);
    fftwf_free(g);
    fftwf_free(f_hat);
    fftwf_free(g_hat);
  }
};

void cut(const Frame& frame, int x0, int y0, float* out) {
  float mean = 0;
  for (int y = 0; y < kWindow; ++y) {
    const std::uint8_t* row = frame.u8.row(y0 + y) + x0;
    for (int x = 0; x < kWindow; ++x) mean += out[y * kWindow + x] = row[x];
  }
  mean /= kPoints;
  for (int k = 0; k < kPoints; ++k) out[k] -= mean;
}

// Gaussian peak of the circular correlation in `map`, each value over its overlap.
WindowMotion peak_of(const float* map) {
  int best = 0;
  for (int k = 1; k < kPoints; ++k) best = map[k] > map[best] ? k : best;
  const auto lag = [](int at) { return at < kWindow / 2 ? at : at - kWindow; };
  const auto value = [&](int x, int y) {
    x = (x + kWindow) % kWindow;
    y = (y + kWindow) % kWindow;
    const int overlap = (kWindow - std::abs(lag(x))) * (kWindow - std::abs(lag(y)));
    return std::log(map[y * kWindow + x] / static_cast<float>(overlap));
  };
  const int x = best % kWindow, y = best / kWindow;
  const auto shift = [](float before, float at, float after) {
    return 0.5F * (before - after) / (before - 2 * at + after);
  };
  const float centre = value(x, y);
  WindowMotion motion{};
  motion.u = static_cast<float>(lag(x)) + shift(value(x - 1, y), centre, value(x + 1, y));
  motion.v = static_cast<float>(lag(y)) + shift(value(x, y - 1), centre, value(x, y + 1));
  const bool is_number = std::isfinite(motion.u) && std::isfinite(motion.v);
  motion.status =
      static_cast<idic_int>(is_number ? WindowStatus::kOk : WindowStatus::kNotConverged);
  return motion;
}

void bench_fftw(const BenchOptions& options, const RowSink& sink) {
  const ShiftedPictures pictures = make_shifted_pictures(2, kSide, kSide, 6);
  auto windows = dic::rectangle_grid(0, 0, kSide, kSide, kWindow, kWindow / 2);
  for (Window& window : windows) window.second = 1;
  std::vector<WindowMotion> motions(windows.size());
  Transforms planned;
  const fftwf_plan forward =
      fftwf_plan_dft_r2c_2d(kWindow, kWindow, planned.f, planned.f_hat, FFTW_MEASURE);
  const fftwf_plan back =
      fftwf_plan_dft_c2r_2d(kWindow, kWindow, planned.f_hat, planned.f, FFTW_MEASURE);
  tbb::enumerable_thread_specific<Transforms> each;
  BenchRow row;
  row.work = "equal 32x32";
  row.variant = "reference: FFTW, all cores";
  row.count = static_cast<double>(windows.size());
  measure_time(row, options.seconds, [&] {
    parallel_for(windows.size(), [&](std::size_t i) {
      Transforms& own = each.local();
      cut(pictures.frames[0], windows[i].x0, windows[i].y0, own.f);
      cut(pictures.frames[1], windows[i].x0, windows[i].y0, own.g);
      fftwf_execute_dft_r2c(forward, own.f, own.f_hat);
      fftwf_execute_dft_r2c(forward, own.g, own.g_hat);
      for (int k = 0; k < kBins; ++k) {
        const std::complex<float> a(own.f_hat[k][0], own.f_hat[k][1]);
        const std::complex<float> b(own.g_hat[k][0], own.g_hat[k][1]);
        const std::complex<float> product = std::conj(a) * b;
        own.f_hat[k][0] = product.real();
        own.f_hat[k][1] = product.imag();
      }
      fftwf_execute_dft_c2r(back, own.f_hat, own.f);
      motions[i] = peak_of(own.f);
    });
  });
  put_errors(row, pictures, windows, motions);
  fftwf_destroy_plan(forward);
  fftwf_destroy_plan(back);
  sink(row);
}

void bench_double_icgn(const BenchOptions& options, const RowSink& sink) {
  FieldOptions field;
  field.window_px = 31;
  const ShiftedPictures pictures = make_shifted_pictures(2, kSide, kSide, 6);
  const auto correlator = dic::make_reference_correlator(field, 2);
  for (int k = 0; k < 2; ++k)
    correlator->set_frame(k, pictures.frames[static_cast<std::size_t>(k)]);
  auto windows = dic::rectangle_grid(40, 40, 400, 400, 31, 120);
  for (Window& window : windows) window.second = 1;
  std::vector<WindowMotion> motions;
  BenchRow row;
  row.work = "seed + icgn 31x31";
  row.variant = "reference: double, one core";
  row.unit = "points";
  row.count = static_cast<double>(windows.size());
  measure_time(row, options.seconds, [&] { motions = correlator->correlate(windows); });
  put_errors(row, pictures, windows, motions);
  sink(row);
}

}  // namespace

void bench_references(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink) {
  const auto is_wanted = [&](const std::string& work) {
    return work.find(options.only) != std::string::npos;
  };
  if (engine.device().is_gpu) return;
  if (is_wanted("equal 32x32")) bench_fftw(options, sink);
  if (is_wanted("seed + icgn 31x31")) bench_double_icgn(options, sink);
}

}  // namespace impactdic::benchmark
