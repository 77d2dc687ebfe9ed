#include "host/benchmark/table.h"

#include <impactdic/error.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace impactdic::benchmark {
namespace {

nlohmann::json to_json(const BenchRow& row, const Roofline& roofline) {
  const double rate = row.per_second();
  return {{"work", row.work},
          {"variant", row.variant},
          {"unit", row.unit},
          {"units_per_run", row.count},
          {"runs", row.runs},
          {"median_s", row.median_s},
          {"least_s", row.least_s},
          {"cpu_s", row.cpu_s},
          {"per_second", rate},
          {"bytes_per_unit", row.bytes},
          {"flops_per_unit", row.flops},
          {"of_copy_peak", rate * row.bytes / roofline.copy_bytes_per_s},
          {"of_flops_peak", rate * row.flops / roofline.flops_per_s},
          {"bias_px", row.bias_px},
          {"rms_error_px", row.rms_px},
          {"lost", row.lost}};
}

template <typename... Values>
std::string text_of(const char* format, Values... values) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string text_of_row(const BenchRow& row, const Roofline& roofline) {
  const double rate = row.per_second();
  return text_of("%-22s %-34s %10.3f %9.3f %12.4g %-8s %8.0f %9.0f %6.1f %6.1f %9.5f %9.5f %7.4f",
                 row.work.c_str(), row.variant.c_str(), 1e3 * row.median_s, 1e3 * row.cpu_s, rate,
                 row.unit.c_str(), row.bytes, row.flops,
                 100 * rate * row.bytes / roofline.copy_bytes_per_s,
                 100 * rate * row.flops / roofline.flops_per_s, row.bias_px, row.rms_px, row.lost);
}

}  // namespace

void write_bench_table(std::span<opencl::Engine* const> engines, const BenchOptions& options,
                       const std::string& json,
                       const std::function<void(const std::string&)>& line) {
  opencl::Engine& engine = *engines.front();
  const Roofline roofline = measure_roofline(engine);
  line(text_of("%s, driver %s: copies %.1f GB/s, multiply-adds %.1f GFLOP/s",
               engine.device().name.c_str(), engine.device().driver.c_str(),
               1e-9 * roofline.copy_bytes_per_s, 1e-9 * roofline.flops_per_s));
  line(text_of("%-22s %-34s %10s %9s %12s %-8s %8s %9s %6s %6s %9s %9s %7s", "work", "variant",
               "median ms", "cpu ms", "per second", "unit", "bytes", "FLOP", "%copy", "%FMA",
               "bias px", "rms px", "lost"));
  nlohmann::json rows = nlohmann::json::array();
  const RowSink sink = [&](const BenchRow& row) {
    line(text_of_row(row, roofline));
    rows.push_back(to_json(row, roofline));
  };
  bench_equal_windows(engine, options, sink);
  bench_zncc(engine, options, sink);
  bench_icgn(engine, options, sink);
  bench_ball(engine, options, sink);
  bench_circle(engine, options, sink);
  bench_methods(engines, options, sink);
#ifdef IMPACTDIC_WITH_FFTW
  bench_references(engine, options, sink);
#endif
  if (rows.empty()) throw InvalidArgument("no row contains '" + options.only + "'", "--only");
  if (json.empty()) return;
  const nlohmann::json all = {{"device",
                               {{"name", engine.device().name},
                                {"platform", engine.device().platform},
                                {"driver", engine.device().driver},
                                {"count", engines.size()}}},
                              {"copy_bytes_per_s", roofline.copy_bytes_per_s},
                              {"flops_per_s", roofline.flops_per_s},
                              {"rows", rows}};
  std::ofstream file(json);
  file << all.dump(2) << "\n";
  if (!file.flush()) throw FileError("cannot be written", json);
}

}  // namespace impactdic::benchmark
