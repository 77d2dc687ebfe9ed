#include "host/run/batch/shared_batch.h"

#include <impactdic/error.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "host/base/process_name.h"
#include "host/cluster/heartbeat.h"
#include "host/cluster/work_queue.h"
#include "host/run/batch/conclude.h"
#include "host/run/batch/joined_table.h"
#include "host/run/batch/share_folder.h"
#include "host/run/batch/shot_line.h"
#include "host/run/batch/shot_runner.h"
#include "host/run/folder.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;
using cluster::Closing;
using cluster::Outlook;
using cluster::Ticket;

constexpr std::size_t kMostClips = 64;
constexpr double kBeatsToBeLost = 6, kStillToBeSilent = 10;
constexpr double kShortestNap_s = 0.02, kLongestNap_s = 2;
// The last step is tried again where a shot is missing: it may have been on its way back.
constexpr int kLooks = 3;

class SharedBatch {
 public:
  SharedBatch(const BatchRequest& request, Session& session, Caller& caller)
      : request_(request),
        session_(session),
        caller_(caller),
        runner_(request, session, caller),
        files_(runner_.output() / kShareFolder),
        member_(member_name()),
        queue_(files_, queue_options(request, member_), steady_seconds, text_is_gone) {
    result_.joined = false;
    result_.table = (runner_.output() / "shots.csv").string();
  }
  BatchResult run();

 private:
  void open();
  void work();
  void measure_all();
  void measure_some();
  void measure(const Ticket& ticket);
  void settle(const Ticket& ticket, const BatchShot& shot, ShotResult result);
  fs::path part_of(const BatchShot& shot) const {
    return runner_.shots() / (shot.name + ".part-" + member_);
  }
  void close();
  bool nap(double& seconds);
  void alive() {
    if (heart_) heart_->progressed();
  }

  const BatchRequest& request_;
  Session& session_;
  Caller& caller_;
  ShotRunner runner_;
  cluster::DiskFiles files_;
  std::string member_;
  std::mutex mutex_;  // of what follows
  cluster::WorkQueue queue_;
  BatchResult result_;
  std::exception_ptr failure_;
  std::atomic<bool> stop_ = false;
  std::optional<cluster::Heartbeat> heart_;
};

BatchResult SharedBatch::run() {
  // Before it takes what others could measure; without what compiles ahead (expected_programs), of
  // which every process beside this one would start its own.
  if (request_.track.with_field) session_.open();
  open();
  heart_.emplace([this] { queue_.beat(); }, request_.share.lost_after_s / kBeatsToBeLost,
                 request_.share.lost_after_s * kStillToBeSilent);
  const auto leave = [this] {
    heart_.reset();
    queue_.leave();
  };
  try {
    work();
  } catch (...) {
    leave();
    throw;
  }
  leave();
  result_.cancelled = caller_.cancelled();
  if (result_.joined) conclude_batch(request_, caller_, result_);
  return std::move(result_);
}

void SharedBatch::open() {
  double wait_s = kShortestNap_s;
  const auto list = [&] { return start_share(request_, session_, runner_); };
  try {
    while (!queue_.open(share_settings(request_), list)) {
      if (!nap(wait_s)) throw Error("interrupted before the work began", request_.output.folder);
    }
  } catch (...) {
    std::error_code in_use;  // a folder that is refused stays as it was
    fs::remove(runner_.output() / kShareFolder, in_use);
    throw;
  }
}

// False where the run is to end.
bool SharedBatch::nap(double& seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  const double longest_s = std::min(kLongestNap_s, request_.share.lost_after_s / 4);
  seconds = std::min(1.5 * seconds, longest_s);
  while (Clock::now() < end) {
    if (caller_.cancelled()) return false;
    alive();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return !caller_.cancelled();
}

void SharedBatch::work() {
  double wait_s = kShortestNap_s;
  while (!caller_.cancelled()) {
    const Outlook outlook = queue_.look();
    for (const std::string& lost : queue_.newly_lost()) {
      caller_.say(MessageKind::kWarning, lost + " is lost: others measure its shots");
    }
    if (outlook == Outlook::kElsewhere) return;
    if (outlook == Outlook::kOver) return close();
    const std::size_t before = result_.shots.size();
    if (outlook == Outlook::kWork) measure_all();
    if (result_.shots.size() > before) wait_s = kShortestNap_s;
    if (result_.shots.size() == before && !nap(wait_s)) return;
  }
}

void SharedBatch::measure_all() {
  {
    std::vector<std::jthread> threads;
    const std::size_t count =
        clips_in_flight(request_.clips, session_.options().threads, kMostClips);
    for (std::size_t k = 0; k < count; ++k) threads.emplace_back([this] { measure_some(); });
  }
  if (failure_) std::rethrow_exception(failure_);
}

void SharedBatch::measure_some() {
  while (!stop_ && !caller_.cancelled()) {
    std::optional<Ticket> ticket;
    try {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        ticket = queue_.take();
      }
      if (!ticket) return;
      alive();
      measure(*ticket);
    } catch (...) {  // no further shot is begun; others may do better with this one
      stop_ = true;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      if (ticket) queue_.put_back(*ticket);
    }
  }
}

void SharedBatch::measure(const Ticket& ticket) {
  const BatchShot shot = parse_shot_line(ticket.text, request_.share.name);
  const fs::path part = part_of(shot);
  ShotResult result = runner_.described(shot);
  if (ticket.hopeless) {
    result.reason = std::to_string(cluster::WorkQueue::kMostAttempts) +
                    " processes were lost while they measured it";
  } else if (runner_.is_done(shot) && (!request_.output.resume || runner_.is_settled(shot, part))) {
    // By an earlier run, or by a member that was lost before it could say so.
    result = runner_.read_done(shot);
    runner_.warn_of_contradictions(result);
  } else {
    fs::remove_all(part);
    if (fs::exists(runner_.done(shot))) fs::rename(runner_.done(shot), part);
    result.reason = runner_.measure(shot, part, result, [this] { alive(); });
  }
  if (!result.done && caller_.cancelled()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return queue_.put_back(ticket);
  }
  settle(ticket, shot, std::move(result));
}

// The results get their name, unless another has measured the shot meanwhile.
void SharedBatch::settle(const Ticket& ticket, const BatchShot& shot, ShotResult result) {
  const fs::path part = part_of(shot);
  bool mine = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    mine = queue_.holds(ticket);
  }
  if (!mine) {
    fs::remove_all(part);
    caller_.say(MessageKind::kWarning,
                shot.name + ": this process was given up as lost; another measures the shot");
    return;
  }
  if (result.done && result.measured_now) {
    std::error_code taken;
    fs::rename(part, runner_.done(shot), taken);
    if (taken && !runner_.is_done(shot)) {
      throw FileError("cannot rename: " + taken.message(), part.string());
    }
    fs::remove_all(part);  // the other's results are the same
  }
  if (result.done) {
    fs::remove_all(runner_.aside(shot));
  } else {
    runner_.put_aside(shot, part, result.reason);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  queue_.finish(ticket);
  result_.failed += !result.done;
  result_.shots.push_back(std::move(result));
}

void SharedBatch::close() {
  double wait_s = kShortestNap_s;
  for (int looks = 1; !caller_.cancelled();) {
    const Closing closing = queue_.take_closing();
    if (closing == Closing::kDone) return;
    if (closing == Closing::kMine) {
      BatchResult joined = join_results(request_, runner_, queue_);
      if (joined.missing == 0 || looks++ == kLooks) {
        write_joined(request_, runner_, joined);
        queue_.close();
        for (const std::string& lost : joined.warnings) {
          caller_.say(MessageKind::kWarning, lost);
        }
        result_ = std::move(joined);
        return;
      }
      queue_.reopen();
      if (queue_.look() != Outlook::kOver) return work();
    }
    if (!nap(wait_s)) return;
  }
}

}  // namespace

BatchResult shared_batch(const BatchRequest& request, Session& session, Caller& caller) {
  return SharedBatch(request, session, caller).run();
}

BatchResult join_shared_batch(const BatchRequest& request, Session& session, Caller& caller) {
  const ShotRunner runner(request, session, caller);
  BatchRequest named = request;
  named.share.name = share_to_join(request);
  cluster::DiskFiles files(runner.output() / kShareFolder);
  cluster::WorkQueue queue(files, queue_options(named, member_name()), steady_seconds,
                           text_is_gone);
  BatchResult result = join_results(request, runner, queue);
  write_joined(request, runner, result);
  for (const std::string& lost : result.warnings) caller.say(MessageKind::kWarning, lost);
  conclude_batch(request, caller, result);
  return result;
}

}  // namespace impactdic::run
