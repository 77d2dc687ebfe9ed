// What the runs that write a folder share.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/device.h>

#include <filesystem>
#include <future>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/report/fields_file.h"
#include "host/run/results/folder_lock.h"
#include "host/run/settings/job_file.h"
#include "host/video/clip_digest.h"

namespace impactdic::run {

// Of a folder of results: where processes that share a run leave what they tell each other.
inline constexpr const char* kShareFolder = ".share";

// A folder that one run writes into. As long as this lives no other run does. One that it made and
// nothing was written into goes away with it.
class OutputFolder {
 public:
  // Creates it; refuses one that holds files unless `force`. Throws InvalidArgument, FileError;
  // Error where another run writes into it.
  OutputFolder(const std::string& folder, bool force);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool is_new_ = false;
  std::unique_ptr<FolderLock> lock_;
};

// Writes the job that `settings` make up. Takes away what an earlier run said of its results, for
// none of it holds until this one has ended; and its tables, unless this run is `going_on` with
// them. Throws FileError.
void begin_results(const std::filesystem::path& folder, const std::string& command,
                   const SettingWriter& settings, bool going_on);

// Version, device, driver, source (its digest comes later) and axes, for fields.h5.
report::Attributes attributes_of(const Session& session, const ClipInfo& info);

// The device for summary.json; null where none is open.
nlohmann::json describe_device(const Session& session);

// The digest of a clip's files, made beside a run: that of a long clip takes longer than a fast
// device. A clip from memory has none.
class DigestBeside {
 public:
  DigestBeside(const ClipRequest& request, const ClipInfo& info, bool wanted);
  bool wanted() const { return wanted_; }
  // Waits for it; empty where it is not wanted. Throws FileError. Once.
  video::ClipDigest get();

 private:
  bool wanted_;
  std::future<video::ClipDigest> digest_;
};

}  // namespace impactdic::run
