// The OpenCL devices of this machine and the choice among them.
#pragma once

#include <impactdic/device.h>

#include <string>
#include <vector>

#include "host/opencl/cl.h"

namespace impactdic::opencl {

// A device and what is said of it.
struct Device : DeviceInfo {
  // PoCL: its driver compiles a kernel when it first runs, for its group's size, and keeps it on
  // disk.
  bool keeps_programs = false;
  cl::Device handle;
};

// Every device of every platform, platform by platform. Empty where no driver is installed.
std::vector<Device> list_devices();

// What `--device all` stands for: every GPU, or every CPU where there is none. Throws OpenClError
// where there is nothing.
std::vector<Device> all_devices(const std::vector<Device>& devices);

// `spec` is auto (the GPU with the most compute units, else the CPU), cpu, gpu, an index, or a
// part of the device's or platform's name (case does not matter). Throws OpenClError where there
// is no device at all or none of that kind, InvalidArgument for an index or name that no device
// has.
const Device& choose_device(const std::vector<Device>& devices, const std::string& spec);

}  // namespace impactdic::opencl
