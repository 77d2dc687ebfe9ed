#include "host/cluster/launcher.h"

#include <algorithm>
#include <charconv>

namespace impactdic::cluster {
namespace {

using Get = std::function<const char*(const char*)>;

std::string text(const Get& get, const char* name) {
  const char* const value = get(name);
  return value == nullptr ? "" : value;
}

int number(const Get& get, const char* name, int otherwise) {
  const std::string value = text(get, name);
  int result = otherwise;
  std::from_chars(value.data(), value.data() + value.size(), result);
  return result;
}

// A name that a folder can have.
std::string as_name(std::string name) {
  for (char& c : name) {
    const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!good) c = '-';
  }
  return name;
}

std::string slurm_job(const Get& get, const char* job) {
  const std::string number = text(get, job);
  if (number.empty()) return "";
  return as_name("slurm-" + text(get, "SLURM_CLUSTER_NAME") + "-" + number);
}

Launch stated_launch(const Get& get) {
  Launch launch;
  if (const int size = number(get, "OMPI_COMM_WORLD_SIZE", 0); size > 0) {
    launch.by = "mpirun";
    launch.size = size;
    launch.rank = number(get, "OMPI_COMM_WORLD_RANK", 0);
    launch.local_rank = number(get, "OMPI_COMM_WORLD_LOCAL_RANK", 0);
    launch.local_size = number(get, "OMPI_COMM_WORLD_LOCAL_SIZE", 1);
    // Drawn anew for every run; a job's number comes back.
    std::string name = text(get, "OMPI_MCA_orte_precondition_transports");
    if (name.empty()) name = text(get, "PMIX_NAMESPACE");
    if (!name.empty()) launch.name = as_name("mpirun-" + name);
    return launch;
  }
  // Inside sbatch alone there is a number of tasks, but only one process: a step has a number.
  if (const int size = number(get, "SLURM_STEP_NUM_TASKS", 0);
      size > 0 && !text(get, "SLURM_STEP_ID").empty()) {
    launch.by = "srun";
    launch.size = size;
    launch.rank = number(get, "SLURM_PROCID", 0);
    launch.local_rank = number(get, "SLURM_LOCALID", 0);
    launch.local_size = number(get, "SLURM_STEP_TASKS_PER_NODE", 1);
    launch.name = slurm_job(get, "SLURM_JOB_ID") + "-" + as_name(text(get, "SLURM_STEP_ID"));
    return launch;
  }
  if (const int size = number(get, "PMI_SIZE", 0); size > 0) {
    launch.by = "mpiexec";
    launch.size = size;
    launch.rank = number(get, "PMI_RANK", 0);
    launch.local_rank = number(get, "MPI_LOCALRANKID", 0);
    launch.local_size = number(get, "MPI_LOCALNRANKS", 1);
  }
  return launch;
}

}  // namespace

Launch tell_launch(const Get& get) {
  Launch launch = stated_launch(get);
  // A rank that its run does not have: what is set was not set by a launcher.
  if (launch.rank < 0 || launch.rank >= launch.size) launch = Launch();
  // Slurm tells the tasks of the first machine alone, where others may have more.
  launch.local_rank = std::clamp(launch.local_rank, 0, launch.size - 1);
  launch.local_size = std::max(launch.local_size, launch.local_rank + 1);
  launch.array = slurm_job(get, "SLURM_ARRAY_JOB_ID");
  return launch;
}

int device_of_rank(const Launch& launch, int chosen, const std::vector<DeviceInfo>& devices) {
  std::vector<int> equal;
  for (const DeviceInfo& device : devices) {
    const auto all = [&](const DeviceInfo& other) {
      return other.index != chosen ||
             (other.is_gpu && other.name == device.name && other.platform == device.platform);
    };
    if (device.is_gpu && std::all_of(devices.begin(), devices.end(), all)) {
      equal.push_back(device.index);
    }
  }
  if (equal.empty() || launch.local_rank < 0) return chosen;
  return equal[static_cast<std::size_t>(launch.local_rank) % equal.size()];
}

}  // namespace impactdic::cluster
