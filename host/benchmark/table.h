// The table of `impactdic bench`.
#pragma once

#include "host/benchmark/measure.h"

namespace impactdic::benchmark {

// Measures the rows that `options` want, on the first of the engines unless a row is about all of
// them, and prints each on stdout when it is done; with `json` the table goes to that file too.
// Throws InvalidArgument where there is no such row, FileError.
void print_bench_table(std::span<opencl::Engine* const> engines, const BenchOptions& options,
                       const std::string& json);

}  // namespace impactdic::benchmark
