// Jobs of `simulate` as text, for tests of what a file may say.
#pragma once

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "sim/job/job_toml.h"
#include "tests/support/scratch.h"

namespace impactdic::testing {

// The file is gone with the process.
inline std::filesystem::path write_job(const std::string& text) {
  static const ScratchFolder folder;
  const std::filesystem::path file = folder / "job.toml";
  std::ofstream(file) << text;
  return file;
}

// `text` with the first `from` replaced, which must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// The error's one line.
inline std::string error_of(const std::string& text) {
  try {
    sim::job::read_simulate_job(write_job(text));
  } catch (const InvalidArgument& error) {
    return error.line();
  }
  return "accepted";
}

}  // namespace impactdic::testing
