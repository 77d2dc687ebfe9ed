#include "host/run/folder.h"

#include <impactdic/error.h>

#include <nlohmann/json.hpp>
#include <system_error>

namespace impactdic::run {

std::filesystem::path prepare_folder(const std::string& folder, bool force) {
  namespace fs = std::filesystem;
  if (folder.empty()) throw InvalidArgument("the output folder has no name", "--output");
  const fs::path path(folder);
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error)) {
    throw InvalidArgument("the output must be a folder", folder);
  }
  if (fs::is_directory(path, error) && !fs::is_empty(path, error) && !force) {
    throw InvalidArgument("the output folder is not empty", folder, "--force writes into it");
  }
  fs::create_directories(path, error);
  if (error) throw FileError("cannot make the folder: " + error.message(), folder);
  return path;
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
    digest_ =
        std::async(std::launch::async, video::digest_of, std::cref(info), video::kDigestPiece);
  }
}

video::ClipDigest DigestBeside::get() {
  return digest_.valid() ? digest_.get() : video::ClipDigest{};
}

}  // namespace impactdic::run
