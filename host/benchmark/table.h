// The table of `impactdic bench`.
#pragma once

#include <functional>
#include <string>

#include "host/benchmark/measure.h"

namespace impactdic::benchmark {

// Measures the rows that `options` want, on the first of the engines unless a row is about all of
// them, and hands each to `line`, without a line's end, when it is done; with `json` the table goes
// to that file too. Throws InvalidArgument where there is no such row, FileError.
void write_bench_table(std::span<opencl::Engine* const> engines, const BenchOptions& options,
                       const std::string& json,
                       const std::function<void(const std::string&)>& line);

}  // namespace impactdic::benchmark
