#include "host/run/batch/launched.h"

#include <impactdic/error.h>

#include <cstdlib>

#include "host/base/parse.h"
#include "host/cluster/launcher.h"

namespace impactdic::run {
namespace {

constexpr std::int64_t kMostShards = 1000000;

void read_shard(const std::string& text, BatchShare& share) {
  const std::vector<std::string> parts = split(text, '/');
  std::int64_t numbers[2] = {0, 0};
  try {
    for (std::size_t i = 0; i < 2 && parts.size() == 2; ++i) numbers[i] = parse_int(parts[i], text);
  } catch (const InvalidArgument&) {
    numbers[0] = 0;
  }
  if (numbers[0] < 1 || numbers[0] > numbers[1] || numbers[1] > kMostShards) {
    throw InvalidArgument("'" + text + "' is no shard", "--shard",
                          "K/N with K from 1 to N, such as 3/8");
  }
  share.shard = static_cast<int>(numbers[0]);
  share.shards = static_cast<int>(numbers[1]);
}

}  // namespace

void share_as_launched(const std::string& shard, BatchRequest& request, SessionOptions& session) {
  BatchShare& share = request.share;
  const cluster::Launch launch =
      cluster::tell_launch([](const char* name) { return std::getenv(name); });
  if (!shard.empty()) {
    read_shard(shard, share);
    if (share.name.empty()) share.name = launch.array.empty() ? "shards" : launch.array;
  }
  if (launch.size < 2) return;
  share.member = "rank " + std::to_string(launch.rank) + " of " + launch.by;
  if (share.name.empty()) share.name = launch.name;
  if (share.name.empty() && !share.join) {
    throw InvalidArgument("the " + std::to_string(launch.size) + " processes of " + launch.by +
                              " have no name in common",
                          "--share", "give the run one: --share NAME");
  }
  if (!request.track.with_field || (session.device != "auto" && session.device != "gpu")) return;
  const int all = choose_device(session.device);
  const int own = cluster::device_of_rank(launch, all, list_devices());
  if (own != all) session.device = std::to_string(own);
}

}  // namespace impactdic::run
