#include "host/cluster/launcher.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <string>
#include <thread>

#include "host/cluster/heartbeat.h"

namespace impactdic::cluster {
namespace {

Launch told(const std::map<std::string, std::string>& environment) {
  return tell_launch([&](const char* name) -> const char* {
    const auto found = environment.find(name);
    return found == environment.end() ? nullptr : found->second.c_str();
  });
}

TEST(Launcher, AProcessAloneIsAlone) {
  const Launch alone = told({});
  EXPECT_EQ(alone.size, 1);
  EXPECT_EQ(alone.name, "");
  // A batch script of Slurm has a number of tasks, but is one process.
  EXPECT_EQ(told({{"SLURM_JOB_ID", "7"}, {"SLURM_NTASKS", "4"}}).size, 1);
}

TEST(Launcher, RanksOfOneRunHaveItsName) {
  std::map<std::string, std::string> ours = {
      {"OMPI_COMM_WORLD_SIZE", "4"},
      {"OMPI_COMM_WORLD_RANK", "2"},
      {"OMPI_COMM_WORLD_LOCAL_RANK", "1"},
      {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"},
      {"OMPI_MCA_orte_precondition_transports", "7e4da5025b75b6c3-1be93e69e6795e39"},
      {"PMIX_NAMESPACE", "1089732609"}};
  const Launch rank = told(ours);
  EXPECT_EQ(rank.by, "mpirun");
  EXPECT_EQ(rank.size, 4);
  EXPECT_EQ(rank.rank, 2);
  EXPECT_EQ(rank.local_rank, 1);
  EXPECT_EQ(rank.local_size, 2);
  EXPECT_EQ(rank.name, "mpirun-7e4da5025b75b6c3-1be93e69e6795e39");
  ours["OMPI_COMM_WORLD_RANK"] = "3";
  EXPECT_EQ(told(ours).name, rank.name);
}

TEST(Launcher, StepsAndArraysOfSlurmHaveNames) {
  const Launch step = told({{"SLURM_JOB_ID", "7"},
                            {"SLURM_CLUSTER_NAME", "my.cluster"},
                            {"SLURM_STEP_ID", "0"},
                            {"SLURM_STEP_NUM_TASKS", "8"},
                            {"SLURM_STEP_TASKS_PER_NODE", "4(x2)"},
                            {"SLURM_PROCID", "5"},
                            {"SLURM_LOCALID", "1"}});
  EXPECT_EQ(step.by, "srun");
  EXPECT_EQ(step.name, "slurm-my-cluster-7-0");
  EXPECT_EQ(step.size, 8);
  EXPECT_EQ(step.rank, 5);
  EXPECT_EQ(step.local_size, 4);
  EXPECT_EQ(told({{"SLURM_ARRAY_JOB_ID", "9"}}).array, "slurm--9");
}

TEST(Launcher, ARankThatItsRunLacksIsNone) {
  for (const char* rank : {"4", "-1", "2147483647"}) {
    const Launch none = told({{"OMPI_COMM_WORLD_SIZE", "4"}, {"OMPI_COMM_WORLD_RANK", rank}});
    EXPECT_EQ(none.size, 1) << rank;
    EXPECT_EQ(none.rank, 0) << rank;
    EXPECT_EQ(none.by, "") << rank;
  }
  // Slurm tells the tasks of the first machine: another one may have more.
  const Launch step = told({{"SLURM_STEP_ID", "0"},
                            {"SLURM_STEP_NUM_TASKS", "5"},
                            {"SLURM_STEP_TASKS_PER_NODE", "1,4"},
                            {"SLURM_PROCID", "4"},
                            {"SLURM_LOCALID", "3"}});
  EXPECT_EQ(step.local_rank, 3);
  EXPECT_EQ(step.local_size, 4);
  EXPECT_EQ(told({{"PMI_SIZE", "2"}, {"MPI_LOCALRANKID", "-5"}}).local_rank, 0);
}

TEST(Launcher, OthersRanksHaveNoName) {
  const Launch rank = told({{"PMI_SIZE", "3"}, {"PMI_RANK", "1"}});
  EXPECT_EQ(rank.size, 3);
  EXPECT_EQ(rank.rank, 1);
  EXPECT_EQ(rank.name, "");
}

TEST(Launcher, RanksOfOneMachineTakeItsEqualGpusInTurn) {
  const auto device = [](int index, const char* name, bool is_gpu) {
    DeviceInfo info;
    info.index = index;
    info.name = name;
    info.is_gpu = is_gpu;
    return info;
  };
  const std::vector<DeviceInfo> devices = {device(0, "cpu", false), device(1, "big", true),
                                           device(2, "small", true), device(3, "big", true)};
  Launch rank;
  rank.local_size = 4;
  for (const auto& [local, own] : std::map<int, int>{{0, 1}, {1, 3}, {2, 1}, {3, 3}}) {
    rank.local_rank = local;
    EXPECT_EQ(device_of_rank(rank, 1, devices), own);
  }
  EXPECT_EQ(device_of_rank(rank, 2, devices), 2);
  EXPECT_EQ(device_of_rank(rank, 0, devices), 0);  // a CPU is for all
}

// Work that stands still is as silent as a process that has ended.
TEST(Heartbeat, FallsSilentWhereNothingGetsOn) {
  std::atomic<int> beats = 0;
  Heartbeat heart([&] { ++beats; }, 0.01, 0.1);
  const auto wait = [](int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); };
  while (beats < 20) {  // longer than the silence, all the same
    heart.progressed();
    wait(10);
  }
  wait(300);
  const int then = beats;
  wait(200);
  EXPECT_EQ(beats, then);
  heart.progressed();
  while (beats == then) wait(10);
}

}  // namespace
}  // namespace impactdic::cluster
