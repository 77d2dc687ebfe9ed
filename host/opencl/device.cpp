#include "host/opencl/device.h"

#include <impactdic/error.h>

#include <algorithm>
#include <charconv>

#include "host/base/parse.h"

namespace impactdic::opencl {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Names arrive padded, some with a terminating zero inside.
std::string clean(const std::string& text) { return trim(text.c_str()); }

// The first number of an NVIDIA device's compute capability; 0 where there is none.
cl_uint compute_capability(const cl::Device& device) {
  constexpr cl_device_info kMajorNv = 0x4000;  // cl_nv_device_attribute_query
  cl_uint major = 0;
  return clGetDeviceInfo(device(), kMajorNv, sizeof(major), &major, nullptr) == CL_SUCCESS ? major
                                                                                           : 0;
}

Device describe(const cl::Platform& platform, const cl::Device& device, int index) {
  Device info;
  info.index = index;
  info.platform = clean(platform.getInfo<CL_PLATFORM_NAME>());
  info.name = clean(device.getInfo<CL_DEVICE_NAME>());
  info.vendor = clean(device.getInfo<CL_DEVICE_VENDOR>());
  info.driver = clean(device.getInfo<CL_DRIVER_VERSION>());
  info.version = clean(device.getInfo<CL_DEVICE_VERSION>());
  info.c_version = clean(device.getInfo<CL_DEVICE_OPENCL_C_VERSION>());
  info.is_gpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
  const bool is_nvidia = info.vendor.find("NVIDIA") != std::string::npos;
  info.multiplies_bytes = info.is_gpu && is_nvidia && compute_capability(device) >= 8;
  info.keeps_programs = info.platform == "Portable Computing Language";
  info.global_memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.local_memory_bytes = device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  info.max_allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  info.max_work_group = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.handle = device;
  return info;
}

std::string names(const std::vector<Device>& devices) {
  std::string text;
  for (const Device& device : devices) {
    text += (text.empty() ? "" : ", ") + std::to_string(device.index) + " = " + device.name;
  }
  return text;
}

const Device* best(const std::vector<Device>& devices, bool gpu) {
  const Device* found = nullptr;
  for (const Device& device : devices) {
    if (device.is_gpu != gpu) continue;
    if (found == nullptr || device.compute_units > found->compute_units) found = &device;
  }
  return found;
}

}  // namespace

std::vector<Device> list_devices() {
  std::vector<Device> infos;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return infos;  // no driver at all: the loader reports that as an error
  }
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> devices;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      for (const cl::Device& device : devices) {
        infos.push_back(describe(platform, device, static_cast<int>(infos.size())));
      }
    } catch (const cl::Error&) {
      continue;  // a platform whose driver finds no device; the others may have some
    }
  }
  return infos;
}

std::vector<Device> all_devices(const std::vector<Device>& devices) {
  const bool any_gpu = std::any_of(devices.begin(), devices.end(),
                                   [](const Device& device) { return device.is_gpu; });
  std::vector<Device> chosen;
  for (const Device& device : devices) {
    if (device.is_gpu == any_gpu) chosen.push_back(device);
  }
  if (chosen.empty()) {
    throw OpenClError("no OpenCL device found", "--device all",
                      "install a GPU driver with OpenCL, or pocl-opencl-icd for the CPU");
  }
  return chosen;
}

const Device& choose_device(const std::vector<Device>& devices, const std::string& spec) {
  if (devices.empty()) {
    throw OpenClError("no OpenCL device found", "--device " + spec,
                      "install a GPU driver with OpenCL, or pocl-opencl-icd for the CPU");
  }
  const std::string wanted = lower(spec);
  if (wanted == "auto") {
    const Device* gpu = best(devices, true);
    const Device* cpu = best(devices, false);
    return gpu != nullptr ? *gpu : cpu != nullptr ? *cpu : devices.front();
  }
  if (wanted == "cpu" || wanted == "gpu") {
    if (const Device* found = best(devices, wanted == "gpu")) return *found;
    throw OpenClError("no OpenCL device of the kind " + wanted, "--device " + spec,
                      "there is " + names(devices));
  }
  int index = -1;
  const auto [end, code] = std::from_chars(spec.data(), spec.data() + spec.size(), index);
  if (code == std::errc() && end == spec.data() + spec.size()) {
    if (index >= 0 && index < static_cast<int>(devices.size())) {
      return devices[static_cast<std::size_t>(index)];
    }
  } else if (!wanted.empty()) {
    for (const Device& device : devices) {
      if (lower(device.name + " " + device.platform).find(wanted) != std::string::npos) {
        return device;
      }
    }
  }
  throw InvalidArgument("no OpenCL device is called '" + spec + "'", "--device",
                        "there is " + names(devices));
}

}  // namespace impactdic::opencl
