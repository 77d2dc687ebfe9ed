// The OpenCL devices of this machine and the choice among them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/opencl/cl.h"

namespace impactdic::opencl {

struct DeviceInfo {
  int index = 0;  // what --device INDEX means
  std::string platform, name, vendor, driver, version, c_version;
  bool is_gpu = false;
  bool multiplies_bytes = false;  // an NVIDIA device with units for matrices of bytes (PTX's mma)
  std::size_t global_memory_bytes = 0, local_memory_bytes = 0, max_allocation_bytes = 0;
  std::size_t max_work_group = 0;
  unsigned compute_units = 0;
  cl::Device handle;
};

// Every device of every platform, platform by platform. Empty where no driver is installed.
std::vector<DeviceInfo> list_devices();

// What `--device all` stands for: every GPU, or every CPU where there is none. Throws OpenClError
// where there is nothing.
std::vector<DeviceInfo> all_devices(const std::vector<DeviceInfo>& devices);

// `spec` is auto (the GPU with the most compute units, else the CPU), cpu, gpu, an index, or a
// part of the device's or platform's name (case does not matter). Throws OpenClError where there
// is no device at all or none of that kind, InvalidArgument for an index or name that no device
// has.
const DeviceInfo& choose_device(const std::vector<DeviceInfo>& devices, const std::string& spec);

}  // namespace impactdic::opencl
