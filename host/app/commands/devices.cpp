#include <impactdic/device.h>

#include <cstdio>

#include "host/app/command.h"

namespace impactdic::app {
namespace {

void run_devices(const std::string& spec) {
  const int chosen = choose_device(spec);
  for (const DeviceInfo& device : list_devices()) {
    std::printf("%c %d  %s  %s\n", device.index == chosen ? '*' : ' ', device.index,
                device.is_gpu ? "GPU" : "CPU", device.name.c_str());
    std::printf("      platform %s, %s, driver %s\n", device.platform.c_str(),
                device.version.c_str(), device.driver.c_str());
    std::printf("      memory %.1f GiB, local %zu KiB, %u compute units, %zu work-items a group\n",
                static_cast<double>(device.global_memory_bytes) / (1 << 30),
                device.local_memory_bytes / 1024, device.compute_units, device.max_work_group);
  }
  std::printf("* is the one that --device %s takes\n", spec.c_str());
}

}  // namespace

void add_devices_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("devices", "OpenCL devices of this machine, and the one in use");
  auto spec = std::make_shared<std::string>("auto");
  command->add_option("--device", *spec, "Which one would this take: auto, cpu, gpu, index, name")
      ->capture_default_str();
  command->footer("Example:\n  impactdic devices --device gpu");
  command->callback([spec] { run_devices(*spec); });
}

}  // namespace impactdic::app
