// Whether the same job gives the same bytes again.
#pragma once

#include <impactdic/control.h>

#include <filesystem>
#include <string>
#include <vector>

namespace impactdic::run {

struct RepeatedFile {
  std::string file;
  bool same = false;
};

// Runs job.toml of `folder` once more, into a scratch folder that is gone afterwards, and compares
// its tables to the last bit. (fields.h5 is laid out by when it was flushed: its bytes differ.)
// Throws InvalidArgument for the job of another command than track and correlate, and as those do.
std::vector<RepeatedFile> repeat_run(const std::filesystem::path& folder,
                                     const RunControl& control);

}  // namespace impactdic::run
