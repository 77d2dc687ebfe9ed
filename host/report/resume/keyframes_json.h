// The keyframes in resume.json. Internal to the folder.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "host/motion/pose/keyframes.h"

namespace impactdic::report::resume {

nlohmann::json describe(const motion::Keyframes::Memory& memory);
// Throws where it is not what describe() makes.
motion::Keyframes::Memory keyframes_of(const nlohmann::json& described);
// Throws std::runtime_error where no run's keyframes are such before `row`.
void check_keyframes(const motion::Keyframes::Memory& memory, std::int64_t row);

}  // namespace impactdic::report::resume
