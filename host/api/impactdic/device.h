// OpenCL devices, and a session that holds what several runs share.
#pragma once

#include <impactdic/export.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

struct DeviceInfo {
  int index = 0;  // as `SessionOptions::device` takes it
  std::string platform, name, vendor, driver, version, c_version;
  bool is_gpu = false;
  bool multiplies_bytes = false;  // an NVIDIA device with units for matrices of bytes (PTX's mma)
  std::size_t global_memory_bytes = 0, local_memory_bytes = 0, max_allocation_bytes = 0;
  std::size_t max_work_group = 0;
  unsigned compute_units = 0;
};

// Every device of every platform, platform by platform. Empty where no driver is installed.
std::vector<DeviceInfo> list_devices();

// The index that `device` stands for (see SessionOptions). Throws OpenClError where there is no
// device at all or none of that kind, InvalidArgument for an index or name that no device has.
int choose_device(const std::string& device);

struct CompileProgress {
  std::string kernel;  // file and name of the one asked for or done, "zncc/peak.cl:zncc_subpixel"
  int done = 0;
  int known = 0;  // asked for so far: it grows while a run finds out what it needs
};

// Called when a kernel to be compiled is asked for, and again when it is there: from any thread,
// one call at a time. It must be quick, must not throw and must not call the session.
using CompileFn = std::function<void(const CompileProgress&)>;

struct SessionOptions {
  // auto (the GPU with the most compute units, else the CPU), cpu, gpu, an index, a part of the
  // device's or platform's name (case does not matter), or all (every GPU, else every CPU).
  std::string device = "auto";
  // Host threads; 0 takes all cores. A limit holds for all of the process's work with oneTBB while
  // the session lives (tbb::global_control): of several sessions the lowest one counts.
  int threads = 0;
  bool profile = false;  // keep the times of stages and kernels; see Session::profile
  // Told while kernels are compiled that this machine has not compiled before, which takes seconds.
  CompileFn on_compile = nullptr;
  void validate() const;  // throws InvalidArgument
};

// Devices, compiled programs and the thread limit. Several runs may share a session, one after the
// other or at once from several threads. A run without a field needs no device: they are opened
// when the first run needs them, or by `open`.
class Session {
 public:
  // Throws InvalidArgument for options that are wrong whatever the machine is.
  explicit Session(SessionOptions options = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const SessionOptions& options() const;
  // Opens the devices unless they are open. Throws OpenClError; InvalidArgument as choose_device.
  void open();
  // Those that are open: none before the first run that needs one.
  std::vector<DeviceInfo> devices() const;
  // With SessionOptions::profile, a table for a terminal: device time of every kernel so far.
  std::string profile();

  // What it holds, for the library's own runs.
  struct IMPACTDIC_PRIVATE Impl;
  Impl& impl() { return *impl_; }
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace impactdic
