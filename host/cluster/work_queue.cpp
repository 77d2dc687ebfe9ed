#include "host/cluster/work_queue.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <utility>

#include "host/base/parse.h"
#include "host/base/process_name.h"

namespace impactdic::cluster {
namespace {

// Members looked after in one look(): a share of many members asks no more of the file system.
constexpr std::size_t kVisits = 4;
constexpr std::size_t kBeatEvery = 100;  // pieces, while a queue is made
constexpr int kManyAttempts = 1000000;   // more are none of ours

std::string ticket_name(const Ticket& ticket) {
  char name[48];
  std::snprintf(name, sizeof name, "%06zu.%d", ticket.index, ticket.attempt);
  return name;
}

struct Taken {
  Ticket ticket;
  std::string member;
};

// "I.A" or "I.A.TRAY.MEMBER"; nothing for what is no ticket.
std::optional<Taken> parse_name(const std::string& name) {
  const std::vector<std::string> parts = split(name, '.');
  if (parts.size() != 2 && parts.size() != 4) return std::nullopt;
  Taken taken;
  try {
    const std::int64_t index = parse_int(parts[0], name), attempt = parse_int(parts[1], name);
    if (index < 0 || attempt < 0 || attempt > kManyAttempts) return std::nullopt;
    taken.ticket.index = static_cast<std::size_t>(index);
    taken.ticket.attempt = static_cast<int>(attempt);
  } catch (const InvalidArgument&) {
    return std::nullopt;  // an editor's or the file system's own
  }
  if (parts.size() == 4) {
    taken.ticket.tray = parts[2];
    taken.member = parts[3];
  }
  return taken;
}

std::string who(const std::string& beat) {
  const ProcessName process = parse_process(beat);
  std::string text = "process " + std::to_string(process.pid) + " on " +
                     (process.host.empty() ? "an unknown machine" : process.host);
  const std::size_t name = beat.find("\nname ");
  if (name == std::string::npos) return text;
  const std::size_t begin = name + 6;
  return text + " (" + beat.substr(begin, beat.find('\n', begin) - begin) + ")";
}

}  // namespace

WorkQueue::WorkQueue(Files& files, QueueOptions options, Clock clock,
                     std::function<bool(const std::string&)> gone)
    : files_(files),
      options_(std::move(options)),
      watch_(options_.lost_after_s, std::move(clock), std::move(gone)) {
  // Members begin at different trays and tickets: those of one begin nowhere near those of another.
  steps_ = std::hash<std::string>()(options_.member);
}

std::string WorkQueue::taken_name(const Ticket& ticket, const std::string& member) const {
  return ticket_name(ticket) + "." + ticket.tray + "." + member;
}

std::string WorkQueue::taken_path(const Ticket& ticket, const std::string& member) const {
  return path("taken/" + taken_name(ticket, member));
}

std::string WorkQueue::tray_of(std::size_t index) const {
  return std::to_string(options_.shards > 0 ? index % static_cast<std::size_t>(options_.shards)
                                            : index / kTray);
}

bool WorkQueue::open(const std::string& settings,
                     const std::function<std::vector<std::string>()>& make) {
  const std::string making = options_.name + ".making";
  const auto agreed = files_.read(path("settings"));
  if (agreed && *agreed != settings) {
    throw InvalidArgument("the share '" + options_.name + "' is of another job", "--share",
                          "all its processes need the same options");
  }
  if (agreed) {
    beat();
    return true;
  }
  if (files_.make_folder(making)) {
    maker_lives(making);
    std::vector<std::string> pieces;
    try {
      pieces = make();
    } catch (...) {
      files_.remove(making + "/maker");
      files_.remove_folder(making);
      throw;
    }
    build(making, settings, pieces);
    files_.move(making, options_.name);
    return false;  // the next call finds it, whoever made it
  }
  if (watch_.is_lost(making, files_.read(making + "/maker"))) {
    files_.move(making, making + "." + options_.member);
  }
  return false;
}

void WorkQueue::maker_lives(const std::string& folder) {
  files_.write(folder + "/maker", options_.described + "beat " + std::to_string(++beats_) + "\n");
}

// The queue gets its name when it is complete.
void WorkQueue::build(const std::string& folder, const std::string& settings,
                      const std::vector<std::string>& pieces) {
  const auto inside = [&](const std::string& name) { return folder + "/" + name; };
  for (const char* name : {"todo", "taken", "members", "lost", "closing"}) {
    files_.make_folder(inside(name));
  }
  std::string list;
  for (const std::string& piece : pieces) list += piece + "\n";
  files_.write(inside("list"), list);
  std::set<std::string> trays;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const std::string tray = inside("todo/" + tray_of(i));
    if (trays.insert(tray).second) files_.make_folder(tray);
    Ticket ticket;
    ticket.index = i;
    files_.write(tray + "/" + ticket_name(ticket), pieces[i]);
    if (i % kBeatEvery == 0) maker_lives(folder);
  }
  files_.write(inside("closing/open"), "");
  files_.write(inside("settings"), settings);
}

void WorkQueue::beat() {
  files_.write(path("members/" + options_.member),
               options_.described + "beat " + std::to_string(++beats_) + "\n");
}

void WorkQueue::leave() { files_.remove(path("members/" + options_.member)); }

std::size_t WorkQueue::start(std::size_t count) { return steps_++ % count; }

std::optional<Ticket> WorkQueue::take_from(const std::string& tray) {
  for (;;) {
    const std::vector<std::string> names = files_.names_in(path("todo/" + tray));
    if (names.empty()) return std::nullopt;
    const std::size_t first = options_.shards > 0 ? 0 : start(names.size());
    bool any = false;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string& name = names[(first + k) % names.size()];
      auto found = parse_name(name);
      if (!found) continue;
      any = true;
      Ticket ticket = found->ticket;
      ticket.tray = tray;
      const std::string mine = taken_path(ticket, options_.member);
      // The answer to a rename may be lost on its way: what lies here under this member's name is
      // this member's.
      if (files_.move(path("todo/" + tray + "/" + name), mine) || files_.exists(mine)) {
        ticket.text = files_.read(mine).value_or("");
        return ticket;
      }
      if (k % 2 == 1) break;  // several at the same tray: look again what is left
    }
    if (!any) return std::nullopt;
  }
}

bool WorkQueue::holds_tickets(const std::string& tray) {
  const std::vector<std::string> names = files_.names_in(path("todo/" + tray));
  return std::any_of(names.begin(), names.end(),
                     [](const std::string& name) { return parse_name(name).has_value(); });
}

std::vector<std::string> WorkQueue::open_trays() {
  std::vector<std::string> trays = files_.names_in(path("todo"));
  std::erase_if(trays, [this](const std::string& tray) {
    return barren_.count(tray) != 0 && !holds_tickets(tray);
  });
  if (!options_.shard) return trays;
  const std::string mine = std::to_string(*options_.shard);
  return std::find(trays.begin(), trays.end(), mine) == trays.end()
             ? std::vector<std::string>()
             : std::vector<std::string>{mine};
}

std::optional<Ticket> WorkQueue::take() {
  auto ticket = take_any();
  if (ticket) held_.insert(taken_name(*ticket, options_.member));
  return ticket;
}

std::optional<Ticket> WorkQueue::take_any() {
  if (!hopeless_.empty()) {
    Ticket ticket = hopeless_.back();
    hopeless_.pop_back();
    return ticket;
  }
  for (;;) {
    const std::vector<std::string> trays = open_trays();
    if (trays.empty()) return std::nullopt;
    // Trays are used up one after the other: of many members some meet at one, but none walks past
    // all of them.
    const std::string& tray = trays[std::hash<std::string>()(options_.member) % trays.size()];
    if (auto ticket = take_from(tray)) return ticket;
    // What cannot be removed has just got a ticket, or holds what is none and stays.
    if (!files_.remove_folder(path("todo/" + tray))) barren_.insert(tray);
  }
}

bool WorkQueue::holds(const Ticket& ticket) {
  return files_.exists(taken_path(ticket, options_.member));
}

bool WorkQueue::finish(const Ticket& ticket) {
  held_.erase(taken_name(ticket, options_.member));
  return files_.remove(taken_path(ticket, options_.member));
}

void WorkQueue::put_back(const Ticket& ticket) {
  held_.erase(taken_name(ticket, options_.member));
  put_back(taken_path(ticket, options_.member), ticket);
}

void WorkQueue::put_back(const std::string& from, const Ticket& ticket) {
  // Its tray may be taken away as empty at the same time.
  for (int i = 0; i < 5; ++i) {
    files_.make_folder(path("todo/" + ticket.tray));
    if (files_.move(from, path("todo/" + ticket.tray + "/" + ticket_name(ticket)))) return;
    if (!files_.exists(from)) return;  // another was first
  }
}

bool WorkQueue::watch(const std::string& member) {
  return watch_.is_lost(member, files_.read(path("members/" + member)));
}

void WorkQueue::give_up(const std::string& member, const std::vector<std::string>& taken) {
  const std::string line = who(files_.read(path("members/" + member)).value_or(""));
  files_.write(path("lost/" + member), line);
  newly_lost_.push_back(line);
  for (const std::string& name : taken) {
    const auto found = parse_name(name);
    if (found && found->member == member) return_lost(name, found->ticket);
  }
}

// `name`: as the ticket lies in taken/.
void WorkQueue::return_lost(const std::string& name, Ticket ticket) {
  const std::string from = path("taken/" + name);
  if (++ticket.attempt >= kMostAttempts) {
    ticket.hopeless = true;
    const std::string mine = taken_path(ticket, options_.member);
    if (!files_.move(from, mine) && !files_.exists(mine)) return;  // see take_from()
    ticket.text = files_.read(mine).value_or("");
    hopeless_.push_back(ticket);
    return;
  }
  put_back(from, ticket);
}

Outlook WorkQueue::look() {
  if (!hopeless_.empty() || !open_trays().empty()) return Outlook::kWork;
  const std::vector<std::string> taken = files_.names_in(path("taken"));
  std::set<std::string> owners;
  bool others = false, back = false;
  for (const std::string& name : taken) {
    const auto found = parse_name(name);
    if (!found) continue;
    const bool ours = !options_.shard || found->ticket.tray == std::to_string(*options_.shard);
    others = others || !ours;
    if (ours) owners.insert(found->member);
    // Under this member's name, and nobody works at it: it could not be put back, or a rename had
    // been done that was said to have failed.
    if (ours && found->member == options_.member && held_.count(name) == 0) {
      return_lost(name, found->ticket);
      back = true;
    }
  }
  if (owners.empty()) {
    if (!open_trays().empty()) return Outlook::kWork;
    const std::vector<std::string> trays = files_.names_in(path("todo"));
    others = others || std::any_of(trays.begin(), trays.end(),
                                   [this](const std::string& tray) { return holds_tickets(tray); });
    return others ? Outlook::kElsewhere : Outlook::kOver;
  }
  owners.erase(options_.member);
  const std::vector<std::string> order(owners.begin(), owners.end());
  for (std::size_t i = 0; i < std::min(kVisits, order.size()); ++i) {
    const std::string& member = order[visited_++ % order.size()];
    if (!watch(member)) continue;
    give_up(member, taken);
    back = true;
  }
  return back ? Outlook::kWork : Outlook::kWait;
}

Closing WorkQueue::take_closing() {
  const std::string mine = path("closing/by." + options_.member);
  for (const std::string& name : files_.names_in(path("closing"))) {
    if (name == "done") return Closing::kDone;
    const bool is_free = name == "open" || (name.starts_with("by.") && watch(name.substr(3)));
    if (is_free && files_.move(path("closing/" + name), mine)) return Closing::kMine;
  }
  return Closing::kWait;
}

void WorkQueue::close() {
  files_.move(path("closing/by." + options_.member), path("closing/done"));
}

void WorkQueue::reopen() {
  files_.move(path("closing/by." + options_.member), path("closing/open"));
}

std::vector<std::string> WorkQueue::list() {
  std::vector<std::string> lines = split(files_.read(path("list")).value_or(""), '\n');
  while (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

std::vector<std::string> WorkQueue::lost() {
  std::vector<std::string> lines;
  for (const std::string& member : files_.names_in(path("lost"))) {
    lines.push_back(files_.read(path("lost/" + member)).value_or(member));
  }
  return lines;
}

}  // namespace impactdic::cluster
