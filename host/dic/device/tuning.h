// The quickest variant of a kernel on a device, as `impactdic tune` found it; see
// docs/file-formats.md for the file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/dic/device/equal.h"
#include "host/dic/device/zncc.h"

namespace impactdic::dic {

struct TunedKernel {
  std::string work;     // see zncc_work and equal_work
  std::string variant;  // its name()
  double per_second = 0;
  double difference_px = 0;  // the largest from the double-precision reference
};

// What a row of the file is about.
std::string zncc_work(const FieldOptions& options);  // "zncc 15 in 31"
std::string equal_work(int window_px);               // "equal 32"

// The file in the engine's cache folder; empty where that is.
std::filesystem::path tuning_file(const opencl::Engine& engine);

// Puts rows for the engine's device and driver into the file, instead of those of the same work.
// Throws FileError.
void store_tuning(const opencl::Engine& engine, const std::vector<TunedKernel>& kernels);

// The name of the variant that is stored for this device, driver and work. A file that is missing
// or damaged holds none.
std::optional<std::string> tuned_variant(const opencl::Engine& engine, const std::string& work);

// The variant to take: the stored one, if the device still offers it, else the first that it
// offers. Tuned are the windows of a clip; where pairs have no picture in common (!of_clip) there
// is nothing to follow, and matrix units are quicker.
ZnccVariant choose_zncc_variant(const opencl::Engine& engine, const FieldOptions& options);
EqualVariant choose_equal_variant(const opencl::Engine& engine, int window_px, bool of_clip = true);

}  // namespace impactdic::dic
