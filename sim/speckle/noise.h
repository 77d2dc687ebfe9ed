// Camera noise that depends only on (seed, frame, row), never on the order in which threads work:
// a counter through a mixing function. An engine of <random> would have to be seeded anew for every
// row, and its normal distribution differs from library to library, so that a clip would not be the
// same to the bit on every machine.
#pragma once

#include <cstdint>
#include <span>

namespace impactdic::sim::speckle {

// Adds independent normal deviates of standard deviation `sigma` to one row of a frame.
void add_row_noise(std::span<double> row, double sigma, std::uint64_t seed, std::int64_t frame,
                   int row_index);

}  // namespace impactdic::sim::speckle
