#include "host/run/folder.h"

#include <impactdic/error.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "host/base/process/stand_back.h"

namespace impactdic::run {

namespace {

namespace fs = std::filesystem;

constexpr int kAttempts = 1000;  // against one that takes the new folder away as often as it can

// A run that was killed leaves its lock, and one that several processes share has its tickets:
// those are no results.
bool holds_files(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path name = entry.path().filename();
    if (name != FolderLock::kName && name != kShareFolder) return true;
  }
  return false;
}

}  // namespace

OutputFolder::OutputFolder(const std::string& folder, bool force) : path_(folder) {
  if (folder.empty()) throw InvalidArgument("the output folder has no name", "--output");
  std::error_code error;
  const fs::file_status there = fs::status(path_, error);
  if (fs::exists(there) && !fs::is_directory(there)) {
    throw InvalidArgument("the output must be a folder", folder);
  }
  const auto refuse_files = [&] {
    if (!force && holds_files(path_)) {
      throw InvalidArgument("the output folder is not empty", folder, "--force writes into it");
    }
  };
  // A run that is at work here is named, rather than that its files are in the way.
  if (!fs::exists(path_ / FolderLock::kName, error)) refuse_files();
  for (int left = kAttempts; lock_ == nullptr; --left) {
    is_new_ = fs::create_directories(path_, error);
    if (error && left == 0) throw FileError("cannot make the folder: " + error.message(), folder);
    try {
      lock_ = std::make_unique<FolderLock>(path_);
    } catch (const FileError&) {
      // Another run that had made it may have taken it away, and a third made it again.
      if (left == 0) throw;
    }
  }
  refuse_files();
}

OutputFolder::~OutputFolder() {
  lock_.reset();
  std::error_code is_in_use;
  if (is_new_) fs::remove(path_, is_in_use);
}

void begin_results(const fs::path& folder, const std::string& command,
                   const SettingWriter& settings, bool going_on) {
  for (const char* name : {"summary.json", "SHA256SUMS"}) fs::remove(folder / name);
  fs::remove_all(folder / "key_frames");
  if (!going_on) {
    // The points first: they speak of the others.
    fs::remove_all(folder / "resume");
    for (const char* name : {"resume.json", "track.csv", "motion.csv", "pose.csv", "fields.h5",
                             "fields.h5.journal", "fields.h5.new"}) {
      fs::remove(folder / name);
    }
  }
  write_job_file(folder / "job.toml", command, settings.values());
}

report::Attributes attributes_of(const Session& session, const ClipInfo& info) {
  report::Attributes attributes = {
      {"program", std::string("impactdic")},
      {"version", std::string(IMPACTDIC_VERSION)},
      {"source", info.path},
      {"source_sha256", std::string()},
      {"axes", std::string("image axes: x right, y down, pixel centres at integers, (0, 0) the "
                           "centre of the top-left pixel; u along x, v along y; rotation positive "
                           "counter-clockwise as seen on the screen")}};
  const std::vector<DeviceInfo> devices = session.devices();
  if (!devices.empty()) {
    attributes["device"] = devices.front().name;
    attributes["driver"] = devices.front().driver;
    attributes["platform"] = devices.front().platform;
    attributes["devices"] = static_cast<double>(devices.size());
  }
  return attributes;
}

nlohmann::json describe_device(const Session& session) {
  const std::vector<DeviceInfo> devices = session.devices();
  if (devices.empty()) return nullptr;
  return {{"name", devices.front().name},
          {"platform", devices.front().platform},
          {"driver", devices.front().driver},
          {"count", devices.size()}};
}

DigestBeside::DigestBeside(const ClipRequest& request, const ClipInfo& info, bool wanted)
    : wanted_(wanted && !request.source) {
  if (wanted_) {
    digest_ = std::async(std::launch::async, [&info] {
      stand_back();  // the measurement comes first
      return video::digest_of(info);
    });
  }
}

video::ClipDigest DigestBeside::get() {
  return digest_.valid() ? digest_.get() : video::ClipDigest{};
}

}  // namespace impactdic::run
