// Whether pictures hold a part of those before them, as a recorder's noise reduction makes them.
#pragma once

#include <impactdic/circle.h>
#include <impactdic/image.h>

#include <optional>
#include <vector>

namespace impactdic::advice {

struct NoiseMemory {
  double share = 0;  // of each picture that is the one before; 0 of a camera's own
  double sd = 0;
};

// By the noise of what stands still in three frames that follow each other: differences of a
// camera's pictures correlate by −1/2, of pictures that hold a share `a` of the shown one before by
// −(1 − a)/2 (first-order autoregressive noise). What lies about the balls takes no part, nor what
// has a texture. nullopt where too little is left.
std::optional<NoiseMemory> noise_memory(const Frame& first, const Frame& second, const Frame& third,
                                        const std::vector<Circle>& balls);

}  // namespace impactdic::advice
