// One run at a time writes into a folder.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "host/run/folder.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;
using testing::ScratchFolder;

TEST(FolderLock, OneHoldsItAndIsNamed) {
  const ScratchFolder folder;
  const fs::path path = folder / "";
  {
    const run::FolderLock lock(path);
    try {
      const run::FolderLock second(path);
      ADD_FAILURE() << "two hold the folder";
    } catch (const Error& error) {
      EXPECT_NE(error.line().find("process " + std::to_string(::getpid())), std::string::npos)
          << error.line();
    }
  }
  EXPECT_FALSE(fs::exists(folder / run::FolderLock::kName));
  EXPECT_NO_THROW(run::FolderLock{path});
}

TEST(FolderLock, ADeadOwnersIsTakenOver) {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const run::FolderLock lock(folder / "");
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(folder / run::FolderLock::kName));
  EXPECT_NO_THROW(run::FolderLock{folder / ""});
}

// A large process that was killed holds its lock until its memory is given back. Here its first
// thread has ended and another has not.
TEST(FolderLock, AnEndingOwnersIsWaitedFor) {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const run::FolderLock lock(folder / "");
    std::thread([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(400));
      ::_exit(0);
    }).detach();
    ::syscall(SYS_exit, 0);
  }
  const std::string stat = "/proc/" + std::to_string(child) + "/stat";
  while (testing::read_text(stat).find(") Z ") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_NO_THROW(run::FolderLock{folder / ""});
  ::waitpid(child, nullptr, 0);
}

// Of another machine nothing is known but when it touched its lock.
TEST(FolderLock, AnotherMachinesHoldsWhileItIsTouched) {
  const ScratchFolder folder;
  const fs::path lock = folder / run::FolderLock::kName;
  std::ofstream(lock) << "host elsewhere.example\npid 77\nstart 5\n";
  try {
    const run::FolderLock second(folder / "");
    ADD_FAILURE() << "taken from a run that is alive";
  } catch (const Error& error) {
    EXPECT_NE(error.line().find("elsewhere.example"), std::string::npos) << error.line();
  }
  fs::last_write_time(lock, fs::last_write_time(lock) - 2 * run::FolderLock::kSilence);
  EXPECT_NO_THROW(run::FolderLock{folder / ""});
}

TEST(FolderLock, OfManyAtOnceOneWins) {
  const ScratchFolder folder;
  for (int round = 0; round < 25; ++round) {
    std::atomic<int> won = 0, inside = 0;
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        try {
          const run::FolderLock lock(folder / "");
          ++won;
          EXPECT_EQ(++inside, 1);
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
          --inside;
        } catch (const Error&) {
        }
      });
    }
    threads.clear();
    EXPECT_GE(won, 1);
  }
}

// One may take away the empty folder that it had made while another is about to take it.
TEST(OutputFolder, RunsThatMakeOneNewFolderAtTheSameTimeLoseItNever) {
  const ScratchFolder folder;
  const std::string path = folder.file("new");
  std::atomic<int> held = 0, refused = 0;
  const auto make_and_leave = [&] {
    for (int round = 0; round < 400; ++round) {
      try {
        const run::OutputFolder output(path, false);
        EXPECT_TRUE(fs::is_directory(path));
        ++held;
      } catch (const FileError& error) {
        ADD_FAILURE() << error.line();
      } catch (const Error& error) {
        EXPECT_NE(error.line().find("writes into this folder"), std::string::npos) << error.line();
        ++refused;
      }
    }
  };
  // What a run does that ends before it has written anything.
  const std::jthread leaver([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      ::rmdir(path.c_str());
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  });
  { const std::jthread first(make_and_leave), second(make_and_leave), third(make_and_leave); }
  EXPECT_GE(held, 3);
  EXPECT_EQ(held + refused, 1200);
}

}  // namespace
}  // namespace impactdic
