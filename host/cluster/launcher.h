// Whether this process is one of several that were started together.
#pragma once

#include <functional>
#include <string>

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

}  // namespace impactdic::cluster
