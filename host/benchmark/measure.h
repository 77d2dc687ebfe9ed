// Speed with the error beside it: what `impactdic bench` and `impactdic tune` measure.
#pragma once

#include <impactdic/image.h>

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/dic/field.h"
#include "host/opencl/engine.h"

namespace impactdic::benchmark {

struct BenchRow {
  std::string work, variant;
  std::string unit = "windows";  // of what is counted
  double count = 0;              // units a run
  int runs = 0;
  double median_s = 0, least_s = 0;  // a run
  double cpu_s = 0;                  // a run, of all threads of this process together
  double bytes = 0, flops = 0;       // a unit, by count of the work; 0 where it makes no sense
  double bias_px = 0, rms_px = 0;    // against the known motion: mean along it, and both axes
  double lost = 0;                   // share of the units without a result
  double per_second() const { return median_s > 0 ? count / median_s : 0; }
};

// What the device reaches at most.
struct Roofline {
  double copy_bytes_per_s = 0;  // device memory, read and written bytes together
  double flops_per_s = 0;       // single-precision multiply-adds, two operations each
};
Roofline measure_roofline(opencl::Engine& engine);

// Runs `run` until `seconds` have passed, at least three times after one for warming up, and puts
// runs and times into the row. `run` waits for what it enqueues.
void measure_time(BenchRow& row, double seconds, const std::function<void()>& run);

inline constexpr int kSide = 512;  // of the pictures that rows are measured on, px

// Speckled pictures of an exactly known surface, picture k moved by (x[k], y[k]) px.
struct ShiftedPictures {
  std::vector<Frame> frames;
  std::vector<double> x, y;
};
ShiftedPictures make_shifted_pictures(int count, int width, int height, double largest_px);

// Error of motions against the shift between the pictures that stand in the windows' slots:
// slot s holds picture s modulo their number.
void put_errors(BenchRow& row, const ShiftedPictures& pictures, std::span<const Window> windows,
                std::span<const WindowMotion> motions);

struct BenchOptions {
  std::string only;      // rows whose work contains this
  double seconds = 0.5;  // a row
  int batch = 0;         // frame pairs a run; 0: 256 on a GPU, 1 on a CPU
  bool every_variant = false;
};
bool is_wanted(const BenchOptions& options, const std::string& work);
// Each row as soon as it is measured.
using RowSink = std::function<void(const BenchRow&)>;
void bench_equal_windows(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink);
void bench_zncc(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink);
void bench_icgn(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink);
void bench_ball(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink);
void bench_circle(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink);
// The stream of frames on all of the engines, the rest on the first.
void bench_methods(std::span<opencl::Engine* const> engines, const BenchOptions& options,
                   const RowSink& sink);
#ifdef IMPACTDIC_WITH_FFTW
// On a CPU only.
void bench_references(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink);
#endif

}  // namespace impactdic::benchmark
