// A queue of work in a folder that several processes share, on any number of machines.
//
// Every piece of work has one ticket, a file. Who takes a piece renames its ticket to a name that
// says so; of several who try, the file system lets one succeed. A ticket is therefore always at
// one place: in a tray, with a member, or ended. No locks, no launcher's help: what is left of a
// process that was killed is its tickets under its name, which another puts back.
//
//   NAME/settings            what the members must agree on
//   NAME/list                all pieces, a line each
//   NAME/todo/TRAY/I.A       ticket of piece I, given up A times so far; its text is the piece
//   NAME/taken/I.A.TRAY.M    the same with member M
//   NAME/members/M           M's beat
//   NAME/lost/M              a line for whoever reads the results: M was given up
//   NAME/closing/open|by.M|done   the ticket of the last step, which one member takes
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/cluster/files.h"
#include "host/cluster/watch.h"

namespace impactdic::cluster {

struct Ticket {
  std::size_t index = 0;  // of the piece
  int attempt = 0;        // how many members were lost with it
  std::string tray, text;
  bool hopeless = false;  // kMostAttempts members were lost with it: it is not to be tried again
};

struct QueueOptions {
  std::string name;          // of the share
  std::string member;        // this one: letters, digits, '-' and '_'
  std::string described;     // the beat's first lines: its process, then "name WHAT IT IS CALLED"
  std::optional<int> shard;  // takes only pieces I with I modulo `shards` equal to this
  int shards = 0;            // 0: trays of kTray pieces
  double lost_after_s = 60;  // a member without a new beat for so long is given up
};

// Where the work stands, as a member without work sees it.
enum class Outlook {
  kWork,       // there may be tickets to be taken
  kWait,       // others have tickets that may come back
  kElsewhere,  // what is left belongs to other shards
  kOver,       // no ticket is left
};

enum class Closing { kMine, kWait, kDone };

class WorkQueue {
 public:
  static constexpr int kTray = 32;
  static constexpr int kMostAttempts = 3;

  // `files` must outlive the queue.
  WorkQueue(Files& files, QueueOptions options, Clock clock,
            std::function<bool(const std::string&)> gone);

  // Makes the queue out of the pieces' texts that `make` gives, or finds it made. False while it is
  // being made: try again soon. Throws InvalidArgument where the queue has other settings; what
  // `make` throws, and then there is no queue.
  bool open(const std::string& settings, const std::function<std::vector<std::string>()>& make);

  // Says that this member lives. Safe beside the other functions.
  void beat();
  // It has nothing more to do here.
  void leave();

  std::optional<Ticket> take();       // ended by finish() or put_back()
  bool holds(const Ticket& ticket);   // false where this member was given up meanwhile
  bool finish(const Ticket& ticket);  // the same, and ends the ticket
  void put_back(const Ticket& ticket);

  // Gives up members that are lost: their tickets come back, as does what lies under this member's
  // name and take() has not given. Cheap: a few files a call, however many members there are.
  Outlook look();
  // Only where look() has said kOver.
  Closing take_closing();
  void close();   // the last step is done
  void reopen();  // it cannot be done yet, or by this member
  std::vector<std::string> list();
  std::vector<std::string> lost();  // "process P on HOST (NAME)", by whomever they were given up
  // The same of those that look() has given up since the last call.
  std::vector<std::string> newly_lost() { return std::exchange(newly_lost_, {}); }

 private:
  std::string path(const std::string& inside) const { return options_.name + "/" + inside; }
  std::string taken_name(const Ticket& ticket, const std::string& member) const;
  std::string taken_path(const Ticket& ticket, const std::string& member) const;
  std::string tray_of(std::size_t index) const;
  void maker_lives(const std::string& folder);
  void build(const std::string& folder, const std::string& settings,
             const std::vector<std::string>& pieces);
  std::optional<Ticket> take_any();
  std::optional<Ticket> take_from(const std::string& tray);
  std::vector<std::string> open_trays();
  bool holds_tickets(const std::string& tray);
  void put_back(const std::string& from, const Ticket& ticket);
  bool watch(const std::string& member);
  void give_up(const std::string& member, const std::vector<std::string>& taken);
  void return_lost(const std::string& name, Ticket ticket);
  std::size_t start(std::size_t count);

  Files& files_;
  QueueOptions options_;
  Watch watch_;
  std::atomic<std::size_t> beats_ = 0;
  std::size_t steps_ = 0, visited_ = 0;
  std::vector<Ticket> hopeless_;
  std::set<std::string> held_;    // tickets that take() has given, as they lie in taken/
  std::set<std::string> barren_;  // trays in which something lay that is no ticket
  std::vector<std::string> newly_lost_;
};

}  // namespace impactdic::cluster
