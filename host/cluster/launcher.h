// Whether this process is one of several that were started together.
#pragma once

#include <impactdic/device.h>

#include <functional>
#include <string>
#include <vector>

namespace impactdic::cluster {

struct Launch {
  std::string by;          // "mpirun", "srun"; "": started alone
  std::string name;        // of the run, the same for all of its processes; "" where it has none
  std::string array;       // of an array of jobs that this one belongs to; "": none
  int rank = 0, size = 1;  // among all of them
  int local_rank = 0, local_size = 1;  // among those of this machine
};

// As the launchers say by the environment: Open MPI's mpirun, Slurm's srun and --array, and those
// of MPICH's kin, whose runs have no name. `get` is getenv or stands in for it.
Launch tell_launch(const std::function<const char*(const char*)>& get);

// The device that a rank takes where device `chosen` is what all of them would take: those of one
// machine take its equal GPUs in turn.
int device_of_rank(const Launch& launch, int chosen, const std::vector<DeviceInfo>& devices);

}  // namespace impactdic::cluster
